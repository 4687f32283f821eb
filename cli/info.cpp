#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/byte_count.h"
#include "app/failing_with.h"
#include "app/models.h"
#include "app/pixel_size.h"
#include "cli/commands.h"
#include "cli/device_choice.h"
#include "cli/json_text.h"
#include "cli/layer_list.h"
#include "cli/output_file.h"
#include "image/exr/file.h"
#include "xrds/path_text.h"
#include "xrds/xrds.hpp"

namespace xrds {
namespace {

using Json = nlohmann::ordered_json;

struct InfoOptions {
  std::string model, size = "1024x1024", memory, tiles = "bounded", kernels, json;
  bool wrap = false;
};

void printMetadata(const Model& model) {
  for (const auto& [key, value] : model.metadata())
    std::printf("%-26s %s\n", printable(key).c_str(), printable(value).c_str());
  std::printf("%-26s %s\n", "hash", model.hash().c_str());
}

// As xrds denoise cuts, which knows no other tiles.
bool isAlwaysExact(const Model& model) {
  const auto architecture = model.metadata().find("architecture");
  return architecture != model.metadata().end() && architecture->second == "oidn";
}

/// All that is asked of a model; the tilings if an amount of memory is given.
struct Answer {
  PixelSize size;
  std::string kernelFamily;
  Model::Cost fp32, fp16;
  std::optional<Tiling> fp32Tiling{}, fp16Tiling{};
};

Answer answerOf(const Model& model, PixelSize size, const InfoOptions& options) {
  if (uint64_t{size.width} * size.height > static_cast<uint64_t>(kMaxPixelCount))
    throw Error("--size is too large: expected at most " + std::to_string(kMaxPixelCount) + " pixels.");
  const uint32_t scale = model.scale();
  const std::string family = options.kernels.empty()
                                 ? Upscaler::kernelFamily(usualKernelFamily(), size.width / scale, size.height / scale)
                                 : options.kernels;
  Answer answer{size, family, model.cost(size.width, size.height, false, family),
                model.cost(size.width, size.height, true, family)};
  if (options.memory.empty()) return answer;
  const TileOptions tiles{.memoryBytes = parseBytes(options.memory),
                          .exact = options.tiles == "exact" || isAlwaysExact(model),
                          .wrap = options.wrap};
  answer.fp32Tiling = model.tiling(size.width, size.height, false, tiles, family);
  answer.fp16Tiling = model.tiling(size.width, size.height, true, tiles, family);
  return answer;
}

void printCosts(const Answer& answer) {
  const auto& [size, family, fp32, fp16, fp32Tiling, fp16Tiling] = answer;
  const auto printMultiplyAdds = [](const char* name, uint64_t count) {
    std::printf("%-26s %.2f G\n", name, static_cast<double>(count) / 1e9);
  };
  std::printf("\nFor an output of %u x %u, with the %s kernels:\n", size.width, size.height, family.c_str());
  std::printf("%-26s %.3f M\n", "parameters", static_cast<double>(fp32.parameters) / 1e6);
  printMultiplyAdds("MACs of the network", fp32.networkMultiplyAdds);
  printMultiplyAdds("MACs executed", fp32.multiplyAdds + fp32.attentionMultiplyAdds);
  printMultiplyAdds("  of these, attention", fp32.attentionMultiplyAdds);
  std::printf("%-26s %10s %10s\n", "device memory in MB", kFp32, kFp16);
  const auto row = [](const char* name, uint64_t a, uint64_t b) {
    std::printf("%-26s %10.1f %10.1f\n", name, static_cast<double>(a) / 1e6, static_cast<double>(b) / 1e6);
  };
  row("  planned peak", fp32.plannedBytes, fp16.plannedBytes);
  row("  largest live set", fp32.lowerBoundBytes, fp16.lowerBoundBytes);
  row("  without aliasing", fp32.unaliasedBytes, fp16.unaliasedBytes);
  row("  weights (more)", fp32.weightBytes, fp16.weightBytes);
}

void printTiling(const char* precision, const Tiling& tiling) {
  if (tiling.columns * tiling.rows == 1 && tiling.halo == 0) {
    std::printf("  %s: the whole frame in one piece, %.1f MB\n", precision,
                static_cast<double>(tiling.arenaBytes + tiling.weightBytes) / 1e6);
    return;
  }
  std::printf(
      "  %s: %u x %u tiles of at most %u x %u pixels with a halo of %u low-resolution pixels, %.1f MB, %.2f times "
      "the work\n",
      precision, tiling.columns, tiling.rows, tiling.tileWidth, tiling.tileHeight, tiling.halo,
      static_cast<double>(tiling.arenaBytes + tiling.weightBytes) / 1e6, tiling.work);
}

void printTilings(const Answer& answer, const std::string& memory) {
  std::printf("\nIn %s of device memory:\n", memory.c_str());
  printTiling(kFp32, *answer.fp32Tiling);
  printTiling(kFp16, *answer.fp16Tiling);
}

Json jsonOf(const char* precision, const Model::Cost& cost, const std::optional<Tiling>& tiling) {
  Json json{{"precision", precision},
            {"multiplyAdds", cost.multiplyAdds},
            {"attentionMultiplyAdds", cost.attentionMultiplyAdds},
            {"memory",
             {{"plannedBytes", cost.plannedBytes},
              {"lowerBoundBytes", cost.lowerBoundBytes},
              {"unaliasedBytes", cost.unaliasedBytes},
              {"weightBytes", cost.weightBytes}}}};
  if (tiling)
    json["tiling"] = {{"columns", tiling->columns},
                      {"rows", tiling->rows},
                      {"halo", tiling->halo},
                      {"tileWidth", tiling->tileWidth},
                      {"tileHeight", tiling->tileHeight},
                      {"work", tiling->work},
                      {"arenaBytes", tiling->arenaBytes},
                      {"weightBytes", tiling->weightBytes}};
  return json;
}

Json jsonOf(const Model& model, const std::string& name, const Answer& answer) {
  Json json{{"version", XRDS_VERSION},
            {"model", name},
            {"modelHash", model.hash()},
            {"metadata", model.metadata()},
            {"width", answer.size.width},
            {"height", answer.size.height},
            {"kernelFamily", answer.kernelFamily},
            {"parameters", answer.fp32.parameters},
            {"networkMultiplyAdds", answer.fp32.networkMultiplyAdds}};
  json["precisions"] = {jsonOf(kFp32, answer.fp32, answer.fp32Tiling), jsonOf(kFp16, answer.fp16, answer.fp16Tiling)};
  return json;
}

void writeJson(const std::string& file, const Json& json) {
  if (file.empty()) return;
  failingWith(ExitCode::output, [&] { writeText(file, textOf(json)); });
}

void listModels(const InfoOptions& options) {
  failingWith(ExitCode::model, requireShippedModels);
  for (const std::string& name : shippedModels()) std::printf("%s\n", name.c_str());
  writeJson(options.json, {{"version", XRDS_VERSION}, {"models", shippedModels()}});
}

bool isExr(const std::string& name) {
  return name.size() >= 4 && CLI::detail::to_lower(name.substr(name.size() - 4)) == ".exr";
}

// Of an EXR file all options but --help say nothing.
void requireModelOptions(const CLI::App& verb) {
  for (const CLI::Option* option : verb.get_options())
    if (option->count() > 0 && !option->get_positional() && !option->check_lname("help"))
      throw Failure{ExitCode::usage, option->get_name() + " is of models; an EXR file goes without it."};
}

void run(const CLI::App& verb, const InfoOptions& options) {
  if (isExr(options.model)) {
    requireModelOptions(verb);
    return printLayers(pathOf(options.model));
  }
  requireOutput(options.json, ".json", "--json");
  if (options.model.empty()) return listModels(options);
  const PixelSize size = parseOutputSize(options.size);
  const Model model = failingWith(ExitCode::model, [&] { return Model(resolveModel(options.model)); });
  const Answer answer = failingWith(ExitCode::usage, [&] { return answerOf(model, size, options); });
  printMetadata(model);
  printCosts(answer);
  if (answer.fp32Tiling) printTilings(answer, options.memory);
  writeJson(options.json, jsonOf(model, options.model, answer));
}

}  // namespace

void addInfo(CLI::App& app) {
  const auto options = std::make_shared<InfoOptions>();
  CLI::App* verb = app.add_subcommand(
      "info",
      "Show what a model is and what it costs, or the layers of an EXR file; without MODEL, list the "
      "shipped ones");
  verb->add_option("MODEL", options->model, "A shipped model's name or a .safetensors file; or an .exr file")
      ->type_name("TEXT");
  verb->add_option("--size", options->size, "Size of the output in pixels (default 1024x1024)")->type_name("WxH");
  verb->add_option("--memory", options->memory, "Tell the tiles that fit so much device memory, such as 256M")
      ->check(CLI::Validator(validBytes, "BYTES"));
  verb->add_option("--tiles", options->tiles, "As in xrds upscale")
      ->check(CLI::IsMember({"exact", "bounded"}))
      ->capture_default_str();
  verb->add_flag("--wrap", options->wrap, "As in xrds upscale");
  verb->add_option("--kernels", options->kernels,
                   "Kernels that run the model: plain, lane, tile, matrix or fused (default: those of the best device)")
      ->check(CLI::IsMember(Device::kernelFamilies()))
      ->type_name("FAMILY");
  verb->add_option("--json", options->json, "Write every number to this file, too")->type_name("JSON");
  verb->footer(
      "Planned peak is the arena that a run allocates; the largest live set is the least that any plan needs;\n"
      "without aliasing is the sum of all tensors. MB are 10^6 bytes. MACs of the network are multiplications of\n"
      "linear maps and convolutions as papers count them, without the token pairs of attention. MACs executed are\n"
      "those of a run: maps in a row are made as one, and the token pairs count.\n\nExamples:\n  xrds info\n  xrds "
      "info "
      "xrds-x4-compact --size 1920x1080\n  xrds info xrds-x4-compact --size 8192x8192 --memory 512M\n  xrds info "
      "full.exr");
  verb->callback([verb, options] { run(*verb, *options); });
}

}  // namespace xrds
