#include "api/temporal_filter.h"

#include <algorithm>
#include <atomic>

#include "api/c/handles.h"
#include "api/c/images.h"
#include "api/c/result.h"
#include "api/c/sized.h"
#include "api/finite_image.h"

using namespace xrds::c;

/// A filter with the device that it needs. `use` is held by the thread that runs it, `device->access` as well.
struct XrdsTemporalFilter {
  XrdsTemporalFilter(std::shared_ptr<XrdsDevice> on, uint32_t width, uint32_t height, uint32_t scale)
      : device(std::move(on)), width(width), height(height), scale(scale) {
    const std::lock_guard lock(device->access);
    filter.emplace(device->gpu, width, height, scale);
    deviceBytes = filter->deviceBytes();
  }
  ~XrdsTemporalFilter() {
    const std::lock_guard lock(device->access);
    filter.reset();
  }

  const std::shared_ptr<XrdsDevice> device;
  const uint32_t width, height, scale;
  size_t low() const { return size_t{width} * height; }  // pixels
  size_t full() const { return low() * scale * scale; }
  std::optional<xrds::FrameMerger> filter;
  std::atomic<uint64_t> deviceBytes = 0;  // as of the last call: who asks need not wait
  std::mutex use;
};

namespace {

/// A frame of the caller, and copies of images that the library cannot read where they are or that are not finite.
class ReadFrame {
 public:
  ReadFrame(const XrdsTemporalFrame& asGiven, const XrdsTemporalFilter& filter) {
    const XrdsTemporalFrame given = taken(asGiven, xrdsTemporalFrameDefault());
    const size_t pixels = filter.full();
    frame_.colour = read(given.colour, "colour", xrds::PixelKind::radiance);
    if (given.fullColour.channels[0])
      frame_.fullColour = read(given.fullColour, "full-resolution colour", xrds::PixelKind::radiance);
    if (given.albedo.channels[0]) frame_.albedo = read(given.albedo, "albedo", xrds::PixelKind::other);
    if (given.normal.channels[0]) frame_.normal = read(given.normal, "normal", xrds::PixelKind::other);
    if (given.depth) frame_.depth = {given.depth, pixels};
    if (given.toPrevious) frame_.toPrevious = {given.toPrevious, 2 * pixels};
    if (given.toNext) frame_.toNext = {given.toNext, 2 * pixels};
    if (given.lowCounts) frame_.lowCounts = {given.lowCounts, filter.low()};
    if (given.fullCounts) frame_.fullCounts = {given.fullCounts, pixels};
  }
  const xrds::TemporalFilter::Frame& frame() const { return frame_; }

 private:
  xrds::PixelView read(const XrdsImage& image, const char* what, xrds::PixelKind kind) {
    return finite_.emplace_back(images_.emplace_back(image, what).view(), kind).view();
  }

  std::vector<ReadImage> images_;
  std::vector<xrds::FiniteImage> finite_;
  xrds::TemporalFilter::Frame frame_;
};

// Before anything is written. scale: of the image's size to the colour's.
void checkRoom(const XrdsImage& image, const XrdsTemporalFilter& filter, uint32_t scale, const char* what) {
  if (!image.channels[0]) return;
  checkImage(image, what, 3);
  if (image.width != scale * filter.width || image.height != scale * filter.height)
    throw xrds::InvalidArgument(std::string("The merged ") + what + " has another size than that of the frames.");
}

void write(const std::vector<float>& pixels, const XrdsImage& image) {
  if (!image.channels[0] || pixels.empty()) return;
  for (uint32_t c = 0; c < 3; ++c) writeChannel(image, c, &pixels[c], 3);
}

}  // namespace

XrdsTemporalFrame xrdsTemporalFrameDefault() { return {.structSize = sizeof(XrdsTemporalFrame)}; }

XrdsResult xrdsCreateTemporalFilter(XrdsDevice* device, uint32_t width, uint32_t height, uint32_t scale,
                                    XrdsTemporalFilter** filter) {
  return guarded([&] {
    XrdsTemporalFilter*& out = required(filter, "filter");
    const auto on = Devices::open().opened(device, "device");
    out = Handles<XrdsTemporalFilter>::open().add(std::make_shared<XrdsTemporalFilter>(on, width, height, scale));
    return XRDS_OK;
  });
}

void xrdsDestroyTemporalFilter(XrdsTemporalFilter* filter) {
  guarded([&] {
    Handles<XrdsTemporalFilter>::open().remove(filter);
    return XRDS_OK;
  });
}

XrdsResult xrdsMergeFrames(XrdsTemporalFilter* filter, const XrdsTemporalFrame* present,
                           const XrdsTemporalFrame* before, uint32_t beforeCount, const XrdsTemporalFrame* after,
                           uint32_t afterCount, const XrdsTemporalFrame* merged) {
  return guarded([&] {
    const auto found = Handles<XrdsTemporalFilter>::open().opened(filter, "temporal filter");
    const std::unique_lock lock(found->use, std::try_to_lock);
    if (!lock) return failed(XRDS_ERROR_BUSY, "The filter is in use on another thread: create one for each thread.");
    const XrdsTemporalFrame out = taken(required(merged, "merged"), xrdsTemporalFrameDefault());
    checkRoom(out.colour, *found, 1, "colour");
    checkRoom(out.fullColour, *found, found->scale, "full-resolution colour");
    checkRoom(out.albedo, *found, found->scale, "albedo");
    checkRoom(out.normal, *found, found->scale, "normal");
    const ReadFrame now(required(present, "present"), *found);
    std::vector<ReadFrame> kept;
    kept.reserve(size_t{beforeCount} + afterCount);
    const auto framesOf = [&](const XrdsTemporalFrame* given, uint32_t count, const char* name) {
      std::vector<xrds::TemporalFilter::Frame> frames;
      for (uint32_t i = 0; i < count; ++i) frames.push_back(kept.emplace_back(at(given, i, name), *found).frame());
      return frames;
    };
    const auto past = framesOf(before, beforeCount, "before"), future = framesOf(after, afterCount, "after");
    const std::lock_guard device(found->device->access);
    const auto result = found->filter->run(now.frame(), past, future);
    found->deviceBytes = found->filter->deviceBytes();
    write(result.colour, out.colour);
    write(result.fullColour, out.fullColour);
    write(result.albedo, out.albedo);
    write(result.normal, out.normal);
    if (out.lowCounts) std::copy(result.lowCounts.begin(), result.lowCounts.end(), out.lowCounts);
    if (out.fullCounts) std::copy(result.fullCounts.begin(), result.fullCounts.end(), out.fullCounts);
    return XRDS_OK;
  });
}

uint64_t xrdsGetTemporalDeviceBytes(const XrdsTemporalFilter* filter) {
  uint64_t bytes = 0;
  guarded([&] {
    if (const auto found = Handles<XrdsTemporalFilter>::open().find(filter)) bytes = found->deviceBytes;
    return XRDS_OK;
  });
  return bytes;
}
