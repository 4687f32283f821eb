// Upscales a small picture with an installed library and model: consumer MODEL
#include <cmath>
#include <cstdio>
#include <span>
#include <vector>

#include "xrds/alpha.h"
#include "xrds/examination.h"
#include "xrds/oidn_import.h"
#include "xrds/shipped_models.h"
#include "xrds/stress.h"
#include "xrds/tuning.h"
#include "xrds/xrds.hpp"

int main(int, char** arguments) {
  constexpr uint32_t kWidth = 12, kHeight = 8;
  try {
    xrds::Device device;
    const xrds::Model model(arguments[1]);
    const uint32_t scale = model.scale(), width = scale * kWidth, height = scale * kHeight;
    std::vector<float> colour(3 * kWidth * kHeight, 0.5F), albedo(size_t{3} * width * height, 0.4F);
    colour[40] = NAN;
    albedo[100] = INFINITY;
    albedo[104] = -INFINITY;  // of the pixel beside
    std::vector<float> normal(albedo.size(), 0.F), output(albedo.size(), -1.F);
    for (size_t p = 2; p < normal.size(); p += 3) normal[p] = 1;
    xrds::Upscaler upscaler(device, model, kWidth, kHeight, {});
    const xrds::PixelView auxiliary[] = {{albedo.data(), width, height}, {normal.data(), width, height}};
    if (!upscaler.run({colour.data(), kWidth, kHeight}, auxiliary, output)) return 1;
    for (const float value : output)
      if (!std::isfinite(value) || value < 0 || value > 2) return 2;
    const auto [badColours, badAuxiliaries, badOutputs] = upscaler.repairs();
    if (badColours != 1 || badAuxiliaries != 2 || badOutputs != 0) return 4;
    std::printf("%u x %u\n", width, height);
    try {
      upscaler.run({colour.data(), kWidth, kHeight}, auxiliary, std::span(output).first(output.size() - 1));
      return 5;
    } catch (const xrds::Error&) {  // the output has no room for the last number
    }
    return 0;
  } catch (const xrds::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 3;
  }
}
