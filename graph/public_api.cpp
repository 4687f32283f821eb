#include <algorithm>
#include <cstdio>

#include "graph/reference.h"
#include "graph/session.h"
#include "shaders/programs.h"
#include "xrds/xrds.h"

namespace xrds {
namespace {

Device::Description describeDevice(const DeviceDescription& device) {
  static constexpr const char* kKinds[] = {"discrete", "integrated", "virtual", "cpu", "other"};
  return {device.name,       kKinds[static_cast<size_t>(device.kind)], device.uuid, device.driver, device.apiVersion,
          device.memoryBytes};
}

// Three tightly packed floats a pixel.
std::vector<float> packPixels(const PixelView& image) {
  std::vector<float> packed(size_t{3} * image.width * image.height);
  for (size_t p = 0; p < packed.size() / 3; ++p) std::copy_n(image.pixels + p * image.stride, 3, &packed[3 * p]);
  return packed;
}

/// Host copies of a frame, in the layout that the session takes.
struct PackedFrame {
  std::vector<float> colour;
  std::vector<std::vector<float>> auxiliary;

  PackedFrame(const PixelView& colourImage, std::span<const PixelView> images) : colour(packPixels(colourImage)) {
    for (const PixelView& image : images) auxiliary.push_back(packPixels(image));
  }
  FrameInput input(std::optional<float> exposure) const {
    FrameInput frame{colour, {}, exposure};
    for (const auto& image : auxiliary) frame.auxiliary.emplace_back(image);
    return frame;
  }
};

std::string sizeText(uint32_t width, uint32_t height) { return std::to_string(width) + " x " + std::to_string(height); }

void checkFrame(const NetworkConfig& config, FrameShape frame, const PixelView& colour,
                std::span<const PixelView> auxiliary) {
  if (colour.width != frame.width || colour.height != frame.height)
    throw Error("The colour image is " + sizeText(colour.width, colour.height) + " pixels, expected " +
                sizeText(frame.width, frame.height) + ".");
  if (auxiliary.size() != config.auxInputs.size())
    throw Error("The model takes " + std::to_string(config.auxInputs.size()) + " auxiliary images, found " +
                std::to_string(auxiliary.size()) + ".");
  for (size_t i = 0; i < auxiliary.size(); ++i)
    if (auxiliary[i].width != config.scale * frame.width || auxiliary[i].height != config.scale * frame.height)
      throw Error("The " + config.auxInputs[i] + " image is " + sizeText(auxiliary[i].width, auxiliary[i].height) +
                  " pixels, expected " + sizeText(config.scale * frame.width, config.scale * frame.height) + ": " +
                  std::to_string(config.scale) + " times the colour's " + sizeText(frame.width, frame.height) + ".");
}

SessionOptions sessionOptions(const Upscaler::Options& options) {
  return {.precision = options.fp16 ? Precision::fp16 : Precision::fp32,
          .autoExposure = !options.exposure.has_value(),
          .timestamps = options.profile};
}

}  // namespace

struct Device::State {
  Gpu gpu;
};

struct Model::State {
  ModelWeights weights;
};

struct Upscaler::State {
  State(Gpu& gpu, const ModelWeights& model, FrameShape shape, const Options& given)
      : config(model.config()), frame(shape), options(given), session(gpu, model, shape, sessionOptions(given)) {}
  NetworkConfig config;
  FrameShape frame;
  Options options;
  Session session;
};

std::vector<Device::Description> Device::list() {
  std::vector<Description> descriptions;
  for (const DeviceDescription& device : listDevices()) descriptions.push_back(describeDevice(device));
  return descriptions;
}

Device::Device(const Options& options)
    : state_(new State{Gpu({.select = options.select,
                            .validation = options.validation,
                            .onMessage = options.onMessage,
                            .cacheFolder = options.cacheFolder,
                            .programs = embeddedProgram})}) {}
Device::~Device() = default;
Device::Device(Device&&) noexcept = default;
Device& Device::operator=(Device&&) noexcept = default;
Device::Description Device::description() const { return describeDevice(state_->gpu.description()); }

Model::Model(const std::filesystem::path& file) : state_(new State{ModelWeights::read(file)}) {}
Model::Model(std::unique_ptr<State> state) : state_(std::move(state)) {}
Model Model::untrained(uint32_t scale, const std::string& base, const std::string& transfer) {
  NetworkConfig none{.scale = scale, .groups = 0};
  if (base == "bicubic") none.auxInputs.clear();
  Metadata metadata = describe(none);
  metadata["base"] = base;
  metadata["transfer"] = transfer;
  TensorFile file;
  file.metadata = std::move(metadata);
  return Model(std::unique_ptr<State>(new State{ModelWeights::fromTensors(std::move(file), "untrained model")}));
}
Model::~Model() = default;
Model::Model(Model&&) noexcept = default;
Model& Model::operator=(Model&&) noexcept = default;
uint32_t Model::scale() const { return state_->weights.config().scale; }
const std::vector<std::string>& Model::auxiliaryInputs() const { return state_->weights.config().auxInputs; }
const std::map<std::string, std::string>& Model::metadata() const { return state_->weights.file().metadata; }

std::string Model::hash() const {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(state_->weights.file().hash));
  return text;
}

Model::Cost Model::cost(uint32_t outputWidth, uint32_t outputHeight, bool fp16) const {
  const NetworkConfig& config = state_->weights.config();
  if (outputWidth % config.scale != 0 || outputHeight % config.scale != 0)
    throw Error("An output of " + sizeText(outputWidth, outputHeight) + " pixels is no multiple of the model's scale " +
                std::to_string(config.scale) + ".");
  const GraphOptions options{fp16 ? Precision::fp16 : Precision::fp32};
  const FrameShape frame{outputHeight / config.scale, outputWidth / config.scale};
  const Graph graph = buildGraph(config, frame, state_->weights.lookup(), options);
  Cost sum;
  sum.parameters = state_->weights.parameterCount();
  for (const Node& node : graph.nodes) {
    const NodeCost part = xrds::cost(node);
    sum.multiplyAdds += part.multiplyAdds;
    sum.attentionMultiplyAdds += part.attentionMultiplyAdds;
  }
  const MemoryNeeds needs = memoryNeeds(graph, DeviceTraits{});
  sum.plannedBytes = needs.planned;
  sum.lowerBoundBytes = needs.lowerBound;
  sum.unaliasedBytes = needs.unaliased;
  sum.weightBytes = needs.weights;
  return sum;
}

Upscaler::Upscaler(Device& device, const Model& model, uint32_t width, uint32_t height, const Options& options)
    : state_(new State(device.state_->gpu, model.state_->weights, {height, width}, options)) {}
Upscaler::~Upscaler() = default;
Upscaler::Upscaler(Upscaler&&) noexcept = default;
Upscaler& Upscaler::operator=(Upscaler&&) noexcept = default;

bool Upscaler::run(const PixelView& colour, std::span<const PixelView> auxiliary, std::span<float> output,
                   const Progress& progress) {
  checkFrame(state_->config, state_->frame, colour, auxiliary);
  const PackedFrame packed(colour, auxiliary);
  const auto report = [&](size_t done, size_t total) {
    return progress(static_cast<double>(done) / static_cast<double>(total));
  };
  return state_->session.run(packed.input(state_->options.exposure), output,
                             progress ? std::function<bool(size_t, size_t)>(report) : nullptr);
}

float Upscaler::exposure() const { return state_->session.exposure(); }

uint64_t Upscaler::deviceBytes() const { return state_->session.plan().byteSize + state_->session.weightByteSize(); }

std::vector<Upscaler::ProfileRow> Upscaler::profile() const {
  std::vector<ProfileRow> rows;
  for (const DispatchTime& time : state_->session.times())
    rows.push_back({time.label, time.program, time.multiplyAdds, time.byteSize, time.microseconds});
  return rows;
}

std::vector<Upscaler::CheckRow> Upscaler::check(Device& device, const Model& model, const PixelView& colour,
                                                std::span<const PixelView> auxiliary, const Options& options) {
  const FrameShape frame{colour.height, colour.width};
  checkFrame(model.state_->weights.config(), frame, colour, auxiliary);
  const PackedFrame packed(colour, auxiliary);
  const CheckResult result = checkAgainstReference(device.state_->gpu, model.state_->weights, frame,
                                                   packed.input(options.exposure), sessionOptions(options));
  std::vector<CheckRow> rows;
  for (const Divergence& node : result.nodes)
    rows.push_back({node.node, node.relativeRms, node.finite, node.finite && node.relativeRms <= result.bound});
  return rows;
}

}  // namespace xrds
