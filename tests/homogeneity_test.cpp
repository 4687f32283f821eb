// The result scales with the colour, and nothing comes out of black, whatever a shipped model was trained to.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>

#include "frames/session.h"
#include "tests/harness.h"
#include "tests/noise_frame.h"
#include "tests/print_case.h"

namespace xrds {
namespace {

// Low-resolution pixels that a result may take its light from: of the base image, and of the prefilter's taps.
uint32_t reachOf(const NetworkConfig& config) {
  const uint32_t taps[] = {0, 2, 6 + 1, 18 + 4};
  return 2 + taps[config.prefilter];
}

FrameShape frameFor(const NetworkConfig& config) { return {14, 11 + reachOf(config)}; }

std::vector<std::string> shippedModels() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(XRDS_SOURCE_FOLDER "/models"))
    if (entry.path().extension() == ".safetensors") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

// RMS of the difference over the RMS of `expected`.
double relativeRms(const std::vector<float>& found, const std::vector<float>& expected, double factor) {
  double difference = 0, power = 0;
  for (size_t i = 0; i < found.size(); ++i) {
    const double scaled = factor * expected[i];
    difference += (found[i] - scaled) * (found[i] - scaled);
    power += scaled * scaled;
  }
  return std::sqrt(difference / power);
}

class Homogeneity : public testing::TestWithParam<std::tuple<std::string, Precision>> {
 protected:
  Homogeneity()
      : model_(NetworkModel::read(XRDS_SOURCE_FOLDER "/models/" + std::get<0>(GetParam()) + ".safetensors")),
        shape_(frameFor(model_.config())),
        frame_(model_.config(), shape_) {}

  // The result of the frame, the light of each low-resolution pixel times a factor.
  std::vector<float> run(bool autoExposure, const std::function<float(uint32_t x, uint32_t c)>& factor,
                         float exposure = 1) {
    std::optional<Session>& session = autoExposure ? automatic_ : given_;
    if (!session)
      session.emplace(test::gpu(), model_, shape_,
                      SessionOptions{.precision = std::get<1>(GetParam()), .autoExposure = autoExposure});
    test::NoiseFrame frame = frame_;
    const auto light = [&](std::vector<float>& image, uint32_t scale) {
      for (size_t i = 0; i < image.size(); ++i)
        image[i] *= factor(static_cast<uint32_t>(i / 3 % (shape_.width * scale) / scale), i % 3);
    };
    light(frame.colour, 1);
    for (const size_t input : model_.config().radianceInputs()) light(frame.auxiliary[input], frame.scale);
    session->run(frame.input(autoExposure ? std::nullopt : std::optional(exposure)), frame.output);
    return frame.output;
  }

  std::vector<float> run(bool autoExposure, float factor, float exposure = 1) {
    return run(
        autoExposure, [&](uint32_t, uint32_t) { return factor; }, exposure);
  }

  const NetworkModel model_;
  const FrameShape shape_;
  const test::NoiseFrame frame_;
  std::optional<Session> automatic_, given_;
};

// A factor that is no power of two rounds every pixel anew, which fp16 storage amplifies to some 1e-4.
TEST_P(Homogeneity, ResultScalesWithTheColour) {
  constexpr float kExposure = 0.7f;
  const std::vector<float> automatic = run(true, 1.f), given = run(false, 1.f, kExposure);
  for (const float factor : {1e-12f, 1e-6f, 0.3f, 1e3f, 1e6f}) {
    EXPECT_LT(relativeRms(run(true, factor), automatic, factor), 1e-3) << factor;
    EXPECT_LT(relativeRms(run(false, factor, kExposure / factor), given, factor), 1e-3) << factor;
  }
}

TEST_P(Homogeneity, BlackGivesBlack) {
  const std::vector<float> expected(frame_.output.size(), 0.f);
  EXPECT_EQ(run(true, 0.f), expected);
  EXPECT_EQ(run(false, 0.f, 1), expected);
}

// One half of the frame, and one channel of all of it.
TEST_P(Homogeneity, NothingIsDrawnWhereNothingAroundIsLit) {
  constexpr uint32_t kLit = 5;  // columns
  const std::vector<float> output = run(true, [](uint32_t x, uint32_t c) { return x >= kLit || c == 2 ? 0.f : 1.f; });
  const uint32_t s = model_.config().scale, width = s * shape_.width, reach = reachOf(model_.config());
  float brightest = 0;
  for (uint32_t y = 0; y < s * shape_.height; ++y)
    for (uint32_t x = 0; x < width; ++x)
      for (uint32_t c = 0; c < 3; ++c) {
        const float value = output[3 * (size_t{y} * width + x) + c];
        if (x >= s * (kLit + reach) || c == 2) {
          ASSERT_EQ(value, 0) << x << " " << y << " " << c;
        }
        brightest = std::max(brightest, value);
      }
  EXPECT_GT(brightest, 0.1f);
}

std::string nameOf(const testing::TestParamInfo<Homogeneity::ParamType>& info) {
  std::string name = std::get<0>(info.param);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Fp32, Homogeneity,
                         testing::Combine(testing::ValuesIn(shippedModels()), testing::Values(Precision::fp32)),
                         nameOf);
INSTANTIATE_TEST_SUITE_P(Fp16, Homogeneity,
                         testing::Combine(testing::Values("xrds-x4-compact", "xrds-x4-nano"),
                                          testing::Values(Precision::fp16)),
                         nameOf);

}  // namespace
}  // namespace xrds
