#include "shaders/host_pixels/host_pixels.h"

#include <algorithm>

namespace xrds {
namespace {

constexpr ValueId kHost = 0, kGraph = 1;

// A range of bytes, from the last offset that can be bound on.
Binding bound(ValueId value, Access access, uint64_t begin, uint64_t end) {
  const uint64_t from = begin / kBindingAlignment * kBindingAlignment;
  return {.value = value,
          .access = access,
          .kind = BindingKind::storage,
          .byteOffset = from,
          .byteSize = alignUp(end - from, 4)};
}

void check(const HostPixels& pixels) {
  XRDS_CHECK(pixels.width > 0 && pixels.height > 0);
  XRDS_CHECK(pixels.channels == 4 || pixels.channels == (pixels.isAlpha ? 1u : 3u));
  XRDS_CHECK_EQ((pixels.byteOffset | pixels.rowBytes) % 4, 0u);
  XRDS_CHECK_LE(uint64_t{pixels.width} * pixels.channels * byteSize(pixels.type), pixels.rowBytes);
}

uint64_t rowAt(const HostPixels& pixels, uint64_t y) { return pixels.byteOffset + y * pixels.rowBytes; }

uint64_t endOfRow(const HostPixels& pixels, uint64_t y) {
  return rowAt(pixels, y) + uint64_t{pixels.width} * pixels.channels * byteSize(pixels.type);
}

// So that rows of both sides, and what a repair looks at around them, can be bound.
uint32_t rowsOfBand(uint64_t hostRowBytes, uint64_t graphRowBytes, const DeviceTraits& device) {
  const uint64_t most = std::min<uint64_t>(device.maxStorageBufferRange, uint64_t{1} << 30) - kBindingAlignment;
  const uint64_t rows = most / std::max(hostRowBytes, graphRowBytes);
  XRDS_CHECK_LT(2 * uint64_t{shader::kMostRepairRadius}, rows);
  return static_cast<uint32_t>(rows) - 2 * shader::kMostRepairRadius;
}

Dispatch launch(const char* program, const HostPixels& pixels, uint32_t width, uint32_t rows) {
  return {.program = program,
          .specialization = {pixels.type == DataType::f16, pixels.isAlpha},
          .groupCount = imageGroups(width, rows)};
}

}  // namespace

std::vector<Dispatch> dispatches(const TakePixels& take, const DeviceTraits& device) {
  const HostPixels& source = take.source;
  const TensorView& target = take.target;
  check(source);
  XRDS_CHECK(target.type == DataType::f32 && target.channels == target.channelStride);
  XRDS_CHECK_LE(take.channel + 3 + take.cleared, target.channels);
  XRDS_CHECK_LE(take.top + target.height, source.height);
  const auto width = static_cast<int64_t>(source.width);
  const uint32_t most = rowsOfBand(source.rowBytes, target.rowByteSize(), device);
  std::vector<Dispatch> launches;
  for (uint32_t begin = 0; begin < target.height; begin += most) {
    const uint32_t end = std::min(target.height, begin + most), around = shader::kMostRepairRadius;
    const uint32_t first = take.top + begin - std::min(take.top + begin, around),
                   last = std::min(source.height, take.top + end + around);
    Dispatch band = launch("take_pixels", source, target.width, end - begin);
    band.bindings = {bound(kHost, Access::read, rowAt(source, first), endOfRow(source, last - 1)),
                     bound(kGraph, Access::write, begin * target.rowByteSize(), end * target.rowByteSize())};
    const uint64_t word = (rowAt(source, first) - band.bindings[0].byteOffset) / 4;
    band.pushConstants =
        pushBytes(shader::TakePixelsParams{.firstWord = static_cast<uint32_t>(word),
                                           .rowWords = static_cast<uint32_t>(source.rowBytes / 4),
                                           .channels = static_cast<int>(source.channels),
                                           .sourceWidth = static_cast<int>(source.width),
                                           .sourceBegin = static_cast<int>(first),
                                           .sourceEnd = static_cast<int>(last),
                                           .left = static_cast<int>((take.left % width + width) % width),
                                           .top = static_cast<int>(take.top),
                                           .width = static_cast<int>(target.width),
                                           .rowBegin = static_cast<int>(begin),
                                           .rowEnd = static_cast<int>(end),
                                           .stride = static_cast<int>(target.channels),
                                           .channel = static_cast<int>(take.channel),
                                           .cleared = static_cast<int>(take.cleared),
                                           .targetOrigin = static_cast<int>(band.bindings[1].byteOffset / 4)});
    launches.push_back(std::move(band));
  }
  return launches;
}

std::vector<Dispatch> dispatches(const GivePixels& give, const DeviceTraits& device) {
  const HostPixels& target = give.target;
  const TensorView& source = give.source;
  check(target);
  XRDS_CHECK(source.type == DataType::f32 && source.channels == 4 && source.channelStride == 4);
  XRDS_CHECK(give.left + give.width <= source.width && give.top + give.height <= source.height);
  XRDS_CHECK(give.x + give.width <= target.width && give.y + give.height <= target.height);
  XRDS_CHECK_EQ((give.x | give.left) % 2, 0u);
  XRDS_CHECK(!target.isAlpha || target.channels == 4);
  const uint32_t most = rowsOfBand(target.rowBytes, source.rowByteSize(), device);
  std::vector<Dispatch> launches;
  for (uint32_t begin = 0; begin < give.height; begin += most) {
    const uint32_t end = std::min(give.height, begin + most);
    Dispatch band = target.isAlpha ? launch("give_alpha", target, give.width, end - begin)
                                   : launch("give_pixels", target, ceilDivide(give.width, 2), end - begin);
    if (!target.isAlpha) band.specialization[1] = give.marksLost;
    band.bindings = {bound(kHost, Access::write, rowAt(target, give.y + begin), endOfRow(target, give.y + end - 1)),
                     bound(kGraph, Access::read, (give.top + begin) * source.rowByteSize(),
                           (give.top + end) * source.rowByteSize())};
    const uint64_t first = rowAt(target, give.y + begin) + uint64_t{give.x} * target.channels * byteSize(target.type) -
                           band.bindings[0].byteOffset;
    band.pushConstants =
        pushBytes(shader::GivePixelsParams{.firstWord = static_cast<uint32_t>(first / 4),
                                           .rowWords = static_cast<uint32_t>(target.rowBytes / 4),
                                           .channels = static_cast<int>(target.channels),
                                           .width = static_cast<int>(give.width),
                                           .rowBegin = static_cast<int>(begin),
                                           .rowEnd = static_cast<int>(end),
                                           .sourceWidth = static_cast<int>(source.width),
                                           .left = static_cast<int>(give.left),
                                           .top = static_cast<int>(give.top),
                                           .sourceOrigin = static_cast<int>(band.bindings[1].byteOffset / 16)});
    launches.push_back(std::move(band));
  }
  return launches;
}

Dispatch takeExposure(uint64_t byteOffset) {
  const Binding source = bound(kHost, Access::read, byteOffset, byteOffset + 4);
  return {.program = "take_exposure",
          .specialization = {static_cast<uint32_t>((byteOffset - source.byteOffset) / 4)},
          .bindings = {source, bound(kGraph, Access::write, 0, 16)}};
}

}  // namespace xrds
