#include "frames/device_images.h"

#include "engine/bytes.h"

namespace xrds {

TensorView DeviceImages::create(const char* name, TensorShape shape) {
  const TensorView view = graph_.create(name, DataType::f32, shape);
  buffers_.push_back(std::make_unique<Buffer>(gpu_, alignUp(view.storedByteSize(), kBindingAlignment)));
  return view;
}

std::vector<PlacedDispatch> DeviceImages::placed(std::vector<Operator> operators) const {
  Graph graph = graph_;
  for (Operator& op : operators) {
    graph.nodes.push_back({"", std::move(op)});
    graph.nodes.back().name = factsOf(graph.nodes.back()).name;
  }
  std::vector<PlacedDispatch> placed;
  for (LoweredDispatch& lowered : lower(graph, gpu_.traits())) {
    PlacedDispatch& dispatch = placed.emplace_back(PlacedDispatch{std::move(lowered.dispatch), {}});
    for (const Binding& binding : dispatch.dispatch.bindings)
      dispatch.ranges.push_back({buffers_[binding.value].get(), binding.byteOffset, binding.byteSize});
  }
  return placed;
}

void DeviceImages::upload(const TensorView& image, const std::function<void(uint32_t y, std::span<float> row)>& write) {
  bufferOf(image).uploadRows(0, image.rowByteSize(), image.height, [&](uint32_t y, std::span<std::byte> bytes) {
    write(y, {reinterpret_cast<float*>(bytes.data()), bytes.size() / sizeof(float)});
  });
}

void DeviceImages::download(const TensorView& image,
                            const std::function<void(uint32_t y, std::span<const float> row)>& read) const {
  bufferOf(image).downloadRows(0, image.rowByteSize(), image.height, [&](uint32_t y, std::span<const std::byte> bytes) {
    read(y, {reinterpret_cast<const float*>(bytes.data()), bytes.size() / sizeof(float)});
  });
}

uint64_t DeviceImages::byteSize() const {
  uint64_t sum = 0;
  for (const auto& buffer : buffers_) sum += buffer->byteSize();
  return sum;
}

}  // namespace xrds
