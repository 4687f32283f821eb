// The full-resolution render through a denoiser: what else a frame's files may become.
#include "app/network_denoiser.h"
#include "viewer/upscaling/upscaling.h"
#include "xrds/error.h"

namespace xrds {
namespace {

// As `xrds denoise` makes it.
Image denoisedRender(NetworkDenoiser& networks, Device& device, const LoadedFrame& frame) {
  const auto find = [&](const AuxiliaryInput& input) { return imageOf(frame.inputs, frame.auxiliary, input.name); };
  const Image* colour = frame.unmergedColour ? &*frame.unmergedColour : find(kFullColour);
  if (!colour) throw Error("The files hold no full-resolution colour to denoise.");
  const Image* albedo = find(kAlbedo);
  const Image* normal = albedo ? find(kNormal) : nullptr;
  networks.load(normal ? 2 : albedo ? 1 : 0, false, true);
  return networks.prefiltered(device, *colour, albedo, normal);
}

}  // namespace

// Once for a frame, where it is looked at; a failure is a warning.
void Upscaling::showDenoised(const Wanted& wanted) {
  if (!wanted.slots[static_cast<size_t>(Slot::denoised)] || !frame_ || askedDenoiser_ == frameCount_) return;
  tell([](Report& report) { report.waiting = "Denoising the full-resolution render ..."; });
  NetworkDenoiser networks({.memoryBytes = wanted.memoryBytes, .progress = [this](double) { return !outdated(); }});
  std::string failed;
  try {
    denoised_ = denoisedRender(networks, device_, *frame_);
    pictures_.upload(Slot::denoised, denoised_);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    failed = error.what();
  }
  askedDenoiser_ = frameCount_;
  measured_ = false;
  tell([&](Report& report) {
    report.waiting.clear();
    if (!failed.empty()) report.warnings.push_back(failed);
  });
}

}  // namespace xrds
