#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/copied_layers.h"
#include "app/image_denoiser.h"
#include "image/exr/planes.h"
#include "image/exr/read.h"
#include "image/layers/aov_candidates.h"
#include "image/repair.h"
#include "xrds/layers.h"

namespace xrds {

/// What `--layers` asks for: every light layer that has a name of Cycles, or those of these names; none: no layers.
struct LayerRequest {
  bool all = false;
  std::vector<std::string> names{};
  bool any() const { return all || !names.empty(); }
};

/// "all" or names with commas; empty: none.
LayerRequest layerRequest(const std::string& text);

/// What became of the layers of a frame, by their names.
struct LayerList {
  std::vector<std::string> upscaled, copied, leftOut;  // left out: with their reason, "AO, Emit (...)"
  bool merged = false;                                 // with those of the full-resolution render
};

/// Layers upscaled, in the order of FrameLayers, and what the library says of each set.
struct UpscaledLayers {
  std::vector<Image> lights, colours;
  std::vector<LayerReport> reports;
};

/// The layers of a frame beside its colour: lights of the colour's render, which are upscaled with it, and everything
/// else of the full-resolution render, which is copied bit for bit.
class FrameLayers {
 public:
  /// Where they are. `fullPart`: of the auxiliary images; nothing: there are none, and nothing is copied.
  struct Files {
    const ExrFile &colour, &full;
    const ExrSelection& colourLayer;
    const ExrSelection* alphaLayer;  // null: the result has none
    std::optional<size_t> fullPart;
    Box window;  // of the upscaled frame
  };

  /// Finds and reads them. `share` of the full-resolution colour in the merged one, where it is merged: then lights
  /// that are there in both renders are merged alike, if all are. Throws Error if a named layer is not there, no light
  /// is found, or a file cannot be read.
  FrameLayers(const Files& files, const LayerRequest& request, std::optional<double> share);

  /// Takes the noise out of each light that is not black, with the help of low-resolution albedo and normal, which may
  /// be null.
  void denoise(ImageDenoiser& denoiser, const Image* albedo, const Image* normal, uint32_t passes = 1);

  /// Takes the noise out of the colour passes, as of albedos; of full resolution they are the same images then. Before
  /// denoise(). For layers of one size.
  void denoiseColours(ImageDenoiser& denoiser);
  /// How many images these two give to a denoiser.
  size_t noisyImages() const;
  size_t noisyColours() const { return colours_.size(); }

  const LayerList& list() const { return list_; }
  /// Layers with pixels that were filled from their neighbours, or set to 0 where they were negative, and how many.
  struct Repaired {
    ExrSelection layer;
    RepairCounts counts;
  };
  const std::vector<Repaired>& repaired() const { return repaired_; }
  /// Attributes of what is copied.
  const std::vector<ExrAttributes>& attributes() const { return attributes_; }
  /// Room for the results at `scale` times the size.
  UpscaledLayers room(int scale) const;
  /// The sets that add up to the colour, as Upscaler::run() takes them, with their results in `to`.
  std::vector<LayerSet> sets(UpscaledLayers& to) const;
  /// Of what Upscaler::layerReports() says of them, with the shares that the layers given had of their colour.
  std::vector<LayerReport> reports(std::vector<LayerReport> found) const;
  /// All channels of the output: the colour, with alpha if it has four channels, the lights, and what is copied. Lights
  /// and colour have `type`.
  std::vector<ExrPlane> planes(const Image& colour, const UpscaledLayers& upscaled, ExrPixelType type) const;
  /// What is to be said of the results.
  std::vector<std::string> warnings(const UpscaledLayers& upscaled) const;

 private:
  struct Light {
    std::string name;
    std::vector<std::string> channels;  // of the output
    ExrSelection low;
    std::optional<ExrSelection> full{};
    int colour = -1;
    bool followsAlbedo = true, isGroup = false;
    Image image{};
  };
  struct Colour {
    std::string name;
    std::vector<std::string> channels;  // of the output
    ExrSelection low;
    std::optional<ExrSelection> full{};
    Image image{}, fullImage{};
  };
  void find(const Files& files, const LayerRequest& request);
  void addLight(const Files& files, const AovCandidate& found, const std::vector<AovCandidate>& low,
                const std::vector<AovCandidate>& full);
  Image readRadiance(const ExrFile& file, const ExrSelection& layer);
  Image readFull(const ExrFile& file, const ExrSelection& layer, const Box& window);
  void copyOthers(const Files& files);
  void take(CopiedLayers copied);
  void read(const Files& files);
  void merge(const Files& files, double share);
  void makeRest(const Files& files);
  void makeWhole();
  bool hasLights(bool groups) const;
  Image radianceOf(const Light& light) const;
  std::vector<std::vector<float>> radiances(bool groups) const;

  std::vector<Light> lights_;
  std::vector<Colour> colours_;
  Image rest_[2], whole_[2];          // of the passes and of the light groups
  std::vector<double> shares_;        // of the colour that was given, of each of sets()
  std::vector<std::string> unasked_;  // lights of the colour's render
  std::vector<std::string> colourChannels_;
  std::string alphaChannel_;  // empty: there is none
  std::vector<ExrPlane> copied_;
  std::vector<ExrAttributes> attributes_;
  std::vector<Repaired> repaired_;
  LayerList list_;
};

}  // namespace xrds
