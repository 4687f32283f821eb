// The full-resolution render through a denoiser: what else a frame's files may become.
#include <algorithm>

#include "app/network_denoiser.h"
#include "viewer/upscaling.h"
#include "xrds/error.h"

namespace xrds {
namespace {

const Image* auxiliaryOf(const LoadedFrame& frame, std::string_view name) {
  const auto found = std::find(frame.inputs.begin(), frame.inputs.end(), name);
  return found == frame.inputs.end() ? nullptr : &frame.auxiliary[static_cast<size_t>(found - frame.inputs.begin())];
}

// With albedo and normal that were denoised before, as Open Image Denoise's manual advises for the best result.
Image denoisedRender(NetworkDenoiser& networks, Device& device, const LoadedFrame& frame) {
  if (frame.fullColour.pixels.empty()) throw Error("The files hold no full-resolution colour to denoise.");
  const Image* albedo = auxiliaryOf(frame, kAlbedo.name);
  const Image* normal = albedo ? auxiliaryOf(frame, kNormal.name) : nullptr;
  networks.load(albedo ? normal ? 2 : 1 : 0, false, true);
  DeviceDenoiser denoiser(networks, device);
  Image cleanAlbedo, cleanNormal;
  if (albedo) cleanAlbedo = denoiser.denoisedAlbedo(*albedo);
  if (normal) cleanNormal = denoiser.denoisedNormal(*normal);
  return denoiser.denoised(frame.fullColour, albedo ? &cleanAlbedo : nullptr, normal ? &cleanNormal : nullptr);
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
