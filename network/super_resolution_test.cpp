// Networks of others: sizes as published, fields, and how far they see.
#include "network/super_resolution.h"

#include <gtest/gtest.h>

#include "api/model.h"
#include "engine/kernel_family.h"
#include "frames/tile_choice.h"
#include "network/architecture.h"
#include "network/halo.h"
#include "network/published.h"
#include "xrds/error.h"

namespace xrds {
namespace {

struct Published {
  const Architecture* architecture;
  PublishedNetwork network;
};

void PrintTo(const Published& published, std::ostream* out) { *out << published.network.name; }

// Those whose count of parameters is published.
std::vector<Published> countedNetworks() {
  std::vector<Published> counted;
  for (const Architecture* architecture : kArchitectures)
    for (const PublishedNetwork& network : architecture->published)
      if (network.millionParameters > 0) counted.push_back({architecture, network});
  return counted;
}

class PublishedSize : public testing::TestWithParam<Published> {};

TEST_P(PublishedSize, IsThatOfTheForwardPass) {
  const auto& [architecture, network] = GetParam();
  const NetworkConfig config = parseConfig(metadataOf(*architecture, network.fields));
  const NetworkModel model = NetworkModel::fromTensors(makeTensors(config, [](const auto&, auto&) {}), "zeros");
  uint64_t tables = 3;  // and the mean
  for (const auto& [name, tensor] : model.file().tensors)
    if (name.ends_with("relative_position_bias_table")) tables += tensor.values.size();
  EXPECT_NEAR(static_cast<double>(model.parameterCount() - tables) / 1e6, network.millionParameters,
              0.005 * network.millionParameters);
  if (network.gigaMultiplyAdds == 0) return;
  const FrameShape frame{720 / config.scale, 1280 / config.scale};
  const auto multiplyAdds = cost(buildGraph(config, frame, model.lookup(), kAsWritten)).multiplyAdds;
  EXPECT_NEAR(static_cast<double>(multiplyAdds) / 1e9, network.gigaMultiplyAdds, 0.005 * network.gigaMultiplyAdds);
}

INSTANTIATE_TEST_SUITE_P(All, PublishedSize, testing::ValuesIn(countedNetworks()),
                         [](const auto& info) { return std::string(info.param.network.name); });

TEST(PublishedSizes, AreKnownOfFiveNetworks) { EXPECT_GE(countedNetworks().size(), 5u); }

TEST(SuperResolution, FieldsAreKept) {
  for (const std::string& name : publishedNames())
    EXPECT_EQ(describe(parseConfig(publishedFields(name))), publishedFields(name));
}

TEST(SuperResolution, RefusesFieldsThatMakeNoNetwork) {
  const auto with = [](const char* name, const char* key, const char* value) {
    Metadata fields = publishedFields(name);
    fields[key] = value;
    return fields;
  };
  EXPECT_THROW(parseConfig(with("edsr", "scale", "3")), Error);
  EXPECT_THROW(parseConfig(with("edsr", "channels", "66")), Error);
  EXPECT_THROW(parseConfig(with("edsr", "residual_divisor", "0")), Error);
  EXPECT_THROW(parseConfig(with("rcan", "reduction", "24")), Error);
  EXPECT_THROW(parseConfig(with("swinir", "head_channels", "32")), Error);
  EXPECT_THROW(parseConfig(with("swinir", "window", "7")), Error);
  EXPECT_THROW(parseConfig(with("swinir", "upsampler", "nearest+conv")), Error);
  EXPECT_THROW(parseConfig(with("rdn", "scale", "1")), Error);
  EXPECT_THROW(parseConfig(with("rdn", "growth", "30")), Error);
  EXPECT_THROW(parseConfig(with("msspl", "scale", "1")), Error);
  EXPECT_THROW(parseConfig(with("msspl", "aux_inputs", "albedo,albedo")), Error);
}

// 2 blocks + 2 convolutions of EDSR see six pixels, and the way up three more.
TEST(SuperResolution, SeesAsFarAsItsLayers) {
  Metadata edsr = publishedFields("edsr");
  edsr["channels"] = "16";
  edsr["blocks"] = "2";
  const NetworkConfig config = parseConfig(edsr);
  EXPECT_GE(exactHalo(config), 8u);
  EXPECT_LE(exactHalo(config), 40u);
  EXPECT_FALSE(seesWholeFrame(config));
  EXPECT_TRUE(seesWholeFrame(parseConfig(publishedFields("rcan"))));
}

TEST(SuperResolution, HasNoExactTilesWhereGatesAreOfTheWholeFrame) {
  Metadata rcan = publishedFields("rcan");
  rcan["groups"] = rcan["blocks"] = "1";
  const NetworkModel model = NetworkModel::random(parseConfig(rcan), 1);
  MemoryLimits limits{.byteSize = uint64_t{1} << 32, .traits = usualTraits(KernelFamily::lane)};
  const Tiling whole = tilingOf(model, {64, 64}, false, {.exact = true}, limits);
  EXPECT_EQ(whole.columns * whole.rows, 1u);
  EXPECT_THROW((void)tilingOf(model, {64, 64}, false, {.exact = true, .columns = 2}, limits), Error);
  EXPECT_EQ(tilingOf(model, {64, 64}, false, {.columns = 2}, limits).columns, 2u);
}

}  // namespace
}  // namespace xrds
