#pragma once

#include <string>

#include "viewer/frame_files.h"
#include "viewer/pictures.h"
#include "xrds/engine_access.h"

namespace xrds {

/// What a network must be made ready for: the size of the colour, and the auxiliary images that there are.
struct FrameSize {
  uint32_t width = 0, height = 0;
  int scale = 0;  // 0: any
  std::vector<std::string> inputs;
  bool has(const std::string& input) const;
};

/// A model on a device, ready for frames of one size.
class PreparedNetwork {
 public:
  /// Throws Error if the model does not fit the frame, or the device cannot hold it.
  PreparedNetwork(Device& device, std::string name, Model model, const FrameSize& frame, bool fp16);

  const std::string& name() const { return name_; }
  bool fp16() const { return fp16_; }
  const Model& model() const { return model_; }
  bool fits(const FrameSize& frame) const;
  const Upscaler& upscaler() const { return upscaler_; }

  /// Gives it the frame's images: from the host, or from buffers on the device that hold [height, width, 4] floats of
  /// colour and [scale height, scale width, 8] of albedo and normal.
  void upload(const LoadedFrame& frame);
  void copyInputs(Gpu& gpu, const Buffer& colour, const Buffer& auxiliary);
  /// Makes the inputs pictures to look at; call it before run(), which may overwrite them.
  void showInputs(Pictures& pictures) const;
  /// Returns false if `progress` stopped it.
  bool run(const Upscaler::Progress& progress) { return EngineAccess::replay(upscaler_, progress); }
  void showOutput(Pictures& pictures, Slot slot) const;
  /// A copy of the output for the host.
  Image download() const;

 private:
  std::string name_;
  Model model_;
  bool fp16_;
  uint32_t width_, height_;
  Upscaler upscaler_;
};

}  // namespace xrds
