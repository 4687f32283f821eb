#include "graph/session.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "engine/half.h"
#include "xrds/error.h"

namespace xrds {
namespace {

uint64_t alignUp(uint64_t size) { return (size + kBindingAlignment - 1) / kBindingAlignment * kBindingAlignment; }

std::vector<std::byte> encode(std::span<const float> values, DataType type) {
  if (type == DataType::f32) {
    const auto bytes = std::as_bytes(values);
    return {bytes.begin(), bytes.end()};
  }
  std::vector<std::byte> bytes(values.size() * byteSize(type));
  for (size_t i = 0; i < values.size(); ++i) {
    const uint16_t half = toHalf(std::clamp(values[i], -65504.0f, 65504.0f));
    std::memcpy(bytes.data() + 2 * i, &half, 2);
  }
  return bytes;
}

/// The packed weights of every node, one behind the other.
struct PackedModel {
  struct Range {
    uint64_t offset = 0, byteSize = 0;
  };
  std::vector<Range> ranges;    // by node
  std::vector<PackedKey> keys;  // in the order of the bytes
  std::vector<std::byte> bytes;
};

const float* weightsOf(const Operator& op) {
  return std::visit(
      [](const auto& o) -> const float* {
        if constexpr (requires { o.weight; }) return o.weight.data();
        if constexpr (requires { o.biasTable; }) return o.biasTable.data();
        return nullptr;
      },
      op);
}

PackedModel packModel(const Graph& graph, const DeviceTraits& device) {
  PackedModel packed;
  std::map<PackedKey, PackedModel::Range> known;  // bands of a layer share theirs
  for (const Node& node : graph.nodes) {
    const Dispatch launch = std::visit([&](const auto& op) { return dispatch(op, device); }, node.op);
    const auto [range, isNew] = known.try_emplace({launch.program, weightsOf(node.op)});
    if (isNew) {
      DataType type = DataType::f32;
      for (const Binding& binding : launch.bindings)
        if (binding.value == kWeights) type = binding.type;
      const auto values = std::visit([&](const auto& op) { return packedWeights(op, device); }, node.op);
      const std::vector<std::byte> bytes = encode(values, type);
      range->second = {packed.bytes.size(), bytes.size()};
      packed.keys.push_back(range->first);
      packed.bytes.insert(packed.bytes.end(), bytes.begin(), bytes.end());
      packed.bytes.resize(alignUp(packed.bytes.size()));
    }
    packed.ranges.push_back(range->second);
  }
  if (packed.bytes.empty()) packed.bytes.resize(kBindingAlignment);
  return packed;
}

// Interleaves images of three channels into pixels of `stride`, the rest zero.
std::vector<float> interleave(const std::vector<std::span<const float>>& images, uint64_t pixels, uint32_t stride) {
  std::vector<float> packed(pixels * stride);
  for (size_t i = 0; i < images.size(); ++i)
    for (uint64_t p = 0; p < pixels; ++p) std::copy_n(&images[i][3 * p], 3, &packed[p * stride + 3 * i]);
  return packed;
}

void checkSize(const char* what, size_t found, uint64_t pixels) {
  if (found != 3 * pixels)
    throw Error(std::string("The ") + what + " image has " + std::to_string(found) + " numbers, expected " +
                std::to_string(3 * pixels) + ": 3 for each of its " + std::to_string(pixels) + " pixels.");
}

void checkLimits(const Graph& graph, const DeviceTraits& device) {
  for (const Value& value : graph.values)
    if (value.texelCount() > device.maxTexelBufferElements)
      throw Error("The frame needs a tensor of " + std::to_string(value.byteSize() >> 20) +
                  " MiB, more than the device can bind: use smaller tiles.");
}

std::vector<ValueId> ownStorage(const Graph& graph) {
  std::vector<ValueId> storage(graph.values.size());
  std::iota(storage.begin(), storage.end(), ValueId{0});
  return storage;
}

}  // namespace

uint64_t arenaByteSize(const Graph& graph) {
  return alignUp(planMemory(lifetimes(graph, inPlaceStorage(graph))).byteSize);
}

MemoryNeeds memoryNeeds(const Graph& graph, const DeviceTraits& device) {
  const auto aliased = lifetimes(graph, inPlaceStorage(graph));
  MemoryNeeds needs;
  needs.planned = planMemory(aliased).byteSize;
  needs.lowerBound = largestLiveSet(aliased);
  needs.unaliased = planWithoutAliasing(lifetimes(graph, ownStorage(graph))).byteSize;
  needs.weights = packModel(graph, device).bytes.size();
  return needs;
}

Session::Session(Gpu& gpu, const ModelWeights& model, FrameShape frame, SessionOptions options)
    : graph_(buildGraph(model.config(), frame, model.lookup(),
                        {options.precision, options.autoExposure, options.bandRows})),
      storage_(options.aliasing ? inPlaceStorage(graph_) : ownStorage(graph_)) {
  checkLimits(graph_, gpu.traits());
  const auto lives = lifetimes(graph_, storage_);
  plan_ = options.aliasing ? planMemory(lives) : planWithoutAliasing(lives);
  const PackedModel packed = packModel(graph_, gpu.traits());
  packedKeys_ = packed.keys;
  const Session* lender = options.lender;
  const bool arenaFits = lender && lender->arena_->byteSize() >= alignUp(plan_.byteSize);
  arena_ = arenaFits ? lender->arena_ : &ownArena_.emplace(gpu, alignUp(plan_.byteSize));
  if (lender && lender->packedKeys_ == packedKeys_) {
    weights_ = lender->weights_;
  } else {
    weights_ = &ownWeights_.emplace(gpu, packed.bytes.size());
    weights_->upload(0, packed.bytes);
  }

  for (LoweredDispatch& lowered : lower(graph_, gpu.traits())) {
    const auto place = [&](const Binding& binding) -> ByteRange {
      if (binding.value == kWeights)
        return {weights_, packed.ranges[lowered.node].offset, packed.ranges[lowered.node].byteSize};
      return {arena_, plan_.offsets[storage_[binding.value]] + binding.byteOffset, binding.byteSize};
    };
    PlacedDispatch placed{std::move(lowered.dispatch), {}};
    for (const Binding& binding : placed.dispatch.bindings) placed.ranges.push_back(place(binding));
    placed_.push_back(std::move(placed));
  }
  recording_.emplace(gpu, placed_, RecordingOptions{options.timestamps, options.multiplyAddsPerSubmission});
}

bool Session::run(const FrameInput& input, std::span<float> output,
                  const std::function<bool(size_t, size_t)>& progress) {
  checkSize("output", output.size(), graph_.output.pixelCount());
  upload(input);
  if (!replay(progress)) return false;
  download(output);
  return true;
}

void Session::upload(const FrameInput& input) {
  const auto write = [&](const TensorView& view, std::span<const float> values) {
    arena_->upload(placeOf(view), std::as_bytes(values));
  };
  checkSize("colour", input.colour.size(), graph_.colour.pixelCount());
  write(graph_.colour, interleave({input.colour}, graph_.colour.pixelCount(), 4));
  if (graph_.auxiliary.exists()) {
    for (const auto& image : input.auxiliary) checkSize("auxiliary", image.size(), graph_.auxiliary.pixelCount());
    if (3 * input.auxiliary.size() > graph_.auxiliary.channels ||
        3 * input.auxiliary.size() + 3 < graph_.auxiliary.channels)
      throw Error("The model was given " + std::to_string(input.auxiliary.size()) +
                  " auxiliary images, another number than it expects.");
    write(graph_.auxiliary, interleave(input.auxiliary, graph_.auxiliary.pixelCount(), graph_.auxiliary.channels));
  }
  if (!graph_.computesExposure()) {
    const float e = input.exposure.value_or(1.f);
    write(graph_.exposure, std::vector<float>{e, input.inverseExposure.value_or(1 / e), 0, 0});
  }
}

void Session::download(std::span<float> output) const {
  checkSize("output", output.size(), graph_.output.pixelCount());
  const std::vector<float> pixels = read(graph_.output);
  lostPixels_.clear();
  for (size_t p = 0; p < graph_.output.pixelCount(); ++p) {
    std::copy_n(&pixels[4 * p], 3, &output[3 * p]);
    if (pixels[4 * p + 3] != 0) lostPixels_.push_back(p);
  }
}

std::vector<DispatchTime> Session::times() const {
  const auto microseconds = recording_->gpuMicroseconds();
  std::vector<DispatchTime> times;
  for (size_t i = 0; i < microseconds.size(); ++i) {
    const Dispatch& dispatch = placed_[i].dispatch;
    DispatchTime row{dispatch.label, dispatch.program, dispatch.multiplyAdds, 0, microseconds[i]};
    for (const ByteRange& range : placed_[i].ranges) row.byteSize += range.byteSize;
    times.push_back(std::move(row));
  }
  return times;
}

std::vector<float> Session::read(const TensorView& view) const {
  std::vector<std::byte> bytes(view.storedByteSize());
  arena_->download(placeOf(view), bytes);
  std::vector<float> values(bytes.size() / byteSize(view.type));
  for (size_t i = 0; i < values.size(); ++i) {
    if (view.type == DataType::f32) {
      std::memcpy(&values[i], &bytes[4 * i], 4);
    } else {
      uint16_t half;
      std::memcpy(&half, &bytes[2 * i], 2);
      values[i] = fromHalf(half);
    }
  }
  return values;
}

uint64_t Session::ownByteSize() const {
  return (ownArena_ ? ownArena_->byteSize() : 0) + (ownWeights_ ? ownWeights_->byteSize() : 0);
}

float Session::exposure() const { return read(graph_.exposure).front(); }

void openSession(std::optional<Session>& session, Gpu& gpu, const ModelWeights& model, FrameShape frame,
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
