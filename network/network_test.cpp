#include "network/network.h"

#include <gtest/gtest.h>

#include <set>

#include "engine/kernel_family.h"
#include "engine/work.h"
#include "frames/session.h"
#include "network/network_model.h"
#include "tests/print_case.h"
#include "xrds/error.h"

namespace xrds {
namespace {

using test::PrintTo;

struct Row {
  uint32_t groups, blocks;
  double gigaMultiplyAdds, millionParameters;  // the paper's Tables 9 and 10, for 1024 x 1024 and scale 4
};

class PaperTable : public testing::TestWithParam<Row> {};

TEST_P(PaperTable, CostsMatchToEveryPrintedDigit) {
  NetworkConfig config;
  config.groups = GetParam().groups;
  config.blocks = GetParam().blocks;
  const NetworkModel model = NetworkModel::random(config, 1);
  const uint64_t multiplyAdds = cost(buildGraph(config, {256, 256}, model.lookup(), kAsWritten)).multiplyAdds;
  EXPECT_NEAR(static_cast<double>(multiplyAdds) / 1e9, GetParam().gigaMultiplyAdds, 0.005);
  EXPECT_NEAR(static_cast<double>(model.parameterCount()) / 1e6, GetParam().millionParameters,
              0.005 * GetParam().millionParameters);
}

INSTANTIATE_TEST_SUITE_P(Network, PaperTable,
                         testing::Values(Row{3, 5, 723.68, 9.36}, Row{3, 3, 519.13, 6.21}, Row{3, 1, 314.59, 3.06},
                                         Row{2, 5, 507.86, 6.42}, Row{1, 5, 292.04, 3.49}));

// Of the paper's size, against the PyTorch modules.
TEST(Network, CostsOfTheOtherFormsMatchTraining) {
  const auto expectCosts = [](NetworkConfig config, double gigaMultiplyAdds, double millionParameters) {
    config.base = config.auxInputs.empty() ? BaseImage::bicubic : BaseImage::guided;
    const NetworkModel model = NetworkModel::random(config, 1);
    const uint64_t multiplyAdds = cost(buildGraph(config, {256, 256}, model.lookup(), kAsWritten)).multiplyAdds;
    EXPECT_NEAR(static_cast<double>(multiplyAdds) / 1e9, gigaMultiplyAdds, 1e-6);
    EXPECT_NEAR(static_cast<double>(model.parameterCount()) / 1e6, millionParameters, 1e-6);
  };
  expectCosts({.block = BlockKind::rdb}, 445.850321, 5.049647);
  expectCosts({.block = BlockKind::rstb}, 345.187025, 3.562697);
  expectCosts({.cross = CrossKind::concat}, 712.406729, 9.214295);
  expectCosts({.auxInputs = {}, .cross = CrossKind::concat}, 583.356383, 8.541879);
  expectCosts({.kernels = 5, .auxSkip = true, .auxKernels = 5}, 769.885471, 9.436981);
  expectCosts({.kernels = 5, .auxSkip = true, .auxKernels = 5, .outputSide = 1}, 727.204233, 9.396277);
  expectCosts({.block = BlockKind::rdb, .cross = CrossKind::concat, .auxKernels = 3}, 440.011850, 4.876268);
}

MemoryNeeds needsOf(const NetworkConfig& config, FrameShape frame, const GraphOptions& options) {
  const NetworkModel model = NetworkModel::random(config, 1);
  return memoryNeeds(buildGraph(config, frame, model.lookup(), options), DeviceTraits{});
}

// As the model xrds-x4-compact.
const NetworkConfig kCompact{
    .channels = 32, .auxChannels = 16, .blocks = 1, .kernels = 5, .auxSkip = true, .auxKernels = 5, .outputSide = 1};

TEST(Network, PlanIsSmallAndTight) {
  const auto expectPlan = [](const NetworkConfig& config, Precision precision, uint64_t most) {
    for (const FrameShape frame : {FrameShape{256, 256}, FrameShape{270, 480}}) {
      const MemoryNeeds needs = needsOf(config, frame, {precision});
      EXPECT_LE(static_cast<double>(needs.planned), 1.05 * static_cast<double>(needs.lowerBound));
      EXPECT_GT(needs.unaliased, 4 * needs.planned);
      if (frame.height == 256) {
        EXPECT_LE(needs.planned, most);
      }
    }
  };
  expectPlan({}, Precision::fp32, 190'000'000);
  expectPlan({}, Precision::fp16, 97'000'000);
  expectPlan(kCompact, Precision::fp32, 186'000'000);
  expectPlan(kCompact, Precision::fp16, 99'000'000);
}

TEST(Network, BandsTakeAboutHalfTheMemoryAndHardlyMoreWork) {
  for (const NetworkConfig& config : {NetworkConfig{}, kCompact}) {
    const NetworkModel model = NetworkModel::random(config, 1);
    const auto graphOf = [&](uint32_t rows) {
      return buildGraph(config, {256, 256}, model.lookup(), {.bandRows = rows});
    };
    const auto workOf = [](const Graph& graph) {
      return static_cast<double>(cost(graph).multiplyAdds + cost(graph).attentionMultiplyAdds);
    };
    const Graph whole = graphOf(kWholeFrame), banded = graphOf(0);
    EXPECT_LT(memoryNeeds(banded, {}).planned, 0.51 * static_cast<double>(memoryNeeds(whole, {}).planned));
    EXPECT_EQ(memoryNeeds(banded, {}).weights, memoryNeeds(whole, {}).weights);
    EXPECT_GE(workOf(banded), workOf(whole));
    EXPECT_LT(workOf(banded), 1.002 * workOf(whole));
  }
}

// A GPU of 64 compute units, filled twice; with little memory of it the bands of a CPU.
TEST(Network, IsFewLargeDispatchesOnAGpu) {
  constexpr uint64_t kEnoughGroups = 128, kLittle = uint64_t{512} << 20;
  const NetworkModel model = NetworkModel::random(kCompact, 1);
  const auto graphOn = [&](const DeviceTraits& device, FrameShape frame) {
    return buildGraph(kCompact, frame, model.lookup(), fastOn(device, {.precision = Precision::fp16}));
  };
  for (const KernelFamily family : {KernelFamily::tile, KernelFamily::matrix, KernelFamily::fused}) {
    DeviceTraits device = usualTraits(family);
    const Graph graph = graphOn(device, {256, 256});
    const auto lowered = lower(graph, device);
    EXPECT_LE(lowered.size(), 200u);
    uint64_t all = 0, filling = 0;
    for (const LoweredDispatch& each : lowered) {
      const auto [x, y, z] = each.dispatch.groupCount;
      all += each.dispatch.multiplyAdds;
      if (uint64_t{x} * y * z >= kEnoughGroups) filling += each.dispatch.multiplyAdds;
    }
    EXPECT_GE(static_cast<double>(filling), 0.9 * static_cast<double>(all)) << nameOf(family);
    // The arena of a large frame grows with its rows no faster than that of a CPU does.
    const auto planned = [&](const DeviceTraits& of, uint32_t rows) {
      return static_cast<double>(memoryNeeds(graphOn(of, {rows, 1024}), of).planned);
    };
    const DeviceTraits cpu = usualTraits(KernelFamily::lane);
    EXPECT_LT(planned(device, 2048) - planned(device, 1024), 1.1 * (planned(cpu, 2048) - planned(cpu, 1024)));
    device.memoryBytes = kLittle;
    const size_t least = lower(graphOn(device, {256, 256}), device).size();
    device.memoryBytes = 0;
    EXPECT_EQ(least, lower(graphOn(device, {256, 256}), device).size());
    EXPECT_GT(least, 400u);
  }
}

TEST(Network, BandsFitTheBindingsOfTheDevice) {
  NetworkConfig config;
  config.groups = config.blocks = 1;
  const NetworkModel model = NetworkModel::random(config, 1);
  const Graph graph = buildGraph(config, {512, 480}, model.lookup(), {});
  DeviceTraits traits;
  for (const KernelFamily family : {KernelFamily::plain, KernelFamily::lane, KernelFamily::tile}) {
    traits.family = family;
    for (const LoweredDispatch& lowered : lower(graph, traits))
      for (const Binding& binding : lowered.dispatch.bindings) {
        if (binding.kind == BindingKind::storage) {
          EXPECT_LE(binding.byteSize, traits.maxStorageBufferRange);
        }
        EXPECT_EQ(binding.byteOffset % (binding.kind == BindingKind::copied ? 4 : kBindingAlignment), 0u);
      }
  }
}

// Whoever waits for the device waits for a dispatch: none is long where a little work is asked of each.
TEST(Network, DispatchesAreAsShortAsAskedFor) {
  NetworkConfig config;
  config.groups = config.blocks = 1;
  const NetworkModel model = NetworkModel::random(config, 1);
  const Graph graph = buildGraph(config, {160, 160}, model.lookup(), {});
  DeviceTraits traits;
  traits.family = KernelFamily::lane;
  constexpr uint64_t kMostWork = uint64_t{1} << 25;
  uint64_t longest = 0, sum = 0, whole = 0;
  for (const LoweredDispatch& lowered : lower(graph, traits, kMostWork)) {
    const Dispatch& dispatch = lowered.dispatch;
    if (!dispatch.isCopy()) longest = std::max(longest, dispatch.multiplyAdds);
    sum += dispatch.multiplyAdds;
    for (const Binding& binding : dispatch.bindings)
      if (binding.access == Access::write && !dispatch.isCopy()) {
        EXPECT_LE(workOf(0, binding.byteSize), 2 * kMostWork) << dispatch.label;
      }
  }
  for (const LoweredDispatch& lowered : lower(graph, traits)) whole += lowered.dispatch.multiplyAdds;
  EXPECT_EQ(sum, whole);
  EXPECT_GT(longest, kMostWork / 8);
  EXPECT_LE(longest, 2 * kMostWork) << "rows of windows cannot be cut further";
}

TEST(Network, RefusesAnEmptyOrHugeFrame) {
  const NetworkConfig config{.channels = 8, .auxChannels = 4, .groups = 1, .blocks = 1, .window = 4, .headChannels = 4};
  const NetworkModel model = NetworkModel::random(config, 1);
  EXPECT_THROW(buildGraph(config, {0, 4}, model.lookup(), {}), Error);
  EXPECT_THROW(buildGraph(config, {4, 70000}, model.lookup(), {}), Error);
}

TEST(Config, RefusesWhatItDoesNotKnow) {
  const Metadata good = describe(NetworkConfig{});
  EXPECT_EQ(describe(parseConfig(good)), good);
  const auto refused = [&](const char* key, const char* text) {
    Metadata bad = good;
    bad[key] = text;
    try {
      parseConfig(bad);
    } catch (const Error& error) {
      return std::string(error.what()).find("model file") != std::string::npos;
    }
    return false;
  };
  EXPECT_TRUE(refused("format", "other"));
  EXPECT_TRUE(refused("version", "2"));
  EXPECT_TRUE(refused("scale", "3"));
  EXPECT_TRUE(refused("scale", "4x"));
  EXPECT_TRUE(refused("channels", "-64"));
  EXPECT_TRUE(refused("channels", "66"));
  EXPECT_TRUE(refused("head_channels", "24"));
  EXPECT_TRUE(refused("window", "7"));
  EXPECT_TRUE(refused("block", "rdb2"));
  EXPECT_TRUE(refused("base", "lanczos"));
  EXPECT_TRUE(refused("aux_inputs", "normal"));
  EXPECT_TRUE(refused("aux_inputs", "albedo,albedo"));
  EXPECT_TRUE(refused("kernels", "3"));
  EXPECT_TRUE(refused("cross", "add"));
  EXPECT_TRUE(refused("aux_kernels", "4"));
  EXPECT_TRUE(refused("aux_kernels", "7"));
  EXPECT_TRUE(refused("output_side", "2"));
  EXPECT_TRUE(refused("output_side", "5"));
  for (const auto& [key, text] : good) {
    const std::set<std::string> required{"format", "version", "scale",  "channels",      "aux_channels", "aux_inputs",
                                         "groups", "blocks",  "window", "head_channels", "transfer",     "base"};
    Metadata missing = good;
    missing.erase(key);
    if (required.contains(key))
      EXPECT_THROW(parseConfig(missing), Error) << key;
    else
      EXPECT_EQ(describe(parseConfig(missing)), good) << key;
  }
}

TEST(Config, KeepsWhatDiffersFromThePaper) {
  for (const char* block : {"rdst", "rstb", "rdb"})
    for (const char* cross : {"attention", "concat"}) {
      Metadata fields = describe({.auxInputs = {"albedo", "colour"},
                                  .kernels = 5,
                                  .auxSkip = true,
                                  .auxKernels = 3,
                                  .colourKernels = 5,
                                  .prefilter = 2,
                                  .outputSide = 1});
      fields["block"] = block;
      fields["cross"] = cross;
      EXPECT_EQ(describe(parseConfig(fields)), fields);
    }
}

TEST(Config, FiltersAuxiliaryImagesOnlyForABaseThatDemodulates) {
  for (const char* base : {"none", "bicubic"}) {
    Metadata fields = describe({.auxKernels = 3});
    EXPECT_NO_THROW(parseConfig(fields));
    fields["base"] = base;
    EXPECT_THROW(parseConfig(fields), Error) << base;
  }
  EXPECT_THROW(parseConfig(describe({.groups = 0, .auxKernels = 3})), Error);
}

TEST(Config, FiltersTheFullResolutionColourOnlyWhereItIsGiven) {
  const auto parse = [](NetworkConfig config, const char* field = nullptr, const char* value = nullptr) {
    Metadata fields = describe(config);
    if (field) fields[field] = value;
    return parseConfig(fields);
  };
  const NetworkConfig full{.auxInputs = {"albedo", "colour"}, .colourKernels = 5};
  EXPECT_EQ(parse(full).outputWidth(), 3u + 25 + 1);
  EXPECT_EQ(parse(full).firstColourLogit(), 3u);
  EXPECT_THROW(parse(full, "base", "demodulated"), Error);
  EXPECT_THROW(parse(full, "aux_inputs", "albedo,normal"), Error);
  EXPECT_THROW(parse(full, "colour_kernels", "4"), Error);
  EXPECT_THROW(parse(full, "scale", "1"), Error);
  EXPECT_NO_THROW(parse({.auxInputs = {"colour"}, .base = BaseImage::bicubic}));
}

TEST(Config, FiltersTheColourOnlyForTheGuidedBase) {
  EXPECT_EQ(parseConfig(describe({.prefilter = 3})).prefilterLogits(), 75u);
  EXPECT_THROW(parseConfig(describe({.base = BaseImage::demodulated, .prefilter = 1})), Error);
  EXPECT_THROW(parseConfig(describe({.groups = 0, .prefilter = 1})), Error);
  EXPECT_THROW(parseConfig(describe({.prefilter = 4})), Error);
}

TEST(Model, NamesWhatIsWrongWithItsTensors) {
  const NetworkConfig config{.channels = 8, .auxChannels = 4, .groups = 1, .blocks = 1, .window = 4, .headChannels = 4};
  const TensorFile good = NetworkModel::random(config, 1).file();
  const auto message = [&](auto change) {
    TensorFile file = good;
    change(file);
    try {
      NetworkModel::fromTensors(std::move(file), "model");
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(message([](TensorFile& f) { f.tensors.erase("fuse.bias"); }).find("misses the tensor 'fuse.bias'"),
            std::string::npos);
  EXPECT_NE(message([](TensorFile& f) { f.tensors["extra"] = {{1}, {0}}; }).find("'extra'"), std::string::npos);
  EXPECT_NE(message([](TensorFile& f) {
              f.tensors["fuse.bias"] = {{4}, {0, 0, 0, 0}};
            }).find("is 4, expected 8"),
            std::string::npos);
  EXPECT_NE(message([](TensorFile& f) { f.tensors["fuse.bias"].values[2] = NAN; }).find("not finite"),
            std::string::npos);
  EXPECT_EQ(message([](TensorFile&) {}), "");
}

}  // namespace
}  // namespace xrds
