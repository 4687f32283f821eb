// Compiles every pipeline of networks for the first Vulkan device, which need not exist (RADV's null device), and
// prints as JSON what its compiler says of each and how the work of a frame is shared among dispatches.
// bench/gpu_static.py runs it and reads what it prints.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "bench/gpu_static/compiled.h"
#include "bench/gpu_static/null_device.h"
#include "frames/session.h"
#include "network/architecture.h"
#include "network/published.h"
#include "shaders/programs.h"

namespace xrds {
namespace {

using Json = nlohmann::json;

struct Options {
  std::vector<std::string> models, families{"plain", "tile", "matrix", "fused"}, precisions{kFp16, kFp32};
  std::filesystem::path programs;  // a folder of NAME.spv, in place of the embedded ones
  uint32_t width = 256, height = 256;
  uint64_t memoryBytes = uint64_t{8} << 30;        // of the device; the null device says nothing of it
  uint32_t sharedBytes = 0, groupInvocations = 0;  // not 0: those of a smaller device
  uint32_t subgroupSize = 0;                       // not 0: of the kernels that know theirs
  bool listsPublished = false;
  KernelShape shape;  // asked of all kernels, as tuning asks of one
};

// What stands behind the name in the compiler's text of a program: "workgroup_size: 64, 1, 1".
std::vector<uint32_t> numbersBehind(const std::string& text, const std::string& name) {
  std::vector<uint32_t> numbers;
  size_t at = text.find("\n" + name + ": ");
  if (at == std::string::npos) return numbers;
  std::istringstream line(text.substr(at + name.size() + 3, text.find('\n', at + 1) - at - name.size() - 3));
  for (std::string number; std::getline(line, number, ',');)
    numbers.push_back(static_cast<uint32_t>(std::stoul(number)));
  return numbers;
}

// Of what the compiler gives of a program: the first of these names that it has.
std::string textOf(const Compiled& found, std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (const auto text = found.texts.find(name); text != found.texts.end()) return text->second;
  return {};
}

// The words of a program's file, else those that are embedded.
std::span<const uint32_t> programOf(const std::filesystem::path& folder, std::string_view name) {
  static std::map<std::string, std::vector<uint32_t>, std::less<>> read;
  auto place = read.find(name);
  if (place == read.end()) {
    std::ifstream file(folder / (std::string(name) + ".spv"), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    std::vector<uint32_t> words(bytes.size() / 4);
    std::memcpy(words.data(), bytes.data(), 4 * words.size());
    place = read.emplace(name, std::move(words)).first;
  }
  return place->second.empty() ? embeddedProgram(name) : place->second;
}

// How often operators must be cut at least, so that no dispatch has more work than it should.
uint64_t cutsOf(const Graph& graph) {
  uint64_t cuts = 0;
  for (const Node& node : graph.nodes)
    cuts += (std::max<uint64_t>(cost(node).multiplyAdds, 1) - 1) / kMostWorkPerDispatch;
  return cuts;
}

// Of each architecture for upscaling the first network.
void printPublished() {
  for (const Architecture* architecture : kArchitectures)
    if (!architecture->published.empty() && parseConfig(publishedFields(architecture->published[0].name)).scale > 1)
      std::cout << architecture->published[0].name << "\n";
}

class Report {
 public:
  explicit Report(const Options& options)
      : options_(options), device_([&options](std::string_view name) { return programOf(options.programs, name); }) {}

  void add(const std::string& name, const NetworkModel& model, const std::string& precision,
           const std::string& family) {
    const KernelFamily kernels = kernelFamilyOf(family);
    if (!device_.runs(kernels) || (usesMatrixUnits(kernels) && precision != kFp16)) return;
    DeviceTraits& traits = device_.take(kernels);
    traits.memoryBytes = options_.memoryBytes;
    if (options_.sharedBytes) traits.maxSharedBytes = options_.sharedBytes;
    if (options_.subgroupSize) traits.subgroupSize = options_.subgroupSize;
    traits.shape = options_.shape;
    if (options_.groupInvocations) traits.maxGroupInvocations = options_.groupInvocations;
    const auto built = [&](uint32_t bandRows) {
      const Precision wanted = precision == kFp16 ? Precision::fp16 : Precision::fp32;
      return buildGraph(model.config(), {options_.height, options_.width}, model.lookup(),
                        fastOn(traits, {.precision = wanted, .bandRows = bandRows}));
    };
    const Graph graph = built(0), whole = built(kWholeFrame);
    Json network{{"model", name},
                 {"precision", precision},
                 {"family", family},
                 {"arenaBytes", arenaByteSize(graph)},
                 {"operators", whole.nodes.size()},
                 {"cuts", cutsOf(whole)}};
    for (const LoweredDispatch& lowered : lower(graph, traits)) {
      const Dispatch& launch = lowered.dispatch;
      network["dispatches"].push_back({{"pipeline", launch.isCopy() ? -1 : pipelineOf(launch)},
                                       {"groups", launch.groupCount},
                                       {"multiplyAdds", launch.multiplyAdds}});
    }
    networks_.push_back(std::move(network));
  }

  Json json() const {
    const DeviceDescription& device = device_.description();
    return {{"device", device.name}, {"driver", device.driver}, {"networks", networks_}, {"pipelines", pipelines_}};
  }

 private:
  int pipelineOf(const Dispatch& launch) {
    const PipelineKey key(launch);
    const auto [place, isNew] = indices_.try_emplace(key, static_cast<int>(pipelines_.size()));
    if (!isNew) return place->second;
    const Compiled found = compiled(device_.handles(), key);
    const std::string text = textOf(found, {"NIR Shader(s)", "NIR shader", "Final NIR"});
    pipelines_.push_back({{"program", key.program},
                          {"specialization", key.specialization},
                          {"subgroupSize", found.subgroupSize},
                          {"statistics", found.statistics},
                          {"groupSize", numbersBehind(text, "workgroup_size")},
                          {"sharedBytes", numbersBehind(text, "shared_size")},
                          {"assembly", textOf(found, {"Assembly", "NAK assembly", "GEN Assembly"})}});
    if (!found.error.empty()) pipelines_.back()["error"] = found.error;
    return place->second;
  }

  const Options& options_;
  NullDevice device_;
  std::map<PipelineKey, int> indices_;
  Json networks_ = Json::array(), pipelines_ = Json::array();
};

int run(const Options& options) {
  Report report(options);
  for (const std::string& path : options.models) {
    const NetworkModel model = readOrPublished(path);
    for (const std::string& precision : options.precisions)
      for (const std::string& family : options.families)
        report.add(std::filesystem::path(path).stem().string(), model, precision, family);
  }
  std::cout << report.json() << std::endl;
  std::_Exit(0);  // what the null device cannot do, it need not end
}

}  // namespace
}  // namespace xrds

int main(int argc, char** argv) {
  xrds::Options options;
  CLI::App app{"Compiles the pipelines of networks and prints what the compiler says of them"};
  app.add_option("MODEL", options.models, "Files, or names of published sizes: edsr, rcan, swinir, ...");
  app.add_flag("--published", options.listsPublished, "Print the published name of each upscaler of others, and end");
  app.add_option("--families", options.families)->delimiter(',');
  app.add_option("--precisions", options.precisions)->delimiter(',');
  app.add_option("--programs", options.programs, "A folder of SPIR-V, NAME.spv, in place of the embedded programs");
  app.add_option("--width", options.width);
  app.add_option("--height", options.height);
  app.add_option("--memory-bytes", options.memoryBytes, "Memory of the device");
  app.add_option("--shared-bytes", options.sharedBytes, "Shared memory of a smaller device");
  app.add_option("--group-invocations", options.groupInvocations, "Invocations of a group of a smaller device");
  app.add_option("--subgroup-size", options.subgroupSize, "Of the kernels that know theirs");
  app.add_option("--shape-outputs", options.shape.outputs,
                 "Asked of all kernels, as tuning does: KernelShape::outputs");
  app.add_option("--shape-rows", options.shape.rows, "KernelShape::rows");
  CLI11_PARSE(app, argc, argv);
  try {
    if (options.listsPublished) return xrds::printPublished(), 0;
    return xrds::run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
