#include "engine/bytes.h"

#include <cstring>

#include "engine/half.h"
#include "engine/parallel.h"

namespace xrds {

namespace {

constexpr uint64_t kNumbersOfThread = 1 << 16;  // fewer are converted sooner than a thread starts

}  // namespace

std::vector<std::byte> encode(std::span<const float> numbers, DataType type) {
  if (type == DataType::f32) {
    const auto bytes = std::as_bytes(numbers);
    return {bytes.begin(), bytes.end()};
  }
  std::vector<std::byte> bytes(2 * numbers.size());
  inParallel(numbers.size(), kNumbersOfThread, [&](uint64_t i, uint64_t end) {
    for (; i < end; ++i) {
      const uint16_t half = toHalf(numbers[i]);
      std::memcpy(&bytes[2 * i], &half, 2);
    }
  });
  return bytes;
}

std::vector<float> decode(std::span<const std::byte> bytes, DataType type) {
  std::vector<float> numbers(bytes.size() / byteSize(type));
  if (type == DataType::f32) {
    if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data(), 4 * numbers.size());
    return numbers;
  }
  inParallel(numbers.size(), kNumbersOfThread, [&](uint64_t i, uint64_t end) {
    for (; i < end; ++i) {
      uint16_t half = 0;
      std::memcpy(&half, &bytes[2 * i], 2);
      numbers[i] = fromHalf(half);
    }
  });
  return numbers;
}

uint64_t hashOf(std::span<const std::byte> bytes, uint64_t begin) {
  uint64_t hash = begin;
  for (const std::byte byte : bytes) hash = (hash ^ static_cast<uint64_t>(byte)) * 0x100000001b3;
  return hash;
}

}  // namespace xrds
