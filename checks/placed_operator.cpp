#include "checks/placed_operator.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "engine/bytes.h"
#include "engine/half.h"
#include "shaders/common/tolerance.h"
#include "xrds/error.h"

namespace xrds {
namespace {

std::string shapeText(const TensorView& view) {
  return std::to_string(view.height) + "x" + std::to_string(view.width) + "x" + std::to_string(view.channels);
}

// The same on every machine.
std::vector<float> inputNumbers(size_t count, uint32_t seed, DataType type, NumberRange range) {
  std::mt19937 bits(seed);
  std::vector<float> numbers(count);
  for (float& number : numbers) {
    number = static_cast<float>(bits() >> 8) * 0x1p-24F * (range.most - range.least) + range.least;
    if (type == DataType::f16) number = fromHalf(toHalf(number));
  }
  return numbers;
}

// Throws unless the values, their copies on the host and what the driver needs surely fit.
void requireMemory(const Gpu& gpu, const Graph& graph, const std::vector<LoweredDispatch>& lowered) {
  std::set<ValueId> bound;
  for (const LoweredDispatch& step : lowered)
    for (const Binding& binding : step.dispatch.bindings)
      if (binding.value != kWeights) bound.insert(binding.value);
  uint64_t needed = 0;
  for (const ValueId value : bound) needed += graph.values[value].byteSize();
  if (needed > gpu.description().memoryBytes)
    throw Error("The operator binds " + std::to_string(needed >> 20) + " MiB, more than the device has, " +
                std::to_string(gpu.description().memoryBytes >> 20) + " MiB: choose a smaller size.");
}

uint64_t bufferSize(uint64_t byteSize) {
  return std::max<uint64_t>(1, ceilDivide(byteSize, kBindingAlignment)) * kBindingAlignment;
}

}  // namespace

OperatorViews viewsOf(const Node& node) {
  OperatorViews views{.output = outputOf(node)};
  for (const OperatorInput& input : factsOf(node).inputs)
    if (input.view.exists()) views.inputs.push_back(input.view);
  return views;
}

std::string shapesText(const OperatorViews& views) {
  std::string text;
  for (const TensorView& view : views.inputs) text += (text.empty() ? "" : ", ") + shapeText(view);
  return text + " -> " + shapeText(views.output);
}

Graph single(const Graph& graph, const Node& node) {
  Graph one{.values = graph.values, .exposure = graph.exposure, .madeWeights = graph.madeWeights};
  one.nodes.push_back(node);
  return one;
}

PlacedOperator::PlacedOperator(Gpu& gpu, Graph graph, std::vector<NumberRange> ranges)
    : gpu_(gpu),
      graph_(std::move(graph)),
      ranges_(std::move(ranges)),
      buffers_(graph_.values.size()),
      inputs_(graph_.values.size()) {
  ranges_.resize(graph_.values.size());
  own_ = launchOf(graph_.nodes.front().kernel);
}

void PlacedOperator::clearOutput() {
  const ValueId output = outputOf(graph_.nodes.front()).value;
  if (inputs_[output].empty())
    buffers_[output]->fill(~0U);
  else
    buffers_[output]->upload(0, encode(inputs_[output], graph_.values[output].type));
}

PlacedOperator::Launch PlacedOperator::launchOf(const std::optional<KernelChoice>& kernel) {
  Node& node = graph_.nodes.front();
  node.kernel = kernel;
  const auto lowered = lower(graph_, gpu_.traits());
  requireMemory(gpu_, graph_, lowered);
  std::set<ValueId> read;
  for (const LoweredDispatch& step : lowered)
    for (const Binding& binding : step.dispatch.bindings)
      if (binding.access == Access::read) read.insert(binding.value);
  Launch launch;
  const auto rangeOf = [&](const Binding& binding) -> ByteRange {
    if (binding.value != kWeights) {
      const Value& value = graph_.values[binding.value];
      if (!buffers_[binding.value])
        fill(binding.value, value.type, value.byteSize() / byteSize(value.type), read.contains(binding.value));
      return {buffers_[binding.value].get(), binding.byteOffset, binding.byteSize};
    }
    const auto bytes = encode(packedWeightsOf(node, gpu_.traits()), binding.type);
    if (!launch.weights) {
      launch.weights = std::make_unique<Buffer>(gpu_, bufferSize(bytes.size()));
      launch.weights->upload(0, bytes);
    }
    return {launch.weights.get(), 0, bytes.size()};
  };
  for (const LoweredDispatch& step : lowered) {
    PlacedDispatch& placed = launch.dispatches.emplace_back(PlacedDispatch{step.dispatch, {}});
    for (const Binding& binding : step.dispatch.bindings) placed.ranges.push_back(rangeOf(binding));
  }
  return launch;
}

void PlacedOperator::fill(ValueId value, DataType type, size_t elementCount, bool isRead) {
  buffers_[value] = std::make_unique<Buffer>(gpu_, bufferSize(elementCount * byteSize(type)));
  if (!isRead) return buffers_[value]->fill(~0U);  // NaN in both types
  inputs_[value] = inputNumbers(elementCount, value + 1, type, ranges_[value]);
  if (value == graph_.exposure.value) inputs_[value] = {0.5F, 2, 0, 0};  // e and 1 / e
  buffers_[value]->upload(0, encode(inputs_[value], type));
}

std::vector<float> PlacedOperator::read(const TensorView& view) const {
  std::vector<std::byte> bytes(view.storedByteSize());
  buffers_[view.value]->download(0, bytes);
  return decode(bytes, view.type);
}

std::vector<PlacedOperator::Expected> PlacedOperator::expected(const std::vector<RowRange>& parts) const {
  HostMemory host;
  for (ValueId value = 0; value < inputs_.size(); ++value)
    if (const auto& numbers = inputs_[value]; !numbers.empty())
      std::copy(numbers.begin(), numbers.end(), host.storage(value, numbers.size()).begin());
  std::vector<Expected> all;
  for (const RowRange rows : parts) {
    Node node = graph_.nodes.front();
    std::visit(
        [&](auto& op) {
          if constexpr (requires { op.rows; }) {
            const uint32_t factor = shuffleFactor(op);
            op.rows = {rows.begin / factor, ceilDivide(rows.end, factor)};
          }
          reference(op, host);
        },
        node.op);
    const TensorView view = outputOf(node);
    Expected& made = all.emplace_back(Expected{rows, {}});
    made.values.reserve(size_t{rows.end - rows.begin} * view.width * view.channels);
    for (uint32_t y = rows.begin; y < rows.end; ++y)
      for (uint32_t x = 0; x < view.width; ++x)
        for (uint32_t c = 0; c < view.channels; ++c) made.values.push_back(host.at(view, y, x, c));
  }
  return all;
}

OperatorError PlacedOperator::errorOf(const std::vector<float>& output, const Expected& expected) const {
  const TensorView view = outputOf(graph_.nodes.front());
  OperatorError error;
  double squares = 0, power = 0;
  size_t next = 0;
  for (uint32_t y = expected.rows.begin; y < expected.rows.end; ++y)
    for (uint32_t x = 0; x < view.width; ++x) {
      const uint64_t first = (view.storedRow(y) * view.width + x) * view.channelStride + view.channelOffset;
      for (uint32_t c = 0; c < view.channels; ++c) {
        const double wanted = expected.values[next++], difference = std::abs(output[first + c] - wanted);
        error.finite = error.finite && std::isfinite(difference);
        squares += difference * difference;
        power += wanted * wanted;
        error.max = std::max(error.max, difference);
      }
    }
  const double referenceRms = std::sqrt(power / static_cast<double>(expected.values.size()));
  error.rms = std::sqrt(squares / power);
  error.max /= referenceRms;
  const Tolerance tolerance = toleranceOf(view.type);
  error.withinTolerance = error.finite && error.rms <= tolerance.rms && error.max <= tolerance.max;
  return error;
}

}  // namespace xrds
