// EDSR, RCAN, SwinIR and MSSPL: sizes as published, fields, and how far they see.
#include "network/super_resolution.h"

#include <gtest/gtest.h>

#include "api/model.h"
#include "engine/kernel_family.h"
#include "frames/tile_choice.h"
#include "network/halo.h"
#include "network/published.h"
#include "xrds/error.h"

namespace xrds {
namespace {

struct Size {
  const char* name;          // of publishedFields()
  double millionParameters;  // as published; SwinIR's without its tables of relative positions
  double gigaMultiplyAdds;   // as others count them for 1280 x 720 at scale 4; 0: not published
};

class PublishedSize : public testing::TestWithParam<Size> {};

TEST_P(PublishedSize, IsThatOfTheForwardPass) {
  const NetworkConfig config = parseConfig(publishedFields(GetParam().name));
  const NetworkModel model = NetworkModel::fromTensors(makeTensors(config, [](const auto&, auto&) {}), "zeros");
  uint64_t tables = 3;  // and the mean
  for (const auto& [name, tensor] : model.file().tensors)
    if (name.ends_with("relative_position_bias_table")) tables += tensor.values.size();
  EXPECT_NEAR(static_cast<double>(model.parameterCount() - tables) / 1e6, GetParam().millionParameters,
              0.005 * GetParam().millionParameters);
  if (GetParam().gigaMultiplyAdds == 0) return;
  const auto multiplyAdds = cost(buildGraph(config, {180, 320}, model.lookup(), kAsWritten)).multiplyAdds;
  EXPECT_NEAR(static_cast<double>(multiplyAdds) / 1e9, GetParam().gigaMultiplyAdds,
              0.005 * GetParam().gigaMultiplyAdds);
}

INSTANTIATE_TEST_SUITE_P(All, PublishedSize,
                         testing::Values(Size{"edsr", 43.09, 2895}, Size{"edsr_baseline", 1.518, 114},
                                         Size{"rcan", 15.59, 917}, Size{"swinir", 11.85, 0},
                                         Size{"swinir_light", 0.897, 0}),
                         [](const auto& info) { return std::string(info.param.name); });

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
