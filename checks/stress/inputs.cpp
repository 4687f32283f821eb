#include "checks/stress/inputs.h"

#include <cmath>
#include <limits>
#include <random>

#include "xrds/auxiliary_input.h"

namespace xrds {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kLargest = std::numeric_limits<float>::max(), kDenormal = 1e-40f;

/// Where a value is asked for: a pixel and channel, and random numbers.
struct Sample {
  int x = 0, y = 0, channel = 0, width = 0, height = 0;
  std::mt19937& random;

  float uniform() const { return static_cast<float>(random() >> 8) * 0x1p-24f; }
  float normal() const {
    float sum = -6;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }
  bool odd() const { return (x + y) % 2 != 0; }
  bool isCentre() const { return x == width / 2 && y == height / 2; }
};

/// A row of the tables: the value of every sample.
struct Pattern {
  StressInput input;
  float (*value)(const Sample&);
};

// The noise of a path tracer: radiances over some orders of magnitude.
float noise(const Sample& s) { return 0.2f * std::exp(1.2f * s.normal()); }

float anything(const Sample& s) {
  const float kinds[] = {0, 1e-30f, kDenormal, 1, 65504, 1e6f, 1e10f, 1e30f, kLargest, -1, -1e30f, kNan, kInfinity};
  return kinds[static_cast<size_t>(s.uniform() * 13)];
}

constexpr Pattern kColours[] = {
    {{"noise", true}, noise},
    {{"gradient", true},
     [](const Sample& s) {
       return 0.05f + static_cast<float>(s.x + 2 * s.y + s.channel) / static_cast<float>(s.width);
     }},
    {{"lamp of 65504", true}, [](const Sample& s) { return s.isCentre() ? 65504.0f : noise(s); }},
    {{"checkerboard 0.02 and 2", true}, [](const Sample& s) { return s.odd() ? 2.0f : 0.02f; }},
    {{"constant 0.18", true}, [](const Sample&) { return 0.18f; }},
    {{"noise x 1e-5", true}, [](const Sample& s) { return 1e-5f * noise(s); }},
    {{"noise x 1e4", true}, [](const Sample& s) { return 1e4f * noise(s); }},
    {{"black"}, [](const Sample&) { return 0.0f; }},
    {{"constant 1e-30"}, [](const Sample&) { return 1e-30f; }},
    {{"constant 1e-8"}, [](const Sample&) { return 1e-8f; }},
    {{"constant 65504"}, [](const Sample&) { return 65504.0f; }},
    {{"constant 1e10"}, [](const Sample&) { return 1e10f; }},
    {{"constant 1e30"}, [](const Sample&) { return 1e30f; }},
    {{"constant 3.4e38"}, [](const Sample&) { return kLargest; }},
    {{"denormals"}, [](const Sample& s) { return kDenormal * s.uniform(); }},
    {{"fireflies of 1e6"}, [](const Sample& s) { return s.uniform() < 0.05f ? 1e6f : noise(s); }},
    {{"noise x 1e30"}, [](const Sample& s) { return 1e30f * noise(s); }},
    {{"all magnitudes"}, [](const Sample& s) { return std::exp(176 * s.uniform() - 88); }},
    {{"checkerboard 0 and 65504"}, [](const Sample& s) { return s.odd() ? 65504.0f : 0.0f; }},
    {{"checkerboard 1e-30 and 1e30"}, [](const Sample& s) { return s.odd() ? 1e30f : 1e-30f; }},
    {{"one pixel of 1"}, [](const Sample& s) { return s.isCentre() ? 1.0f : 0.0f; }},
    {{"one pixel of 1e6"}, [](const Sample& s) { return s.isCentre() ? 1e6f : 0.0f; }},
    {{"one pixel of 3.4e38"}, [](const Sample& s) { return s.isCentre() ? kLargest : 1e-8f; }},
    {{"one channel of 1e10"}, [](const Sample& s) { return s.channel == 1 ? 1e10f : noise(s); }},
    {{"one NaN"}, [](const Sample& s) { return s.isCentre() ? kNan : noise(s); }},
    {{"NaN alone"}, [](const Sample&) { return kNan; }},
    {{"infinities"}, [](const Sample& s) { return s.uniform() < 0.2f ? kInfinity : noise(s); }},
    {{"infinity alone"}, [](const Sample&) { return kInfinity; }},
    {{"minus infinity alone"}, [](const Sample&) { return -kInfinity; }},
    {{"half negative"}, [](const Sample& s) { return noise(s) - 0.2f; }},
    {{"constant -1e30"}, [](const Sample&) { return -1e30f; }},
    {{"anything"}, anything},
};

// Channels 0 to 2 are the albedo's, 3 to 5 the normal's.
constexpr Pattern kAuxiliaries[] = {
    {{"noisy albedo and normal", true},
     [](const Sample& s) { return s.channel < 3    ? s.uniform()
                                  : s.channel == 5 ? 0.8f
                                                   : 0.6f * s.uniform() - 0.3f; }},
    {{"flat albedo and normal", true},
     [](const Sample& s) {
       return s.channel < 3 ? 0.2f + 0.2f * static_cast<float>(s.channel) : s.channel == 5 ? 1.f : 0.f;
     }},
    {{"checkerboard", true},
     [](const Sample& s) { return s.channel < 3              ? (s.odd() ? 0.9f : 0.1f)
                                  : s.channel == 3 + s.odd() ? 1.f
                                                             : 0.f; }},
    {{"zeros"}, [](const Sample&) { return 0.0f; }},
    {{"ones"}, [](const Sample&) { return 1.0f; }},
    {{"albedo of 4 and more"}, [](const Sample& s) { return 4 + 4 * s.uniform(); }},
    {{"normals not normalized"}, [](const Sample& s) { return s.channel < 3 ? s.uniform() : 200 * s.uniform() - 100; }},
    {{"65504"}, [](const Sample& s) { return s.odd() ? 65504.0f : -65504.0f; }},
    {{"1e30"}, [](const Sample& s) { return s.odd() ? 1e30f : -1e30f; }},
    {{"NaN here and there"}, [](const Sample& s) { return s.uniform() < 0.1f ? kNan : s.uniform(); }},
    {{"NaN alone"}, [](const Sample&) { return kNan; }},
    {{"infinities"}, [](const Sample& s) { return s.odd() ? kInfinity : -kInfinity; }},
    {{"denormals"}, [](const Sample& s) { return kDenormal * (s.uniform() - 0.5f); }},
    {{"anything"}, anything},
};

template <size_t N>
std::span<const StressInput> inputsOf(const Pattern (&patterns)[N]) {
  static const std::vector<StressInput> inputs = [&] {
    std::vector<StressInput> all;
    for (const Pattern& pattern : patterns) all.push_back(pattern.input);
    return all;
  }();
  return inputs;
}

Image imageOf(const Pattern& pattern, uint32_t height, uint32_t width, int firstChannel, uint32_t seed) {
  std::mt19937 random(seed);
  Image image(static_cast<int>(width), static_cast<int>(height), 3);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < 3; ++c)
        image.at(x, y, c) = pattern.value({x, y, firstChannel + c, image.width, image.height, random});
  return image;
}

}  // namespace

std::span<const StressInput> stressColours() { return inputsOf(kColours); }
std::span<const StressInput> stressAuxiliaries() { return inputsOf(kAuxiliaries); }

Image stressColour(size_t which, FrameShape frame, uint32_t seed) {
  return imageOf(kColours[which], frame.height, frame.width, 0, seed);
}

std::vector<Image> stressAuxiliary(size_t which, size_t colour, const NetworkConfig& config, FrameShape frame,
                                   uint32_t seed) {
  std::vector<Image> images;
  for (const std::string& kind : config.auxInputs) {
    const AuxiliaryInput* input = findAuxiliaryInput(kind);
    const bool radiance = input && input->isRadiance;
    images.push_back(imageOf(radiance ? kColours[colour] : kAuxiliaries[which], config.scale * frame.height,
                             config.scale * frame.width, radiance || kind == kAlbedo.name ? 0 : 3, ++seed));
  }
  return images;
}

}  // namespace xrds
