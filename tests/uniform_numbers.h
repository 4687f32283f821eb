#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace xrds::test {

/// So many numbers from `least` to `most`, the same for a seed.
inline std::vector<float> uniformNumbers(size_t count, float least, float most, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> numbers(least, most);
  std::vector<float> found(count);
  for (float& number : found) number = numbers(random);
  return found;
}

}  // namespace xrds::test
