#include <gtest/gtest.h>

#include <algorithm>

#include "tests/engine_programs.h"
#include "tests/harness.h"
#include "xrds/error.h"

namespace xrds {
namespace {

// Where the host sees the device's memory, and through a staging copy.
class BufferCopies : public testing::TestWithParam<bool> {
 protected:
  Gpu gpu_{[] {
    DeviceOptions options = test::gpuOptions();
    options.forceStaging = GetParam();
    return options;
  }()};
};

TEST_P(BufferCopies, GiveBackWhatWasUploaded) {
  const std::vector<float> numbers = test::randomNumbers(1001, 1);
  Buffer buffer(gpu_, 5000);
  EXPECT_EQ(buffer.byteSize(), 5000u);
  buffer.fill(0);
  test::uploadFloats(buffer, 36, numbers);
  EXPECT_EQ(test::downloadFloats(buffer, 36, 1001), numbers);
  EXPECT_EQ(test::downloadFloats(buffer, 32, 1)[0], 0);
  EXPECT_EQ(test::downloadFloats(buffer, 36 + 4004, 1)[0], 0);
}

TEST_P(BufferCopies, ReachBeyondOneStagingBuffer) {
  const std::vector<float> numbers = test::randomNumbers((9u << 20) + 3, 2);
  Buffer buffer(gpu_, numbers.size() * 4 + 256);
  test::uploadFloats(buffer, 256, numbers);
  EXPECT_EQ(test::downloadFloats(buffer, 256, numbers.size()), numbers);
}

// More rows than one staging buffer holds.
TEST_P(BufferCopies, GoRowByRow) {
  constexpr uint64_t kRowBytes = 3u << 20;
  constexpr uint32_t kRows = 13;
  Buffer buffer(gpu_, 256 + kRowBytes * kRows + 4);
  buffer.fill(0x7F7F7F7F);
  std::vector<uint32_t> written(kRows), read(kRows);  // how often
  buffer.uploadRows(256, kRowBytes, kRows, [&](uint32_t row, std::span<std::byte> bytes) {
    ASSERT_EQ(bytes.size(), kRowBytes);
    ++written[row];
    std::fill(bytes.begin(), bytes.end(), std::byte{static_cast<uint8_t>(row)});
  });
  buffer.downloadRows(256, kRowBytes, kRows, [&](uint32_t row, std::span<const std::byte> bytes) {
    ASSERT_EQ(bytes.size(), kRowBytes);
    ++read[row];
    for (const std::byte byte : bytes) ASSERT_EQ(byte, std::byte{static_cast<uint8_t>(row)});
  });
  const std::vector<uint32_t> once(kRows, 1);
  EXPECT_EQ(written, once);
  EXPECT_EQ(read, once);
  std::byte around[8];
  buffer.download(252, std::span(around, 4));
  buffer.download(256 + kRowBytes * kRows, std::span(around).subspan(4));
  for (const std::byte byte : around) EXPECT_EQ(byte, std::byte{0x7F});
}

TEST_P(BufferCopies, FillReachesEveryWord) {
  Buffer buffer(gpu_, 1000);
  buffer.fill(0x3F800000);
  EXPECT_EQ(test::downloadFloats(buffer, 0, 250), std::vector<float>(250, 1));
}

TEST_P(BufferCopies, AreSeenByADispatchAndSeeItsResult) {
  Buffer buffer(gpu_, 4096);
  for (uint32_t round = 0; round < 3; ++round) {
    const std::vector<float> numbers(64, static_cast<float>(round));
    test::uploadFloats(buffer, 0, numbers);
    const PlacedDispatch placed = test::twicePlus(buffer, 0, 1024, 16, round);
    Recording(gpu_, {&placed, 1}).run();
    EXPECT_EQ(test::downloadFloats(buffer, 1024, 64), std::vector<float>(64, static_cast<float>(3 * round)));
  }
}

TEST_P(BufferCopies, RefuseToLeaveTheBuffer) {
  Buffer buffer(gpu_, 16);
  std::vector<std::byte> bytes(20);
  EXPECT_THROW(buffer.upload(0, bytes), std::logic_error);
  EXPECT_THROW(buffer.download(~uint64_t{0}, bytes), std::logic_error);
  EXPECT_THROW(buffer.uploadRows(0, 8, 3, [](uint32_t, std::span<std::byte>) {}), std::logic_error);
  EXPECT_THROW(buffer.downloadRows(8, 12, 1, [](uint32_t, std::span<const std::byte>) {}), std::logic_error);
  EXPECT_THROW(Buffer(gpu_, 0), std::logic_error);
}

INSTANTIATE_TEST_SUITE_P(All, BufferCopies, testing::Bool(),
                         [](const auto& info) { return info.param ? "staged" : "direct"; });

TEST(Buffer, TooLargeIsAnErrorWithBothSizes) {
  try {
    Buffer(test::gpu(), uint64_t{1} << 50);
    FAIL() << "a pebibyte was allocated";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("1073741824 MiB"), std::string::npos) << error.what();
  }
}

TEST(Buffer, MovesItsMemory) {
  Buffer first(test::gpu(), 16);
  test::uploadFloats(first, 0, std::vector<float>{1, 2, 3, 4});
  Buffer second = std::move(first);
  EXPECT_EQ(test::downloadFloats(second, 0, 4), (std::vector<float>{1, 2, 3, 4}));
}

}  // namespace
}  // namespace xrds
