// EDSR, RCAN, SwinIR and MSSPL: sizes as published, fields, and how far they see.
#include "network/super_resolution.h"

#include <gtest/gtest.h>

#include "api/state.h"
#include "engine/kernel_family.h"
#include "frames/tile_choice.h"
#include "network/halo.h"
#include "network/network_model.h"
#include "xrds/error.h"

namespace xrds {
namespace {

Metadata fieldsOf(const char* architecture, const Metadata& own) {
  Metadata fields{{"format", "xrds"}, {"version", "1"},   {"architecture", architecture},
                  {"scale", "4"},     {"channels", "64"}, {"transfer", "none"}};
  for (const auto& [key, value] : own) fields[key] = value;
  return fields;
}

const Metadata kEdsrFields =
    fieldsOf("edsr", {{"channels", "256"}, {"blocks", "32"}, {"residual_divisor", "10"}, {"range", "255"}});
const Metadata kEdsrBaselineFields = fieldsOf("edsr", {{"blocks", "16"}, {"residual_divisor", "1"}, {"range", "255"}});
const Metadata kRcanFields =
    fieldsOf("rcan", {{"groups", "10"}, {"blocks", "20"}, {"reduction", "16"}, {"range", "255"}});
const Metadata kSwinIrFields = fieldsOf("swinir", {{"channels", "180"},
                                                   {"groups", "6"},
                                                   {"blocks", "6"},
                                                   {"window", "8"},
                                                   {"head_channels", "30"},
                                                   {"mlp_ratio", "2"},
                                                   {"upsampler", "pixelshuffle"},
                                                   {"range", "1"}});
const Metadata kSwinIrLightFields = fieldsOf("swinir", {{"channels", "60"},
                                                        {"groups", "4"},
                                                        {"blocks", "6"},
                                                        {"window", "8"},
                                                        {"head_channels", "10"},
                                                        {"mlp_ratio", "2"},
                                                        {"upsampler", "pixelshuffledirect"},
                                                        {"range", "1"}});
const Metadata kMssplFields = fieldsOf("msspl", {{"groups", "3"}, {"blocks", "5"}, {"aux_inputs", "albedo,normal"}});

struct Size {
  const char* name;
  const Metadata* fields;
  double millionParameters;  // as published; SwinIR's without its tables of relative positions
  double gigaMultiplyAdds;   // as others count them for 1280 x 720 at scale 4; 0: not published
};

class PublishedSize : public testing::TestWithParam<Size> {};

TEST_P(PublishedSize, IsThatOfTheForwardPass) {
  const NetworkConfig config = parseConfig(*GetParam().fields);
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
                         testing::Values(Size{"Edsr", &kEdsrFields, 43.09, 2895},
                                         Size{"EdsrBaseline", &kEdsrBaselineFields, 1.518, 114},
                                         Size{"Rcan", &kRcanFields, 15.59, 917},
                                         Size{"SwinIr", &kSwinIrFields, 11.85, 0},
                                         Size{"SwinIrLight", &kSwinIrLightFields, 0.897, 0}),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(SuperResolution, FieldsAreKept) {
  for (const Metadata* fields :
       {&kEdsrFields, &kEdsrBaselineFields, &kRcanFields, &kSwinIrFields, &kSwinIrLightFields, &kMssplFields})
    EXPECT_EQ(describe(parseConfig(*fields)), *fields);
}

TEST(SuperResolution, RefusesFieldsThatMakeNoNetwork) {
  const auto with = [](Metadata fields, const char* key, const char* value) {
    fields[key] = value;
    return fields;
  };
  EXPECT_THROW(parseConfig(with(kEdsrFields, "scale", "3")), Error);
  EXPECT_THROW(parseConfig(with(kEdsrFields, "channels", "66")), Error);
  EXPECT_THROW(parseConfig(with(kEdsrFields, "residual_divisor", "0")), Error);
  EXPECT_THROW(parseConfig(with(kRcanFields, "reduction", "24")), Error);
  EXPECT_THROW(parseConfig(with(kSwinIrFields, "head_channels", "32")), Error);
  EXPECT_THROW(parseConfig(with(kSwinIrFields, "window", "7")), Error);
  EXPECT_THROW(parseConfig(with(kSwinIrFields, "upsampler", "nearest+conv")), Error);
  EXPECT_THROW(parseConfig(with(kMssplFields, "scale", "1")), Error);
  EXPECT_THROW(parseConfig(with(kMssplFields, "aux_inputs", "albedo,albedo")), Error);
}

// 2 blocks + 2 convolutions of EDSR see six pixels, and the way up three more.
TEST(SuperResolution, SeesAsFarAsItsLayers) {
  Metadata edsr = kEdsrFields;
  edsr["channels"] = "16";
  edsr["blocks"] = "2";
  const NetworkConfig config = parseConfig(edsr);
  EXPECT_GE(exactHalo(config), 8u);
  EXPECT_LE(exactHalo(config), 40u);
  EXPECT_FALSE(seesWholeFrame(config));
  EXPECT_TRUE(seesWholeFrame(parseConfig(kRcanFields)));
}

TEST(SuperResolution, HasNoExactTilesWhereGatesAreOfTheWholeFrame) {
  Metadata rcan = kRcanFields;
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
