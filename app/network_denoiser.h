#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "app/image_denoiser.h"
#include "app/prepared_networks.h"
#include "image/image.h"
#include "xrds/xrds.hpp"

namespace xrds {

/// Open Image Denoise's networks, imported as model files (xrds/oidn_import.h), on a Vulkan device. Not for several
/// threads at once.
class NetworkDenoiser {
 public:
  /// As Open Image Denoise names them: high takes the largest network that there is, fast the smallest.
  enum class Quality : uint8_t { high, balanced, fast };
  struct Options {
    std::filesystem::path folder{};  // of the model files; empty: denoiserFolder()
    Quality quality = Quality::high;
    bool ldr = false;                 // the colour is from 0 to 1
    std::optional<float> exposure{};  // empty: from the colour
    bool fp16 = false;
    uint64_t memoryBytes = 0;                // as TileOptions
    std::function<bool(double)> progress{};  // of each network, as Upscaler::Progress; false ends with Cancelled
    bool staysPrepared = false;              // for the next image of the same size; memoryBytes must be 0
  };

  explicit NetworkDenoiser(Options options) : options_(std::move(options)) {}

  /// Reads the networks that the functions below need, of a colour with so many guides (none, albedo, albedo and
  /// normal), which may have no noise or may be denoised before. Throws Error, which says what to do where they were
  /// not imported.
  void load(size_t guides, bool clean, bool prefiltered);

  /// Whether load() would find its networks.
  bool has(size_t guides, bool clean, bool prefiltered) const;

  /// The file of the network of such a colour. Throws Error, as load() does.
  std::filesystem::path colourFile(size_t guides, bool clean);

  /// Networks to stand in front of an upscaler of frames with these images: of HDR colour, with clean guides, and of
  /// albedo and normal unless these are clean. They live as long as this. Throws Error, as load() does.
  Upscaler::Denoisers inFront(bool hasAlbedo, bool hasNormal, bool clean);

  /// The colour [h, w, 3] without its noise, with the help of albedo and normal [h, w, 3]. Either may be null, the
  /// normal must be where there is no albedo. `clean`: they have no noise. Tiles, where the memory asks for them, have
  /// halos with which the picture is that of the whole frame bit for bit. `layers`, without their noise, get their
  /// share of it (Upscaler::run()). Throws Error, as load() does.
  Image denoised(Device& device, const Image& colour, const Image* albedo, const Image* normal, bool clean,
                 std::span<const LayerSet> layers = {});
  /// The same with albedo and normal that were denoised before.
  Image prefiltered(Device& device, const Image& colour, const Image* albedo, const Image* normal);
  /// Albedo and normal without their noise, each by a network of its own.
  Image denoisedAlbedo(Device& device, const Image& albedo);
  Image denoisedNormal(Device& device, const Image& normal);

  /// Gives back what stays prepared: before the device goes.
  void release() { prepared_.clear(); }

  /// "Open Image Denoise 2.5.1, rt_hdr_alb_nrm": the network of denoised() that ran last, or of inFront()'s colour.
  const std::string& name() const { return name_; }
  /// The most device memory that a network took, arena and weights, in bytes.
  uint64_t deviceBytes() const { return deviceBytes_; }
  /// Of all runs of networks, with upload and download; not of their preparation.
  double runSeconds() const { return runSeconds_; }
  const Tiling& tiling() const { return tiling_; }                                // of the network that ran last
  const std::vector<LayerReport>& layerReports() const { return layerReports_; }  // of the layers of denoised()

 private:
  std::filesystem::path folder() const;
  std::filesystem::path fileOf(const std::string& kind) const;
  const Model& networkOf(const std::string& kind);
  const Model& colourNetwork(size_t guides, bool clean);
  Image filtered(Device& device, const Model& model, const Image& colour, const std::vector<const Image*>& guides,
                 std::span<const LayerSet> layers = {});

  Options options_;
  std::map<std::string, Model> models_;
  PreparedNetworks prepared_;
  std::string name_;
  uint64_t deviceBytes_ = 0;
  double runSeconds_ = 0;
  Tiling tiling_{};
  std::vector<LayerReport> layerReports_;
};

/// These networks on a device, as in front of an upscaler. Images go there and come back, each by itself.
class DeviceDenoiser : public ImageDenoiser {
 public:
  /// Both must outlive it. `clean`: the guides of colours have no noise.
  DeviceDenoiser(NetworkDenoiser& networks, Device& device, bool clean = true)
      : networks_(networks), device_(device), clean_(clean) {}
  std::string name() const override { return networks_.name(); }

 private:
  Image colourWithoutNoise(const Image& colour, const Image* albedo, const Image* normal) override {
    return networks_.denoised(device_, colour, albedo, normal, clean_);
  }
  Image albedoWithoutNoise(const Image& albedo) override { return networks_.denoisedAlbedo(device_, albedo); }
  Image normalWithoutNoise(const Image& normal) override { return networks_.denoisedNormal(device_, normal); }

  NetworkDenoiser& networks_;
  Device& device_;
  const bool clean_;
};

}  // namespace xrds
