#include "app/network_denoiser.h"

#include <algorithm>

#include "app/timer.h"
#include "image/image_view.h"
#include "xrds/error.h"
#include "xrds/oidn_import.h"
#include "xrds/path_text.h"

namespace xrds {
namespace fs = std::filesystem;
namespace {

// The network of a colour with so many guides.
std::string kindOf(bool ldr, size_t guides, bool clean) {
  const char* const names[] = {"", "_alb", clean ? "_calb_cnrm" : "_alb_nrm"};
  return std::string(ldr ? "rt_ldr" : "rt_hdr") + names[guides];
}

// All networks of a colour with so many guides, of which prefiltered ones have their own.
std::vector<std::string> kindsOf(bool ldr, size_t guides, bool clean, bool prefiltered) {
  std::vector<std::string> kinds{kindOf(ldr, guides, clean || prefiltered)};
  if (prefiltered && guides > 0) kinds.emplace_back("rt_alb");
  if (prefiltered && guides > 1) kinds.emplace_back("rt_nrm");
  return kinds;
}

}  // namespace

void NetworkDenoiser::load(size_t guides, bool clean, bool prefiltered) {
  for (const std::string& kind : kindsOf(options_.ldr, guides, clean, prefiltered)) networkOf(kind);
}

bool NetworkDenoiser::has(size_t guides, bool clean, bool prefiltered) const {
  const auto kinds = kindsOf(options_.ldr, guides, clean, prefiltered);
  return std::all_of(kinds.begin(), kinds.end(), [&](const std::string& kind) { return !fileOf(kind).empty(); });
}

fs::path NetworkDenoiser::colourFile(size_t guides, bool clean) {
  const std::string kind = kindOf(options_.ldr, guides, clean);
  networkOf(kind);  // throws if it is not there
  return fileOf(kind);
}

Upscaler::Denoisers NetworkDenoiser::inFront(bool hasAlbedo, bool hasNormal, bool clean) {
  Upscaler::Denoisers found{.colour = &colourNetwork(!hasAlbedo ? 0 : !hasNormal ? 1 : 2, true)};
  if (hasAlbedo && !clean) found.albedo = &networkOf("rt_alb");
  if (hasNormal && !clean) found.normal = &networkOf("rt_nrm");
  return found;
}

Image NetworkDenoiser::denoisedAlbedo(Device& device, const Image& albedo) {
  return filtered(device, networkOf("rt_alb"), albedo, {});
}

Image NetworkDenoiser::denoisedNormal(Device& device, const Image& normal) {
  return filtered(device, networkOf("rt_nrm"), normal, {});
}

fs::path NetworkDenoiser::folder() const { return options_.folder.empty() ? denoiserFolder() : options_.folder; }

// Of a kind's sizes the wanted one, where it is there; empty if there is none.
fs::path NetworkDenoiser::fileOf(const std::string& kind) const {
  std::vector<std::string> names{kind};
  if (options_.quality == Quality::high) names.insert(names.begin(), kind + "_large");
  if (options_.quality == Quality::fast) names.insert(names.begin(), kind + "_small");
  std::error_code unreadable;  // a home of somebody else, say
  for (const std::string& name : names)
    if (fs::path file = folder() / pathOf(name + ".safetensors"); fs::exists(file, unreadable)) return file;
  return {};
}

const Model& NetworkDenoiser::networkOf(const std::string& kind) {
  if (const auto known = models_.find(kind); known != models_.end()) return known->second;
  if (const fs::path file = fileOf(kind); !file.empty()) return models_.emplace(kind, Model(file)).first->second;
  throw Error("There is no network " + kind + " of Open Image Denoise in '" + folder().string() +
              "': read them once out of your own copy with 'xrds import oidn PATH', where PATH is the file "
              "libOpenImageDenoise_core.so of your system's package or of pip install pyoidn.");
}

// Its name is kept.
const Model& NetworkDenoiser::colourNetwork(size_t guides, bool clean) {
  const std::string kind = kindOf(options_.ldr, guides, clean);
  const Model& model = networkOf(kind);
  const auto source = model.metadata().find("source");
  name_ = source == model.metadata().end() ? kind : source->second;
  return model;
}

Image NetworkDenoiser::filtered(Device& device, const Model& model, const Image& colour,
                                const std::vector<const Image*>& guides, std::span<const LayerSet> layers) {
  std::vector<PixelView> views;
  views.reserve(guides.size());
  for (const Image* guide : guides) views.push_back(viewOf(*guide));
  const auto width = static_cast<uint32_t>(colour.width), height = static_cast<uint32_t>(colour.height);
  Upscaler::Options options{.fp16 = options_.fp16, .exposure = options_.exposure};
  options.tiles = {.memoryBytes = options_.memoryBytes, .exact = true};
  options.tune = Upscaler::Tune::never;
  std::unique_ptr<Upscaler> network = prepared_.take(model, width, height);
  if (!network) network = std::make_unique<Upscaler>(device, model, width, height, options);
  Image result(colour.width, colour.height, 3);
  const Timer timer;
  if (!network->run(viewOf(colour), views, result.pixels, layers, options_.progress))
    throw Cancelled("The denoiser was stopped.");
  runSeconds_ += timer.seconds();
  deviceBytes_ = std::max(deviceBytes_, network->deviceBytes());
  tiling_ = network->tiling();
  layerReports_ = network->layerReports();
  if (options_.staysPrepared) prepared_.put(device, model, width, height, std::move(network));
  return result;
}

Image NetworkDenoiser::denoised(Device& device, const Image& colour, const Image* albedo, const Image* normal,
                                bool clean, std::span<const LayerSet> layers) {
  std::vector<const Image*> guides;
  if (albedo) guides.push_back(albedo);
  if (albedo && normal) guides.push_back(normal);
  return filtered(device, colourNetwork(guides.size(), clean), colour, guides, layers);
}

Image NetworkDenoiser::prefiltered(Device& device, const Image& colour, const Image* albedo, const Image* normal) {
  if (!albedo) return denoised(device, colour, nullptr, nullptr, false);
  const Image cleanAlbedo = denoisedAlbedo(device, *albedo);
  if (!normal) return denoised(device, colour, &cleanAlbedo, nullptr, true);
  const Image cleanNormal = denoisedNormal(device, *normal);
  return denoised(device, colour, &cleanAlbedo, &cleanNormal, true);
}

}  // namespace xrds
