// The whole network on the device against forward passes of training/network.py in double precision.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "checks/reference.h"
#include "frames/session.h"
#include "network/architecture.h"
#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds {
namespace {

using test::relativeRms;

const std::filesystem::path kFolder = XRDS_GOLDEN_FOLDER;

std::vector<std::string> goldenNames() {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder)) {
    const std::string file = entry.path().filename().string();
    if (file.ends_with(".model.safetensors")) names.insert(file.substr(0, file.size() - 18));
  }
  return {names.begin(), names.end()};
}

// Those of the architecture, whose name they begin with.
std::vector<std::string> goldenNames(const Architecture& architecture) {
  std::vector<std::string> names = goldenNames();
  std::erase_if(names, [&](const auto& name) { return !name.starts_with(std::string(architecture.name) + "_"); });
  return names;
}

// unet_golden_test.cpp has those of the denoisers.
std::vector<const Architecture*> otherUpscalers() {
  std::vector<const Architecture*> others(std::begin(kArchitectures), std::end(kArchitectures));
  std::erase_if(others, [](const Architecture* each) { return each == &kXrds || each == &kOidn; });
  return others;
}

std::vector<std::string> namesOfOthers() {
  std::vector<std::string> names;
  for (const Architecture* architecture : otherUpscalers())
    for (const std::string& name : goldenNames(*architecture)) names.push_back(name);
  return names;
}

/// A golden model with the frame it was given and what PyTorch made of it, as of a colour that was denoised before.
struct Golden {
  explicit Golden(const std::string& name)
      : model(NetworkModel::read(kFolder / (name + ".model.safetensors")).behindDenoiser()),
        tensors(readTensors(kFolder / (name + ".io.safetensors"))) {
    const auto& colour = tensors.tensors.at("colour");
    frame = {static_cast<uint32_t>(colour.shape[0]), static_cast<uint32_t>(colour.shape[1])};
    const uint32_t scale = model.config().scale;
    input.colour = {colour.values.data(), frame.width, frame.height};
    for (const std::string& kind : model.config().auxInputs) {
      const std::string key = kind == "colour" ? "full" : tensors.tensors.contains(kind) ? kind : "aux";
      const auto& values = tensors.tensors.at(key).values;
      input.auxiliary.push_back({values.data(), scale * frame.width, scale * frame.height});
    }
  }
  const std::vector<float>& network() const { return tensors.tensors.at("network").values; }
  const std::vector<float>& output() const { return tensors.tensors.at("output").values; }
  float exposure() const { return tensors.tensors.at("exposure").values[0]; }

  NetworkModel model;
  TensorFile tensors;
  FrameShape frame;
  FrameInput input;
};

// The real pixels and channels of the padded raw output.
std::vector<float> cropped(const std::vector<float>& padded, const TensorView& view, const Graph& graph,
                           uint32_t channels) {
  std::vector<float> values;
  for (uint32_t y = 0; y < graph.output.height; ++y)
    for (uint32_t x = 0; x < graph.output.width; ++x)
      for (uint32_t c = 0; c < channels; ++c)
        values.push_back(padded[(size_t{y} * view.width + x) * view.channelStride + c]);
  return values;
}

std::vector<float> transformed(std::vector<float> radiance, float exposure) {
  for (float& value : radiance) value = std::log1p(std::max(0.f, value * exposure));
  return radiance;
}

class GoldenNetwork : public testing::TestWithParam<std::string> {
 protected:
  void expectMatch(KernelFamily family, Precision precision, double tolerance) {
    const Golden golden(GetParam());
    Gpu& gpu = test::gpu();
    const DeviceTraits traits = gpu.traits();
    gpu.setTraits(test::traitsOf(family));
    Session session(gpu, golden.model, golden.frame, {.precision = precision});
    gpu.setTraits(traits);
    session.fillArena(0x7fc00000);  // NaN
    std::vector<float> output(golden.output().size());
    ASSERT_TRUE(session.run(golden.input, output));
    const Graph& graph = session.graph();
    EXPECT_NEAR(session.exposure() / golden.exposure(), 1, 1e-5);
    const auto raw = cropped(session.read(graph.network), graph.network, graph, golden.model.config().outputWidth());
    EXPECT_LT(relativeRms(raw, golden.network()), tolerance);
    const bool logarithmic = golden.model.config().transfer == Transfer::log1p;
    const auto domain = [&](const std::vector<float>& radiance) {
      return logarithmic ? transformed(radiance, golden.exposure()) : radiance;
    };
    EXPECT_LT(relativeRms(domain(output), domain(golden.output())), tolerance);
  }
};

class GoldenOtherFamilies : public GoldenNetwork {};

TEST_P(GoldenNetwork, Fp32OfTheDevicesFamily) { expectMatch(test::gpu().traits().family, Precision::fp32, 1e-4); }
TEST_P(GoldenNetwork, Fp32Plain) { expectMatch(KernelFamily::plain, Precision::fp32, 1e-4); }
TEST_P(GoldenNetwork, Fp16OfTheDevicesFamily) { expectMatch(test::gpu().traits().family, Precision::fp16, 5e-3); }

INSTANTIATE_TEST_SUITE_P(All, GoldenNetwork, testing::ValuesIn(goldenNames()),
                         [](const auto& info) { return info.param; });

// In the families that the test's device would not choose: few, as GPU kernels are slow on a CPU.
TEST_P(GoldenOtherFamilies, Fp32Tile) { expectMatch(KernelFamily::tile, Precision::fp32, 1e-4); }
TEST_P(GoldenOtherFamilies, Fp16Tile) { expectMatch(KernelFamily::tile, Precision::fp16, 5e-3); }
TEST_P(GoldenOtherFamilies, Fp16Matrix) { expectMatch(KernelFamily::matrix, Precision::fp16, 5e-3); }

INSTANTIATE_TEST_SUITE_P(Some, GoldenOtherFamilies,
                         testing::Values("s2_guided", "s2_window8", "s2_rdb_concat_aux_kernels", "s4_compact_width",
                                         "s1_kernels_aux_skip"),
                         [](const auto& info) { return info.param; });

// With the paper's windows and heads, so that layers are fused: on lavapipe those whose window fits 32 KiB.
class GoldenFused : public GoldenNetwork {};

TEST_P(GoldenFused, Fp16Fused) {
  const Golden golden(GetParam());
  const DeviceTraits traits = test::traitsOf(KernelFamily::fused);
  const Graph graph = buildGraph(golden.model.config(), golden.frame, golden.model.lookup(),
                                 fastOn(traits, {.precision = Precision::fp16}));
  const auto isFused = [](const Node& node) { return std::holds_alternative<SwinLayer>(node.op); };
  EXPECT_GT(std::count_if(graph.nodes.begin(), graph.nodes.end(), isFused), 0);
  expectMatch(KernelFamily::fused, Precision::fp16, 5e-3);
}

INSTANTIATE_TEST_SUITE_P(Some, GoldenFused, testing::Values("s2_paper_width", "s4_compact"),
                         [](const auto& info) { return info.param; });

class GoldenReference : public testing::TestWithParam<std::string> {};

TEST_P(GoldenReference, HostReplayMatchesToo) {
  const Golden golden(GetParam());
  const Graph graph = buildGraph(golden.model.config(), golden.frame, golden.model.lookup(), {});
  HostMemory memory;
  setInputs(graph, golden.input, memory);
  runReference(graph, memory);
  const auto& stored = memory.storage(graph.network);
  const uint32_t channels = golden.model.config().outputWidth();
  const auto raw = cropped({stored.begin(), stored.end()}, graph.network, graph, channels);
  EXPECT_LT(relativeRms(raw, golden.network()), 1e-6);
  const auto& pixels = memory.storage(graph.output);
  const auto output = cropped({pixels.begin(), pixels.end()}, graph.output, graph, 3);
  EXPECT_LT(relativeRms(output, golden.output()), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Some, GoldenReference,
                         testing::Values("s2_guided", "s2_rdb_concat_aux_kernels", "s4_rstb_concat_aux_kernels"),
                         [](const auto& info) { return info.param; });
INSTANTIATE_TEST_SUITE_P(OfOthers, GoldenReference, testing::ValuesIn(namesOfOthers()),
                         [](const auto& info) { return info.param; });

TEST(GoldenFiles, EveryArchitectureHasSome) {
  for (const Architecture* architecture : otherUpscalers())
    EXPECT_FALSE(goldenNames(*architecture).empty()) << architecture->name;
}

TEST(GoldenCheck, AcceptsFilteredAuxiliaryImages) {
  const Golden golden("s2_rdb_concat_aux_kernels");
  const CheckResult good = checkAgainstReference(test::gpu(), golden.model, golden.frame, golden.input, {});
  EXPECT_EQ(good.firstDivergent, -1);
  EXPECT_EQ(good.nodes.back().node, "decode_radiance");
}

TEST(GoldenCheck, NamesTheFirstDivergentOperator) {
  const Golden golden("s2_guided");
  const CheckResult good = checkAgainstReference(test::gpu(), golden.model, golden.frame, golden.input, {});
  EXPECT_EQ(good.firstDivergent, -1);
  EXPECT_GT(good.nodes.size(), 40u);

  std::vector<float> colour = golden.tensors.tensors.at("colour").values;
  colour[4] = INFINITY;  // the exposure leaves it out, the encoding hands it on
  FrameInput broken = golden.input;
  broken.colour.pixels = colour.data();
  const CheckResult bad = checkAgainstReference(test::gpu(), golden.model, golden.frame, broken, {});
  ASSERT_GE(bad.firstDivergent, 0);
  EXPECT_EQ(bad.nodes[static_cast<size_t>(bad.firstDivergent)].node, "encode_radiance");
}

}  // namespace
}  // namespace xrds
