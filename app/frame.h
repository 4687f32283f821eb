#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/frame_layers.h"
#include "app/image_denoiser.h"
#include "app/merge_request.h"
#include "image/exr/write.h"
#include "image/frame_fit.h"
#include "image/image.h"
#include "image/image_view.h"
#include "image/layers/aov.h"
#include "xrds/xrds.hpp"

namespace xrds {

/// The layers of a frame to upscale, found in one or two EXR files, with what the output must keep.
class Frame {
 public:
  /// Reads headers only. An empty auxPath means the colour's file. `auxiliaryInputs` are those of the model, of
  /// kAuxiliaryInputs; with none the auxiliary file is looked at for a colour to merge alone, if at all. Throws Error
  /// if the layers are not found or the sizes are no whole multiple of each other.
  Frame(const std::filesystem::path& colorPath, const std::filesystem::path& auxPath, const AovRequest& request,
        const std::vector<std::string>& auxiliaryInputs, const MergeRequest& merge = {});

  /// The size of the auxiliary images, or of a colour to merge without these, over the colour's; 0 without them.
  int scale() const { return fit_ ? fit_->scale : 0; }
  uint32_t width() const { return static_cast<uint32_t>(colourPart().dataWindow.width()); }
  uint32_t height() const { return static_cast<uint32_t>(colourPart().dataWindow.height()); }

  /// The part of the file that the colour is of.
  const ExrPart& colourPart() const { return colorFile_.parts[aovs_.color.part]; }
  const AovPlace& colourPlace() const { return aovs_.place; }
  FrameLayer colourLayer() const { return {colourPart(), aovs_.color.layer}; }
  FrameLayer fullColourLayer() const;  // kFullColour must be one of inputs()

  /// Samples a pixel of the colour, as the request gives them or its file tells; nothing where they are unknown.
  std::optional<double> lowSamples() const;

  /// What the auxiliary images are, in the order of the model's inputs.
  const std::vector<std::string>& inputs() const { return inputs_; }

  /// Windows and attributes of the upscaled frame. Throws Error if the windows do not fit in 32 bits.
  ExrOutput output(int scale) const;

  /// Reads and repairs the pixels, and merges the colour with that of the full-resolution render (mergedColour()) where
  /// the auxiliary file has it and both are of the same light; what was repaired or looks wrong is added to warnings().
  /// Throws Error.
  void load();

  /// After load(): finds and reads the layers of light that are to be upscaled as well, by `scale`, and those to copy:
  /// of the auxiliary images' file, or without these, if the size stays, of the colour's. Throws Error, also where the
  /// colour is not of the default view.
  void loadLayers(const LayerRequest& request, uint32_t scale);

  /// After load(): takes the noise out of albedo and normal, unless they have none; out of the colour, merged or not,
  /// with their means; and out of the full-resolution light that the model takes, its colour brought to the level of
  /// the merged one before (levelledColour()). `passes`: of each colour, as ImageDenoiser::denoised(). Throws
  /// Error.
  void denoise(ImageDenoiser& denoiser, bool cleanGuides, uint32_t passes = 1);

  /// What denoise() with several passes began with, where it was given a full-resolution colour: see upscaleFrame().
  struct Noisy {
    Image colour;
    std::vector<Image> auxiliary;
  };
  const std::optional<Noisy>& noisy() const { return noisy_; }

  /// After load(), in the place of denoise(): makes it what Upscaler::Denoisers take, for denoisers of that name.
  void levelFor(const std::string& denoisers);

  /// An auxiliary image by the name of the input; null if it is none of inputs().
  const Image* imageOf(std::string_view input) const;

  /// Puts what a TemporalFilter made of the colour and of auxiliary images in their place.
  void replace(TemporalFilter::Merged merged);

  /// The file that the auxiliary images are of, and a layer of it in the frame's window at their size; without them the
  /// colour's. Throws Error.
  const ExrFile& auxiliaryFile() const { return auxFile_; }
  Image readFull(const ExrSelection& layer) const;

  const Image& colour() const { return colour_; }
  /// What load() merged into the colour; nothing if there was nothing to merge.
  const std::optional<MergedColour>& merged() const { return merged_; }
  bool neverMerges() const { return merge_.never; }
  /// "Open Image Denoise 2.5.1", if denoise() or levelFor() was called; else empty.
  const std::string& denoisedBy() const { return denoisedBy_; }
  const std::optional<Image>& alpha() const { return alpha_; }
  /// What loadLayers() found; nothing if it was not called.
  const std::optional<FrameLayers>& layers() const { return layers_; }
  /// One for each of inputs(), of three channels; of depth the relative depth.
  const std::vector<Image>& auxiliary() const { return auxiliary_; }
  const std::vector<std::string>& warnings() const { return warnings_; }
  void warn(const std::string& text) { warnings_.push_back(text); }
  /// How many pixels load() filled from their neighbours or set to 0, in all layers.
  size_t repairedPixels() const { return repairedPixels_; }

 private:
  Image* imageOf(std::string_view input);
  void fit(const std::string& input);
  void fitFullColour();
  const ExrSelection& layerOf(std::string_view input) const;
  Image loadRadiance(const ExrSelection& layer) const;
  Image loadLight(AovRole role, const ExrSelection& layer) const;
  Image loadAuxiliary(const std::string& input);
  bool isFullColourNamed() const;
  bool mayHaveFullColour() const;
  std::optional<ExrSelection> fullColour();
  ExrSelection findFullColour() const;
  void mergeColour();
  void level();
  void chooseShare(const ExrSelection& layer, const Image& full);
  void addWarnings(const std::vector<std::string>& more);
  void addRepaired(size_t count, const ExrSelection& layer, const char* what);

  ExrFile colorFile_, auxFile_;
  std::vector<std::string> inputs_;
  MergeRequest merge_;
  std::string fullColourName_;
  Aovs aovs_;
  std::optional<FrameFit> fit_;
  Image colour_;
  std::optional<MergedColour> merged_;
  std::optional<FrameLayers> layers_;
  std::string denoisedBy_;
  std::optional<Noisy> noisy_;
  std::optional<Image> alpha_;
  std::vector<Image> auxiliary_;
  std::vector<std::string> warnings_;
  size_t repairedPixels_ = 0;
};

/// Whether the files of a frame hold a full-resolution colour to merge, of the albedo's size. What is wrong with one
/// that `layers` names is told where it is read.
bool hasFullColour(const std::filesystem::path& colourPath, const std::filesystem::path& auxPath,
                   const AovRequest& layers);

/// The image of that input, one of `images` for each of `inputs`; null if it is none of them.
const Image* imageOf(const std::vector<std::string>& inputs, const std::vector<Image>& images, std::string_view input);

/// The auxiliary images that the model takes, in its order, of those there are, one for each of `inputs`. Throws Error
/// if one is not among them.
std::vector<PixelView> inputsOf(const Model& model, const std::vector<std::string>& inputs,
                                const std::vector<Image>& images);
/// The same of a frame. Throws Error also if the model takes the full-resolution colour and that was not merged.
std::vector<PixelView> inputsOf(const Model& model, const Frame& frame);

}  // namespace xrds
