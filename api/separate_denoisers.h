#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "api/frame_upscaler.h"

namespace xrds {

/// Images of a frame and its layers.
struct FrameImages {
  PixelView colour;
  std::vector<PixelView> auxiliary;  // in the order of the upscaler's model
  std::vector<LayerSet> layers{};
  std::vector<double> shares{};  // of what they are part of, that the layers of each set were before they were denoised
};

/// Of a run that is a part of all, from `begin` on.
Upscaler::Progress partOf(const Upscaler::Progress& progress, double begin, double share);

/// The networks of Upscaler::Options::denoisers, where they do not stand in front of the upscaler on the device: each
/// image goes through them by itself, and comes back to the host. What is asked of them for one frame stays ready for
/// the next, until that takes more than a quarter of the device's memory; where memory is limited, only one network at
/// a time is there.
class SeparateDenoisers {
 public:
  /// upscaler: its model; everything must outlive it. Of the options precision, memory and passes are those of the
  /// networks, too.
  SeparateDenoisers(Gpu& gpu, const NetworkConfig& upscaler, const DenoisingModels& models,
                    const Upscaler::Options& options);
  ~SeparateDenoisers();

  /// How many times denoised() runs a network for a frame.
  uint32_t runs(const FrameImages& frame) const;

  /// The frame without its noise; layers with their results' places, each with the sum of its set. It is there until
  /// the next call. `hear` gets the share of `runs` done; where it returns false, nothing is returned. `makeRoom` is
  /// called where the device has no room even for one network alone. Throws Error; then no network is kept.
  std::optional<FrameImages> denoised(const FrameImages& frame, const std::function<bool(double)>& hear,
                                      const std::function<void()>& makeRoom);

  uint64_t byteSize() const;  // of the device's memory
  void release();             // gives that back
  /// Of the last frame, with Upscaler::Options::profile.
  const std::vector<Upscaler::ProfileRow>& profile() const { return profile_; }

 private:
  struct Network;
  struct Stopped {};
  using Pixels = std::vector<float>;
  FrameUpscaler& network(const NetworkModel& model, FrameShape shape);
  Pixels ran(const NetworkModel& model, const PixelView& image, std::span<const PixelView> guides);
  Pixels through(const NetworkModel& model, const PixelView& image, std::span<const PixelView> guides);
  void denoise(FrameImages& frame);
  Pixels radiance(const PixelView& image, std::span<const PixelView> guides);
  PixelView kept(Pixels pixels, const PixelView& like);
  std::vector<PixelView> guidesOf(const std::vector<PixelView>& auxiliary) const;
  void denoiseGuides(std::vector<PixelView>& auxiliary);
  void denoiseLayers(FrameImages& frame, size_t place, const PixelView& colour, std::span<const PixelView> guides);

  Gpu& gpu_;
  const NetworkConfig& upscaler_;
  const DenoisingModels models_;
  const Upscaler::Options& options_;
  std::vector<std::unique_ptr<Network>> networks_;
  std::deque<Pixels> pixels_;  // of the frame, which stay where they are
  std::function<bool(double)> hear_;
  std::function<void()> makeRoom_;
  double heard_ = 0;
  uint32_t done_ = 0, runs_ = 1;
  std::vector<Upscaler::ProfileRow> profile_, rows_;  // the latter of the frame that is under way
};

}  // namespace xrds
