// What becomes of a result besides being shown: metrics and files.
#include <utility>

#include "image/exr_write.h"
#include "viewer/upscaling.h"
#include "xrds/error.h"

namespace xrds {
namespace fs = std::filesystem;

// On a thread of its own, because FLIP takes longer than some networks.
void Upscaling::startMetrics() {
  if (!frame_->reference || measured_ || measuring_.valid() || !upscaled_) return;
  std::vector<std::pair<std::string, Image>> images;
  if (pictures_.at(Slot::output).width != static_cast<uint32_t>(frame_->reference->width)) return;
  images.emplace_back(fs::path(network_->name()).stem().string(), network_->download());
  for (const auto& [slot, base] : bases_)
    if (base && pictures_.at(slot).valid) images.emplace_back(base->name(), base->download());
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
  }
  std::string notice = "There is no picture to save yet.";
  if (network_ && upscaled_) {
    ExrOutput output = frame_ ? frame_->output : ExrOutput{};
    const Image image = network_->download();
    if (output.dataWindow.width() != image.width || output.dataWindow.height() != image.height)
      output.dataWindow = output.displayWindow = {0, 0, image.width - 1, image.height - 1};
    output.texts["xrds:model"] = fs::path(network_->name()).stem().string() + " " + network_->model().hash();
    writeExr(path, image, output);
    notice = "Saved " + path.string();
  }
  tell([&](Report& report) { report.notice = notice; });
}

}  // namespace xrds
