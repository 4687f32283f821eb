// xrds._native: the C API for the package around it, which has the defaults, the names and the documentation.
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <optional>
#include <tuple>
#include <vector>

#include "python/native/device.h"
#include "python/native/image.h"
#include "python/native/temporal_filter.h"
#include "xrds/xrds_report.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace xrds::python {
namespace {

class Model {
 public:
  explicit Model(const std::string& nameOrFile) {
    Call call;
    call.run([&] { return xrdsOpenModel(nameOrFile.c_str(), &handle_); });
  }
  ~Model() { Call::close(closeHandle<XrdsModel, xrdsCloseModel>, handle_); }
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;
  uint32_t scale() const { return xrdsGetModelScale(handle_); }
  std::vector<std::string> inputs() const {
    std::vector<std::string> names(xrdsCountModelInputs(handle_));
    for (uint32_t i = 0; i < names.size(); ++i) names[i] = xrdsGetModelInput(handle_, i);
    return names;
  }
  Text metadata(const std::string& key) const {
    const char* const text = xrdsGetModelMetadata(handle_, key.c_str());
    return text ? Text(text) : std::nullopt;
  }
  const XrdsModel* handle() const { return handle_; }

 private:
  XrdsModel* handle_ = nullptr;
};

using Layer = std::tuple<const Image*, const Image*, int, bool>;           // light, output, place of its colour, albedo
using LayerColour = std::tuple<const Image*, const Image*, const Image*>;  // low, full, output
using LayerSet = std::tuple<std::vector<Layer>, std::vector<LayerColour>, const Image*>;  // and what they are part of

struct UpscalerOptions {
  bool fp16 = false, keepUnchanged = false, exactTiles = false, wrap = false, denoisedColour = false,
       separateDenoisers = false;
  float exposure = 0, skip = 0;
  uint32_t ensemble = 1;
  uint64_t memory = 0;
  int tune = XRDS_TUNE_AUTO;
};

XrdsUpscalerOptions optionsOf(const UpscalerOptions& given) {
  XrdsUpscalerOptions options = xrdsUpscalerOptionsDefault();
  options.fp16 = given.fp16;
  options.exposure = given.exposure;
  options.ensemble = given.ensemble;
  options.memoryBytes = given.memory;
  options.exactTiles = given.exactTiles;
  options.wrap = given.wrap;
  options.skipBound = given.skip;
  options.keepUnchanged = given.keepUnchanged;
  options.tune = static_cast<XrdsTune>(given.tune);
  options.denoisedColour = given.denoisedColour;
  options.separateDenoisers = given.separateDenoisers;
  options.levelColour = 1;  // of denoisers, which take it so
  return options;
}

class Upscaler {
 public:
  /// denoisers: of the colour, the albedo and the normal, each of which may be null; or none.
  Upscaler(Device& device, const Model& model, uint32_t width, uint32_t height, const UpscalerOptions& given,
           const std::vector<const Model*>& denoisers, nb::handle progress) {
    Call call(progress);
    XrdsUpscalerOptions options = optionsOf(given);
    const XrdsModel** const places[] = {&options.denoiser, &options.albedoDenoiser, &options.normalDenoiser};
    for (size_t i = 0; i < std::min(denoisers.size(), std::size(places)); ++i)
      if (denoisers[i]) *places[i] = denoisers[i]->handle();
    XrdsDevice* const onDevice = device.handle();
    call.run([&] { return xrdsCreateUpscaler(onDevice, model.handle(), width, height, &options, &handle_); });
  }
  ~Upscaler() { close(); }
  Upscaler(const Upscaler&) = delete;
  Upscaler& operator=(const Upscaler&) = delete;
  void close() {
    if (handle_) Call::close(closeHandle<XrdsUpscaler, xrdsDestroyUpscaler>, std::exchange(handle_, nullptr));
  }
  void run(const Image& colour, const std::vector<const Image*>& auxiliary, const Image& output, nb::handle progress) {
    std::vector<XrdsImage> images;
    for (const Image* image : auxiliary) images.push_back(image->view());
    XrdsUpscaler* const upscaler = opened(handle_, "upscaler");
    Call call(progress);
    call.run([&] {
      return xrdsUpscale(upscaler, &colour.view(), images.data(), static_cast<uint32_t>(images.size()), &output.view(),
                         Call::hearFrame, &call);
    });
  }
  std::vector<std::tuple<double, uint64_t, uint64_t>> runLayers(const Image& colour,
                                                                const std::vector<const Image*>& auxiliary,
                                                                const Image& output, const std::vector<LayerSet>& given,
                                                                nb::handle progress) {
    std::vector<XrdsImage> images;
    for (const Image* image : auxiliary) images.push_back(image->view());
    std::vector<std::vector<XrdsLayer>> lights(given.size());
    std::vector<std::vector<XrdsLayerColour>> passes(given.size());
    std::vector<XrdsLayerSet> sets(given.size(), xrdsLayerSetDefault());
    for (size_t i = 0; i < given.size(); ++i) {
      const auto& [layers, colours, whole] = given[i];
      for (const auto& [light, result, place, followsAlbedo] : layers)
        lights[i].push_back({sizeof(XrdsLayer), place, light->view(), result->view(), followsAlbedo});
      for (const auto& [low, full, result] : colours)
        passes[i].push_back({sizeof(XrdsLayerColour), low->view(), full->view(), result->view()});
      sets[i].layerCount = static_cast<uint32_t>(lights[i].size());
      sets[i].colourCount = static_cast<uint32_t>(passes[i].size());
      sets[i].layers = lights[i].data();
      sets[i].colours = passes[i].data();
      sets[i].whole = &whole->view();
    }
    std::vector<XrdsLayerReport> reports(given.size(), {.structSize = sizeof(XrdsLayerReport)});
    XrdsUpscaler* const upscaler = opened(handle_, "upscaler");
    Call call(progress);
    call.run([&] {
      return xrdsUpscaleLayers(upscaler, &colour.view(), images.data(), static_cast<uint32_t>(images.size()),
                               &output.view(), sets.data(), static_cast<uint32_t>(sets.size()), reports.data(),
                               Call::hearFrame, &call);
    });
    std::vector<std::tuple<double, uint64_t, uint64_t>> found;
    for (const XrdsLayerReport& report : reports)
      found.emplace_back(report.share, report.raisedColours, report.unshared);
    return found;
  }
  float exposure() const { return xrdsGetExposure(handle_); }
  uint64_t deviceBytes() const { return xrdsGetDeviceBytes(handle_); }
  std::tuple<uint64_t, uint64_t, uint64_t> repairs() const {
    XrdsRepairs found{.structSize = sizeof found};
    XrdsUpscaler* const upscaler = opened(handle_, "upscaler");
    Call call;
    call.run([&] { return xrdsGetRepairs(upscaler, &found); });
    return {found.colour, found.auxiliary, found.output};
  }

 private:
  XrdsUpscaler* handle_ = nullptr;
};

std::vector<nb::dict> devices() {
  std::vector<XrdsDeviceDescription> found;
  Call call;
  call.run([&] {
    uint32_t count = 0;
    if (const XrdsResult result = xrdsCountDevices(&count); result != XRDS_OK) return result;
    for (uint32_t i = 0; i < count; ++i) {
      XrdsDeviceDescription& one = found.emplace_back(XrdsDeviceDescription{.structSize = sizeof one});
      if (const XrdsResult result = xrdsDescribeDevice(i, &one); result != XRDS_OK) return result;
    }
    return XRDS_OK;
  });
  std::vector<nb::dict> fields;
  for (const XrdsDeviceDescription& one : found) fields.push_back(fieldsOf(one));
  return fields;
}

std::string findModel(const std::string& name) {
  std::array<char, 4096> path{};
  const XrdsResult result = xrdsFindModel(name.c_str(), path.data(), path.size());
  require(result, xrdsGetMessage());  // not in one call: the sentence is there after it
  return path.data();
}

std::vector<std::string> modelFolders() {
  std::vector<std::string> folders;
  while (const char* folder = xrdsGetModelFolder(static_cast<uint32_t>(folders.size()))) folders.emplace_back(folder);
  return folders;
}

std::string chooseModel(uint32_t scale, const std::vector<std::string>& inputs, double samples) {
  std::array<char, 256> name{};
  std::vector<const char*> images;
  for (const std::string& input : inputs) images.push_back(input.c_str());
  const XrdsResult result =
      xrdsChooseModel(scale, images.data(), static_cast<uint32_t>(images.size()), samples, name.data(), name.size());
  require(result, xrdsGetMessage());
  return name.data();
}

void mergeColour(const Image& low, const Image& full, double lowSamples, double fullSamples, const Image& merged) {
  Call call;
  call.run([&] { return xrdsMergeColour(&low.view(), &full.view(), lowSamples, fullSamples, &merged.view()); });
}

double compareColour(const Image& low, const Image& full) {
  double difference = 0;
  Call call;
  call.run([&] { return xrdsCompareColour(&low.view(), &full.view(), &difference); });
  return difference;
}

std::vector<std::string> importOidn(const std::string& library, const std::string& folder) {
  std::vector<std::string> files;
  const auto hear = [](void* user, const char* file) {
    static_cast<std::vector<std::string>*>(user)->emplace_back(file);
  };
  Call call;
  call.run([&] { return xrdsImportOidn(library.c_str(), folder.c_str(), hear, &files); });
  return files;
}

std::string version() {
  uint32_t numbers[3] = {};
  xrdsGetVersion(&numbers[0], &numbers[1], &numbers[2]);
  return std::to_string(numbers[0]) + "." + std::to_string(numbers[1]) + "." + std::to_string(numbers[2]);
}

}  // namespace

NB_MODULE(_native, module) {
  nb::class_<Image>(module, "Image")
      .def(nb::init<nb::handle, std::string, bool>(), "array"_a.none(), "name"_a, "writable"_a)
      .def_prop_ro("height", [](const Image& image) { return image.view().height; })
      .def_prop_ro("width", [](const Image& image) { return image.view().width; })
      .def_prop_ro("channels", &Image::channels)
      .def_prop_ro("dtype", &Image::type)
      .def_prop_ro("name", &Image::name)
      .def("overlaps", &Image::overlaps);
  nb::class_<Device>(module, "Device")
      .def(nb::init<const Text&, const Text&, const Text&, nb::handle>(), "select"_a.none(), "cache_folder"_a.none(),
           "kernel_family"_a.none(), "progress"_a.none())
      .def("fields", &Device::fields)
      .def("close", &Device::close);
  nb::class_<Model>(module, "Model")
      .def(nb::init<const std::string&>())
      .def_prop_ro("scale", &Model::scale)
      .def_prop_ro("inputs", &Model::inputs)
      .def("metadata", &Model::metadata);
  nb::class_<UpscalerOptions>(module, "UpscalerOptions")
      .def(nb::init<>())
      .def_rw("fp16", &UpscalerOptions::fp16)
      .def_rw("keep_unchanged", &UpscalerOptions::keepUnchanged)
      .def_rw("exposure", &UpscalerOptions::exposure)
      .def_rw("skip", &UpscalerOptions::skip)
      .def_rw("ensemble", &UpscalerOptions::ensemble)
      .def_rw("memory", &UpscalerOptions::memory)
      .def_rw("exact_tiles", &UpscalerOptions::exactTiles)
      .def_rw("wrap", &UpscalerOptions::wrap)
      .def_rw("tune", &UpscalerOptions::tune)
      .def_rw("denoised_colour", &UpscalerOptions::denoisedColour)
      .def_rw("separate_denoisers", &UpscalerOptions::separateDenoisers);
  nb::class_<Upscaler>(module, "Upscaler")
      .def(nb::init<Device&, const Model&, uint32_t, uint32_t, const UpscalerOptions&, const std::vector<const Model*>&,
                    nb::handle>(),
           "device"_a, "model"_a, "width"_a, "height"_a, "options"_a, "denoisers"_a, "progress"_a.none())
      .def("run", &Upscaler::run, "colour"_a, "auxiliary"_a, "output"_a, "progress"_a.none())
      .def("run_layers", &Upscaler::runLayers, "colour"_a, "auxiliary"_a, "output"_a, "sets"_a, "progress"_a.none())
      .def("close", &Upscaler::close)
      .def_prop_ro("exposure", &Upscaler::exposure)
      .def_prop_ro("device_bytes", &Upscaler::deviceBytes)
      .def_prop_ro("repairs", &Upscaler::repairs);
  bindTemporalFilter(module);
  module.def("devices", &devices);
  module.def("find_model", &findModel);
  module.def("model_folders", &modelFolders);
  module.def("choose_model", &chooseModel);
  module.def("merge_colour", &mergeColour);
  module.def("compare_colour", &compareColour);
  module.def("import_oidn", &importOidn);
  module.def("denoiser_folder", &xrdsGetDenoiserFolder);
  module.def("version", &version);
}

}  // namespace xrds::python
