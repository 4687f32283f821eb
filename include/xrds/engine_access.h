#pragma once

#include "xrds/xrds.hpp"

namespace xrds {

class Gpu;          // engine/device.h
class Buffer;       // engine/buffer.h
struct HostDevice;  // engine/host_device.h
struct FramePart;   // frames/host_frame.h

/// An image in device memory: rows from the top, `channels` 32-bit floats a pixel.
struct DeviceImage {
  uint64_t byteOffset = 0;
  uint32_t width = 0, height = 0, channels = 0;
  uint64_t byteSize() const { return uint64_t{4} * width * height * channels; }
};

/// Where an Upscaler keeps the frame in device memory, all in one buffer.
struct DeviceFrame {
  const Buffer* buffer = nullptr;
  DeviceImage colour;     // [h, w, 4]: linear radiance, the 4th channel 0
  DeviceImage auxiliary;  // [s h, s w, n]: the model's inputs, three channels each, then zeros up to a multiple of 4;
                          // empty if it has none
  DeviceImage output;     // [s h, s w, 4]: linear radiance
};

/// For programs that are built with the engine and share its device, such as the viewer: what the public API keeps to
/// itself. Whoever uses the device's queue locks Gpu::Handles::queueAccess meanwhile.
struct EngineAccess {
  static Gpu& gpu(Device& device);

  /// A device that is another program's. Of the options `select`, validation and extensions do not count.
  static Device shared(const HostDevice& host, const Device::Options& options);

  /// What a frame is made of. Throws InvalidArgument where that depends on its pixels, or it takes several passes.
  static std::vector<FramePart> parts(const Upscaler& upscaler);
  static std::optional<float> exposureOf(const Upscaler& upscaler);

  /// Whether the frame is on the device as a whole: neither in tiles, nor are parts of it skipped. Else it goes through
  /// Upscaler::run(), and the following throw Error.
  static bool isWhole(const Upscaler& upscaler);

  /// Valid as long as the upscaler lives.
  static DeviceFrame frame(const Upscaler& upscaler);

  /// The steps of Upscaler::run, each of which may be left out or replaced by work on the device. A replay takes
  /// colour and auxiliary from where frame() says and may overwrite them; the output stays there until the next one.
  /// With a fixed exposure the upscaler needs one upload() before its first replay. Each throws what run() throws.
  static void upload(Upscaler& upscaler, const PixelView& colour, std::span<const PixelView> auxiliary);
  static bool replay(Upscaler& upscaler, const Upscaler::Progress& progress = {});
  static void download(const Upscaler& upscaler, std::span<float> output);
};

}  // namespace xrds
