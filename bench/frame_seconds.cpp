// Frames of the C++ API, timed one by one on demand, for bench/python_overhead.py:
//   xrds_frame_seconds MODEL WIDTH HEIGHT     for each line of standard input a frame, and a line with its seconds
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>

#include "xrds/shipped_models.h"
#include "xrds/xrds.hpp"

namespace {

std::vector<float> noise(size_t count, uint32_t seed) {
  std::vector<float> values(count);
  for (float& value : values) value = 0.05F + static_cast<float>((seed = seed * 1664525 + 1013904223) >> 8) * 0x1p-24F;
  return values;
}

void run(const std::string& name, uint32_t width, uint32_t height) {
  xrds::Device device;
  const xrds::Model model(xrds::findModel(name));
  const uint32_t wide = width * model.scale(), high = height * model.scale();
  xrds::Upscaler upscaler(device, model, width, height, {.tune = xrds::Upscaler::Tune::never});
  const std::vector<float> colour = noise(size_t{3} * width * height, 1), full = noise(size_t{3} * wide * high, 2);
  const std::vector<xrds::PixelView> auxiliary(model.auxiliaryInputs().size(), {full.data(), wide, high});
  for (std::string line; std::getline(std::cin, line);) {
    const auto start = std::chrono::steady_clock::now();
    std::vector<float> output(full.size());
    upscaler.run({colour.data(), width, height}, auxiliary, output);
    std::printf("%.9f\n", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    std::fflush(stdout);
  }
}

}  // namespace

int main(int count, char** words) {
  try {
    if (count != 4) throw xrds::Error("Expected the name of a model, and width and height of its frames.");
    run(words[1], static_cast<uint32_t>(std::atoi(words[2])), static_cast<uint32_t>(std::atoi(words[3])));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
