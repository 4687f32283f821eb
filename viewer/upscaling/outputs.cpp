// What becomes of a result besides being shown: metrics and files.
#include <utility>

#include "image/exr/write.h"
#include "viewer/upscaling/upscaling.h"
#include "xrds/error.h"
#include "xrds/path_text.h"

namespace xrds {
namespace fs = std::filesystem;

// On a thread of its own, because FLIP takes longer than some networks.
void Upscaling::startMetrics() {
  if (!frame_->reference || measured_ || measuring_.valid() || !upscaled_) return;
  std::vector<std::pair<std::string, Image>> images;
  if (pictures_.at(Slot::output).width != static_cast<uint32_t>(frame_->reference->width)) return;
  images.emplace_back(pathOf(network_->name()).stem().string(), network_->download());
  for (const auto& [slot, base] : bases_)
    if (base && pictures_.at(slot).valid) images.emplace_back(base->name(), base->download());
  if (pictures_.at(Slot::denoised).valid) images.emplace_back("denoised", denoised_);
  measured_ = true;
  measuredFrame_ = frameCount_;
  measuring_ = std::async(std::launch::async, [images = std::move(images), reference = *frame_->reference] {
    std::vector<ComparedPicture> compared;
    for (const auto& [name, image] : images) compared.push_back({name, measure(image, reference)});
    return compared;
  });
}

void Upscaling::takeMetrics() {
  if (!measuring_.valid() || measuring_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
  try {
    std::vector<ComparedPicture> compared = measuring_.get();
    if (measuredFrame_ == frameCount_) tell([&](Report& report) { report.compared = std::move(compared); });
  } catch (const Error& failure) {  // pixels that are not finite
    tell([&](Report& report) { report.warnings.emplace_back(failure.what()); });
  }
}

void Upscaling::saveIfAsked() {
  fs::path path;
  {
    const std::lock_guard lock(mutex_);
    if (saveTo_.empty() || asked_ != serving_) return;
    path = std::exchange(saveTo_, {});
    saving_ = true;
  }
  std::string notice, error;
  try {
    notice = savedTo(path);
  } catch (const std::exception& failure) {
    error = failure.what();
  }
  tell([&](Report& report) {
    report.notice = notice;
    if (!error.empty()) report.error = error, report.failure = ExitCode::output;
    saving_ = false;
  });
  wake_.notify_all();
}

// Returns what to tell. Throws Error if the file cannot be written.
std::string Upscaling::savedTo(const fs::path& path) const {
  if (!network_ || !upscaled_) return kNothingToSave;
  ExrOutput output = frame_ ? frame_->output : ExrOutput{};
  const Image image = network_->download();
  if (output.dataWindow.width() != image.width || output.dataWindow.height() != image.height)
    output.dataWindow = output.displayWindow = {0, 0, image.width - 1, image.height - 1};
  output.texts["xrds:model"] = pathOf(network_->name()).stem().string() + " " + network_->model().hash();
  writeExr(path, image, output);
  return "Saved " + path.string();
}

}  // namespace xrds
