#include "frames/denoised_runner.h"

#include <algorithm>

#include "xrds/auxiliary_input.h"

namespace xrds {
namespace {

std::vector<FramePart> partsOf(const std::unique_ptr<FrameRunner>& runner) {
  return runner ? runner->parts() : std::vector<FramePart>();
}

}  // namespace

DenoisedRunner::DenoisedRunner(Gpu& gpu, DenoisedRunners runners, FrameShape shape, uint32_t scale,
                               const std::vector<std::string>& inputs, std::optional<float> exposure,
                               const SessionOptions& options)
    : runners_(std::move(runners)),
      parts_{partsOf(runners_.albedo), partsOf(runners_.normal), partsOf(runners_.full), partsOf(runners_.low),
             runners_.guides},
      images_(gpu) {
  const TensorShape full{scale * shape.height, scale * shape.width, 4};
  colour_ = images_.create("colour", {shape.height, shape.width, 4});
  for (size_t i = 0; i < inputs.size(); ++i) auxiliary_.push_back(images_.create("auxiliary", full));
  output_ = images_.create("output", full);
  HostPictures pictures{.colour = pictureOf(images_, colour_), .output = pictureOf(images_, output_)};
  for (const TensorView& image : auxiliary_) pictures.auxiliary.push_back(pictureOf(images_, image));
  pictures.exposure = exposure;
  pictures.marksLost = true;
  const std::vector<FramePart> upscaling = parts();
  frame_.emplace(gpu, parts_, upscaling, inputs, pictures);
  recording_.emplace(gpu, frame_->dispatches(),
                     RecordingOptions{options.timestamps, options.multiplyAddsPerSubmission, true});
}

void DenoisedRunner::upload(const TensorView& to, const PixelView& image) {
  images_.upload(to, [&](uint32_t y, std::span<float> row) { copyRow(image, 0, y, to.width, row.data(), 4); });
}

bool DenoisedRunner::run(const FrameInput& frame, std::span<float> output,
                         const std::function<bool(double)>& progress) {
  XRDS_CHECK_EQ(frame.auxiliary.size(), auxiliary_.size());
  XRDS_CHECK(frame.layers.empty());
  upload(colour_, frame.colour);
  for (size_t i = 0; i < auxiliary_.size(); ++i) upload(auxiliary_[i], frame.auxiliary[i]);
  if (!recording_->run(countingShare(progress))) return false;
  lostPixels_.clear();
  images_.download(output_, [&](uint32_t y, std::span<const float> row) {
    storeRow(row, uint64_t{y} * output_.width, output, lostPixels_);
  });
  std::sort(lostPixels_.begin(), lostPixels_.end());
  return true;
}

std::vector<DispatchTime> DenoisedRunner::times() const {
  return timesOf(frame_->dispatches(), recording_->gpuMicroseconds());
}

uint64_t DenoisedRunner::byteSize() const {
  uint64_t sum = images_.byteSize() + frame_->byteSize();
  for (const auto* runner : {&runners_.albedo, &runners_.normal, &runners_.full, &runners_.low, &runners_.upscaler})
    if (*runner) sum += (*runner)->byteSize();
  return sum;
}

// Beside inputs and output, of the albedo what is given, denoised and both; of the normal one more; of radiance what
// its exposure is computed from, too.
uint64_t DenoisedRunner::imageBytes(FrameShape shape, uint32_t scale, const std::vector<std::string>& inputs) {
  uint64_t images = inputs.size() + 1;
  for (const std::string& name : inputs)
    images += name == kAlbedo.name ? 3 : findAuxiliaryInput(name)->isRadiance ? 2 : 1;
  const uint64_t lowImages = 6, lowBytes = uint64_t{shape.height} * shape.width * 4 * sizeof(float);
  return (images * scale * scale + lowImages) * lowBytes + (images + lowImages) * kBindingAlignment;
}

}  // namespace xrds
