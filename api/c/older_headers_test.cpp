// Structures of programs that were built with an older header, or with a later one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "engine/half.h"
#include "tests/c_api.h"

namespace xrds {
namespace {

using namespace test;

// What a header of an older version did not have is behind the structure, which is the caller's own memory.
TEST_F(CApi, TakesStructuresOfOlderHeaders) {
  XrdsUpscalerOptions options;
  std::memset(&options, 0x5A, sizeof options);
  options.structSize = offsetof(XrdsUpscalerOptions, exposure);
  options.fp16 = 0;
  xrdsDestroyUpscaler(upscaler);
  upscaler = nullptr;
  ASSERT_EQ(xrdsCreateUpscaler(device, model, kWidth, kHeight, &options, &upscaler), XRDS_OK) << xrdsGetMessage();
  ASSERT_EQ(run(), XRDS_OK) << xrdsGetMessage();
  EXPECT_EQ(outputPixels, expected());

  XrdsDeviceDescription description;
  std::memset(&description, 0x5A, sizeof description);
  constexpr size_t kOlder = offsetof(XrdsDeviceDescription, kernelFamily) + 3;  // 600, a multiple of 4
  description.structSize = kOlder;
  ASSERT_EQ(xrdsDescribeOpenDevice(device, &description), XRDS_OK) << xrdsGetMessage();
  EXPECT_EQ(description.structSize, kOlder);
  EXPECT_STREQ(description.uuid, Device().description().uuid.c_str());
  const auto* bytes = reinterpret_cast<const unsigned char*>(&description);
  EXPECT_TRUE(std::all_of(bytes + kOlder, bytes + sizeof description, [](unsigned char byte) { return byte == 0x5A; }));

  options = xrdsUpscalerOptionsDefault();
  options.structSize += 8;  // of a later header
  XrdsUpscaler* made = nullptr;
  EXPECT_EQ(xrdsCreateUpscaler(device, model, kWidth, kHeight, &options, &made), XRDS_ERROR_ARGUMENT);
  EXPECT_NE(std::string(xrdsGetMessage()).find("structSize of " + std::to_string(sizeof options + 8)),
            std::string::npos)
      << xrdsGetMessage();
}

/// The first `size` bytes of each structure, one behind the other and nothing behind the last, as a program has them
/// whose header had no more.
template <class T>
class OlderList {
 public:
  OlderList(std::initializer_list<T> structures, size_t size) {
    for (T structure : structures) {
      structure.structSize = static_cast<uint32_t>(size);
      const auto* const bytes = reinterpret_cast<const std::byte*>(&structure);
      bytes_.insert(bytes_.end(), bytes, bytes + size);
    }
  }
  T* data() { return reinterpret_cast<T*>(bytes_.data()); }

 private:
  std::vector<std::byte> bytes_;
};

constexpr size_t kLayerBefore = offsetof(XrdsLayer, followsAlbedo), kReportBefore = offsetof(XrdsLayerReport, unshared);

TEST_F(CApi, TakesListsOfOlderHeaders) {
  std::vector<float> half(colourPixels), results[2] = {outputPixels, outputPixels}, wanted[2];
  for (float& value : half) value /= 2;
  XrdsLayer layers[] = {xrdsLayerDefault(), xrdsLayerDefault()};
  for (size_t i = 0; i < 2; ++i) {
    layers[i].light = rgb(half, kWidth, kHeight);
    layers[i].output = rgb(results[i], kWide, kHigh);
  }
  XrdsLayerSet set = xrdsLayerSetDefault();
  set.layerCount = 2;
  const auto upscale = [&](const XrdsLayer* list, XrdsLayerReport* reports) {
    set.layers = list;
    const XrdsLayerSet sets[] = {set, set};
    return xrdsUpscaleLayers(upscaler, &colour, auxiliary, 2, &output, sets, 2, reports, nullptr, nullptr);
  };
  ASSERT_EQ(upscale(layers, nullptr), XRDS_OK) << xrdsGetMessage();
  for (size_t i = 0; i < 2; ++i) wanted[i].swap(results[i]), results[i].assign(wanted[i].size(), -1);
  for (size_t i = 0; i < 2; ++i) layers[i].output = rgb(results[i], kWide, kHigh);
  OlderList<XrdsLayer> older({layers[0], layers[1]}, kLayerBefore);
  OlderList<XrdsLayerReport> reports({XrdsLayerReport{}, XrdsLayerReport{}}, kReportBefore);
  ASSERT_EQ(upscale(older.data(), reports.data()), XRDS_OK) << xrdsGetMessage();
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(results[i], wanted[i]);
    XrdsLayerReport report{};
    std::memcpy(&report, reinterpret_cast<const std::byte*>(reports.data()) + i * kReportBefore, kReportBefore);
    EXPECT_EQ(report.structSize, kReportBefore);
    EXPECT_NEAR(report.share, 1, 1e-6);
  }
  layers[1].structSize = kLayerBefore;  // of another header than the first one
  EXPECT_EQ(upscale(layers, nullptr), XRDS_ERROR_ARGUMENT);
  EXPECT_NE(std::string(xrdsGetMessage()).find("expected " + std::to_string(sizeof(XrdsLayer)) + ", as of the first"),
            std::string::npos)
      << xrdsGetMessage();
}

constexpr size_t kFrameBefore = offsetof(XrdsTemporalFrame, lowCounts);  // of the first 0.1.0

TEST_F(CApi, TakesTemporalFramesOfOlderHeaders) {
  XrdsTemporalFilter* filter = nullptr;
  ASSERT_EQ(xrdsCreateTemporalFilter(device, kWidth, kHeight, kScale, &filter), XRDS_OK) << xrdsGetMessage();
  const std::vector<float> still(2 * kWide * kHigh, 0);
  std::vector<float> pixels[3], counts(kWidth * kHeight, -1), wanted(colourPixels.size()), found(wanted);
  XrdsTemporalFrame frames[3], merged = xrdsTemporalFrameDefault();
  for (uint32_t i = 0; i < 3; ++i) {
    pixels[i] = noise(wanted.size(), 10 + i);
    frames[i] = xrdsTemporalFrameDefault();
    frames[i].colour = rgb(pixels[i], kWidth, kHeight);
    frames[i].albedo = auxiliary[0];
    frames[i].toPrevious = frames[i].toNext = still.data();
  }
  merged.colour = rgb(wanted, kWidth, kHeight);
  ASSERT_EQ(xrdsMergeFrames(filter, &frames[0], &frames[1], 2, nullptr, 0, &merged), XRDS_OK) << xrdsGetMessage();
  EXPECT_NE(wanted, pixels[0]);
  for (XrdsTemporalFrame& frame : frames) frame.lowCounts = counts.data();  // behind the older structures
  merged.lowCounts = counts.data();
  merged.colour = rgb(found, kWidth, kHeight);
  OlderList<XrdsTemporalFrame> present({frames[0]}, kFrameBefore), before({frames[1], frames[2]}, kFrameBefore),
      result({merged}, kFrameBefore);
  ASSERT_EQ(xrdsMergeFrames(filter, present.data(), before.data(), 2, nullptr, 0, result.data()), XRDS_OK)
      << xrdsGetMessage();
  EXPECT_EQ(found, wanted);
  EXPECT_EQ(counts, std::vector<float>(counts.size(), -1));
  xrdsDestroyTemporalFilter(filter);
}

}  // namespace
}  // namespace xrds
