#include <cstdio>
#include <memory>

#include "app/byte_count.h"
#include "app/models.h"
#include "app/stage.h"
#include "cli/commands.h"
#include "image/exr_file.h"
#include "xrds/xrds.h"

namespace xrds {
namespace {

struct InfoOptions {
  std::string model, size = "1024x1024", memory, tiles = "bounded";
  bool wrap = false;
};

struct Size {
  uint32_t width = 0, height = 0;
};

Size parseSize(const std::string& text) {
  Size size;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%5ux%5u%c", &size.width, &size.height, &rest) != 2 || size.width == 0 ||
      size.height == 0)
    throw Failure{ExitCode::usage, "--size takes WIDTHxHEIGHT of the output, such as 1920x1080, found '" + text + "'."};
  return size;
}

void printMetadata(const Model& model) {
  for (const auto& [key, value] : model.metadata())
    std::printf("%-26s %s\n", printable(key).c_str(), printable(value).c_str());
  std::printf("%-26s %s\n", "hash", model.hash().c_str());
}

struct Costs {
  Model::Cost fp32, fp16;
};

Costs costsOf(const Model& model, Size size) {
  if (uint64_t{size.width} * size.height > static_cast<uint64_t>(kMaxPixelCount))
    throw Error("--size is too large: expected at most " + std::to_string(kMaxPixelCount) + " pixels.");
  return {model.cost(size.width, size.height, false), model.cost(size.width, size.height, true)};
}

void printCosts(const Costs& costs, Size size) {
  const auto& [fp32, fp16] = costs;
  std::printf("\nFor an output of %u x %u:\n", size.width, size.height);
  std::printf("%-26s %.3f M\n", "parameters", static_cast<double>(fp32.parameters) / 1e6);
  std::printf("%-26s %.2f G\n", "MACs", static_cast<double>(fp32.multiplyAdds) / 1e9);
  std::printf("%-26s %.2f G\n", "attention MACs (more)", static_cast<double>(fp32.attentionMultiplyAdds) / 1e9);
  std::printf("%-26s %10s %10s\n", "device memory in MB", "fp32", "fp16");
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

void printTilings(const Model& model, Size size, const InfoOptions& options) {
  const TileOptions tiles{
      .memoryBytes = parseBytes(options.memory), .exact = options.tiles == "exact", .wrap = options.wrap};
  const Tiling fp32 = model.tiling(size.width, size.height, false, tiles);
  const Tiling fp16 = model.tiling(size.width, size.height, true, tiles);
  std::printf("\nIn %s of device memory:\n", options.memory.c_str());
  printTiling("fp32", fp32);
  printTiling("fp16", fp16);
}

void listModels() {
  for (const std::string& name : shippedModels()) std::printf("%s\n", name.c_str());
}

void run(const InfoOptions& options) {
  if (options.model.empty()) return listModels();
  const Size size = parseSize(options.size);
  const Model model = stage(ExitCode::model, [&] { return Model(resolveModel(options.model)); });
  stage(ExitCode::usage, [&] {
    const Costs costs = costsOf(model, size);
    printMetadata(model);
    printCosts(costs, size);
    if (!options.memory.empty()) printTilings(model, size, options);
  });
}

}  // namespace

void addInfo(CLI::App& app) {
  const auto options = std::make_shared<InfoOptions>();
  CLI::App* verb =
      app.add_subcommand("info", "Show what a model is and what it costs; without MODEL, list the shipped ones");
  verb->add_option("MODEL", options->model, "A shipped model's name or a .safetensors file");
  verb->add_option("--size", options->size, "Size of the output in pixels (default 1024x1024)")->type_name("WxH");
  verb->add_option("--memory", options->memory, "Tell the tiles that fit so much device memory, such as 256M")
      ->check(CLI::Validator(validBytes, "BYTES"));
  verb->add_option("--tiles", options->tiles, "As in xrds upscale")
      ->check(CLI::IsMember({"exact", "bounded"}))
      ->capture_default_str();
  verb->add_flag("--wrap", options->wrap, "As in xrds upscale");
  verb->footer(
      "Planned peak is the arena that a run allocates; the largest live set is the least that any plan needs;\n"
      "without aliasing is the sum of all tensors. MB are 10^6 bytes. MACs are multiplications of linear maps\n"
      "and convolutions, the token pairs of attention come on top.\n\nExamples:\n  xrds info\n  xrds info "
      "xrds-x4-compact --size 1920x1080\n  xrds info xrds-x4-compact --size 8192x8192 --memory 512M");
  verb->callback([options] { run(*options); });
}

}  // namespace xrds
