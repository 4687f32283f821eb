#include "frames/session.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

#include "engine/bytes.h"
#include "graph/in_place.h"
#include "graph/kernel_table.h"
#include "xrds/error.h"

namespace xrds {
namespace {

/// Where the packed weights of every node lie, one behind the other.
struct PackedModel {
  struct Range {
    uint64_t offset = 0, byteSize = 0;
  };
  std::vector<Range> ranges;    // by node
  std::vector<PackedKey> keys;  // in the order of the bytes
  std::vector<uint32_t> nodes;  // the first that has each key
  uint64_t byteSize = 0;
};

PackedKey keyOf(const std::string& program, const Operator& op) {
  PackedKey key{program};
  std::visit(
      [&](const auto& o) {
        if constexpr (requires { o.weight; }) key.weight = o.weight.data();
        if constexpr (requires { o.biasTable; }) key.weight = o.biasTable.data();
        if constexpr (requires { o.first; }) key.first = o.first.weight.data();
        if constexpr (std::is_same_v<std::decay_t<decltype(o)>, WinogradOutput>) key.weight = o.bias.data();
        if constexpr (requires { o.firstOutput; }) key.firstOutput = o.firstOutput;
      },
      op);
  return key;
}

// As the node's kernel reads them. A map that leaves the range of binary16 keeps its largest number, not an infinity.
std::vector<std::byte> packedBytes(const Node& node, const Dispatch& launch, const DeviceTraits& device) {
  DataType type = DataType::f32;
  for (const Binding& binding : launch.bindings)
    if (binding.value == kWeights) type = binding.type;
  std::vector<float> values = packedWeightsOf(node, device);
  if (type == DataType::f16)
    for (float& value : values) value = std::clamp(value, -65504.0f, 65504.0f);
  return encode(values, type);
}

// Nodes with the same kernel on the same channels have as many weights, so few are packed to know their size.
PackedModel packedModel(const Graph& graph, const DeviceTraits& device) {
  PackedModel packed;
  std::map<PackedKey, PackedModel::Range> known;  // bands of a layer share theirs
  std::map<std::tuple<std::string, std::string, std::vector<uint32_t>>, uint64_t> sizes;
  for (uint32_t n = 0; n < graph.nodes.size(); ++n) {
    const Node& node = graph.nodes[n];
    const Dispatch launch = dispatchOf(node, device);
    PackedKey key = keyOf(launch.program, node.op);
    if (node.kernel) key.shape = node.kernel->shape;
    const auto [range, isNew] = known.try_emplace(std::move(key));
    if (isNew) {
      const auto [size, isNewSize] =
          sizes.try_emplace({operatorKey(node.op), launch.program, launch.specialization}, 0);
      if (isNewSize) size->second = packedBytes(node, launch, device).size();
      range->second = {packed.byteSize, size->second};
      packed.keys.push_back(range->first);
      packed.nodes.push_back(n);
      packed.byteSize = alignUp(packed.byteSize + size->second, kBindingAlignment);
    }
    packed.ranges.push_back(range->second);
  }
  packed.byteSize = std::max(packed.byteSize, kBindingAlignment);
  return packed;
}

// Node by node, so that the host never holds all of them.
void uploadWeights(const Graph& graph, const DeviceTraits& device, const PackedModel& packed, Buffer& to) {
  for (const uint32_t n : packed.nodes) {
    const Node& node = graph.nodes[n];
    const std::vector<std::byte> bytes = packedBytes(node, dispatchOf(node, device), device);
    XRDS_CHECK_EQ(bytes.size(), packed.ranges[n].byteSize);
    to.upload(packed.ranges[n].offset, bytes);
  }
}

void checkSize(const char* what, const PixelView& image, const TensorView& expected) {
  if (image.width != expected.width || image.height != expected.height)
    throw InvalidArgument(std::string("The ") + what + " image is " + std::to_string(image.width) + " x " +
                          std::to_string(image.height) + " pixels, expected " + std::to_string(expected.width) + " x " +
                          std::to_string(expected.height) + ".");
}

std::vector<ValueId> ownStorage(const Graph& graph) {
  std::vector<ValueId> storage(graph.values.size());
  std::iota(storage.begin(), storage.end(), ValueId{0});
  return storage;
}

DeviceTraits traitsFor(const Gpu& gpu, const SessionOptions& options) {
  DeviceTraits traits = gpu.traits();
  traits.family = options.family.value_or(traits.family);
  if (options.memoryBytes > 0) traits.memoryBytes = std::min(traits.memoryBytes, options.memoryBytes);
  return traits;
}

}  // namespace

void checkBindings(const Graph& graph, const DeviceTraits& device) {
  for (const Value& value : graph.values)
    if (value.texelCount() > device.maxTexelBufferElements)
      throw Error("The frame needs a tensor of " + std::to_string(value.texelCount()) +
                  " texels, but the device binds at most " + std::to_string(device.maxTexelBufferElements) +
                  " texels: use smaller tiles.");
}

uint64_t arenaByteSize(const Graph& graph) {
  return alignUp(planMemory(lifetimes(graph, inPlaceStorage(graph))).byteSize, kBindingAlignment);
}

MemoryNeeds memoryNeeds(const Graph& graph, const DeviceTraits& device) {
  const auto aliased = lifetimes(graph, inPlaceStorage(graph));
  MemoryNeeds needs;
  needs.planned = planMemory(aliased).byteSize;
  needs.lowerBound = largestLiveSet(aliased);
  needs.unaliased = planWithoutAliasing(lifetimes(graph, ownStorage(graph))).byteSize;
  needs.weights = packedModel(graph, device).byteSize;
  return needs;
}

Session::Session(Gpu& gpu, const NetworkModel& model, FrameShape frame, SessionOptions options)
    : graph_(buildGraph(model.config(), frame, model.lookup(),
                        fastOn(traitsFor(gpu, options), {.precision = options.precision,
                                                         .autoExposure = options.autoExposure,
                                                         .bandRows = options.bandRows,
                                                         .kernels = options.kernels,
                                                         .layers = options.layers}))),
      storage_(options.aliasing ? inPlaceStorage(graph_) : ownStorage(graph_)) {
  const DeviceTraits traits = traitsFor(gpu, options);
  checkBindings(graph_, traits);
  const auto lives = lifetimes(graph_, storage_);
  plan_ = options.aliasing ? planMemory(lives) : planWithoutAliasing(lives);
  const PackedModel packed = packedModel(graph_, traits);
  packedKeys_ = packed.keys;
  const Session* lender = options.lender;
  const bool arenaFits = lender && lender->arena_->byteSize() >= alignUp(plan_.byteSize, kBindingAlignment);
  arena_ = arenaFits ? lender->arena_ : &ownArena_.emplace(gpu, alignUp(plan_.byteSize, kBindingAlignment));
  if (lender && lender->packedKeys_ == packedKeys_) {
    weights_ = lender->weights_;
  } else {
    weights_ = &ownWeights_.emplace(gpu, packed.byteSize);
    uploadWeights(graph_, traits, packed, *weights_);
  }

  const uint64_t mostWork =
      workOfSubmission(gpu.pace(), std::min(options.multiplyAddsPerSubmission, kMostWorkPerDispatch));
  for (LoweredDispatch& lowered : lower(graph_, traits, mostWork)) {
    const auto place = [&](const Binding& binding) -> ByteRange {
      if (binding.value == kWeights)
        return {weights_, packed.ranges[lowered.node].offset, packed.ranges[lowered.node].byteSize};
      return {arena_, plan_.offsets[storage_[binding.value]] + binding.byteOffset, binding.byteSize};
    };
    PlacedDispatch placed{std::move(lowered.dispatch), {}};
    for (const Binding& binding : placed.dispatch.bindings) placed.ranges.push_back(place(binding));
    placed_.push_back(std::move(placed));
  }
  recording_.emplace(gpu, placed_, RecordingOptions{options.timestamps, options.multiplyAddsPerSubmission, true});
}

bool Session::run(const FrameInput& input, std::span<float> output,
                  const std::function<bool(size_t, size_t)>& progress) {
  upload(input);
  if (!replay(progress)) return false;
  download(output);
  for (size_t i = 0; i < input.layers.size(); ++i)
    downloadLayerRows(i, [&](uint32_t row, std::span<const float> pixels) {
      const uint64_t width = graph_.output.width;
      for (uint64_t x = 0; x < width; ++x) std::copy_n(&pixels[4 * x], 3, &input.layers[i].mean[3 * (row * width + x)]);
    });
  return true;
}

void Session::upload(const FrameInput& input) {
  checkSize("colour", input.colour, graph_.colour);
  for (const PixelView& image : input.auxiliary) checkSize("auxiliary", image, graph_.auxiliary);
  for (const LayerImage& layer : input.layers) checkSize("layer", layer.image, graph_.colour);
  uploadPart(input, 0, 0);
}

void Session::uploadPart(const FrameInput& frame, int64_t x, uint32_t y) {
  // Images side by side in the channels of a view, the rest of them zero.
  const auto write = [&](const TensorView& view, std::span<const PixelView> images, int64_t left, uint32_t top) {
    XRDS_CHECK_EQ(byteSize(view.type), sizeof(float));
    const auto given = static_cast<uint32_t>(3 * images.size());
    for (const PixelView& image : images) XRDS_CHECK_LE(top + view.height, image.height);
    const uint64_t rowBytes = uint64_t{view.width} * view.channels * sizeof(float);
    arena_->uploadRows(placeOf(view), rowBytes, view.height, [&](uint32_t row, std::span<std::byte> bytes) {
      auto* to = reinterpret_cast<float*>(bytes.data());
      for (size_t i = 0; i < images.size(); ++i)
        copyRow(images[i], left, top + row, view.width, to + 3 * i, view.channels);
      for (uint32_t column = 0; column < view.width; ++column)
        std::fill(to + size_t{column} * view.channels + given, to + size_t{column + 1} * view.channels, 0.f);
    });
  };
  write(graph_.colour, {&frame.colour, 1}, x, y);
  if (graph_.auxiliary.exists()) {
    if (3 * frame.auxiliary.size() > graph_.auxiliary.channels ||
        3 * frame.auxiliary.size() + 3 < graph_.auxiliary.channels)
      throw InvalidArgument("The model was given " + std::to_string(frame.auxiliary.size()) +
                            " auxiliary images, another number than it expects.");
    const uint32_t scale = graph_.output.width / graph_.colour.width;
    write(graph_.auxiliary, frame.auxiliary, x * scale, y * scale);
  }
  XRDS_CHECK_EQ(frame.layers.size(), graph_.layers.size());
  for (size_t i = 0; i < frame.layers.size(); ++i) write(graph_.layers[i], {&frame.layers[i].image, 1}, x, y);
  if (!graph_.computesExposure()) {
    const FrameExposure exposure = frame.exposure.value_or(FrameExposure{});
    const float numbers[4] = {exposure.value, exposure.inverse, 0, 0};
    arena_->upload(placeOf(graph_.exposure), std::as_bytes(std::span(numbers)));
  }
}

void Session::downloadRows(const std::function<void(uint32_t, std::span<const float>)>& read) const {
  readRows(graph_.output, read);
}

void Session::downloadLayerRows(size_t layer, const std::function<void(uint32_t, std::span<const float>)>& read) const {
  readRows(graph_.layerMeans[layer], read);
}

void Session::readRows(const TensorView& view,
                       const std::function<void(uint32_t, std::span<const float>)>& read) const {
  XRDS_CHECK_EQ(byteSize(view.type), sizeof(float));
  const size_t count = size_t{view.width} * view.channels;
  arena_->downloadRows(placeOf(view), count * sizeof(float), view.height,
                       [&](uint32_t row, std::span<const std::byte> bytes) {
                         read(row, {reinterpret_cast<const float*>(bytes.data()), count});
                       });
}

void Session::download(std::span<float> output) const {
  XRDS_CHECK_EQ(output.size(), 3 * graph_.output.pixelCount());
  lostPixels_.clear();
  downloadRows([&](uint32_t row, std::span<const float> pixels) {
    storeRow(pixels, uint64_t{row} * graph_.output.width, output, lostPixels_);
  });
  std::sort(lostPixels_.begin(), lostPixels_.end());
}

std::vector<DispatchTime> timesOf(std::span<const PlacedDispatch> dispatches, std::span<const double> microseconds) {
  std::vector<DispatchTime> times;
  for (size_t i = 0; i < microseconds.size(); ++i) {
    const Dispatch& dispatch = dispatches[i].dispatch;
    DispatchTime row{dispatch.label, dispatch.program, dispatch.multiplyAdds, 0, microseconds[i]};
    for (const ByteRange& range : dispatches[i].ranges) row.byteSize += range.byteSize;
    times.push_back(std::move(row));
  }
  return times;
}

std::vector<DispatchTime> Session::times() const { return timesOf(placed_, recording_->gpuMicroseconds()); }

std::vector<float> Session::read(const TensorView& view) const {
  std::vector<std::byte> bytes(view.storedByteSize());
  arena_->download(placeOf(view), bytes);
  return decode(bytes, view.type);
}

uint64_t Session::ownByteSize() const {
  return (ownArena_ ? ownArena_->byteSize() : 0) + (ownWeights_ ? ownWeights_->byteSize() : 0);
}

float Session::exposure() const { return read(graph_.exposure).front(); }

void openSession(std::optional<Session>& session, Gpu& gpu, const NetworkModel& model, FrameShape frame,
                 SessionOptions options) {
  try {
    session.emplace(gpu, model, frame, options);
    return;
  } catch (const OutOfMemory&) {
    if (options.bandRows != 0) throw;
  }
  options.bandRows = model.config().window;
  session.emplace(gpu, model, frame, options);
}

}  // namespace xrds
