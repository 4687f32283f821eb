#include "frames/frame_steps.h"

#include "engine/bytes.h"

namespace xrds {
namespace {

uint64_t imageBytes(const HostPixels& pixels) { return pixels.rowBytes * pixels.height; }

}  // namespace

TensorView FrameSteps::create(TensorShape shape) {
  const TensorView view = graph_.create("image", DataType::f32, shape);
  buffers_.push_back(std::make_unique<Buffer>(gpu_, alignUp(view.storedByteSize(), kBindingAlignment)));
  return view;
}

HostPicture FrameSteps::pictureOf(const TensorView& own) {
  XRDS_CHECK_EQ(own.channels, 4u);
  return {.pixels = {.rowBytes = own.rowByteSize(), .width = own.width, .height = own.height, .channels = 4},
          .buffer = &bufferOf(own)};
}

HostPicture FrameSteps::inBuffer(const HostPicture& picture) {
  HostPicture packed{.pixels = picture.pixels};
  packed.pixels.byteOffset = 0;
  packed.pixels.rowBytes =
      uint64_t{picture.pixels.width} * picture.pixels.channels * xrds::byteSize(picture.pixels.type);
  packed.buffer = &copies_.emplace_back(gpu_, imageBytes(packed.pixels));
  return packed;
}

HostPicture FrameSteps::read(const HostPicture& picture) {
  if (!picture.image) return picture;
  const HostPicture packed = inBuffer(picture);
  const uint64_t bytes = imageBytes(packed.pixels);
  copy({.byteSize = bytes, .image = picture.image}, {packed.buffer, 0, bytes});
  return packed;
}

void FrameSteps::copy(const ByteRange& from, const ByteRange& to) {
  PlacedDispatch placed;
  placed.dispatch.program = "copy";
  placed.dispatch.bindings = {{.access = Access::read, .kind = BindingKind::copied},
                              {.access = Access::write, .kind = BindingKind::copied}};
  placed.ranges = {from, to};
  placed_.push_back(std::move(placed));
}

void FrameSteps::place(std::span<const Dispatch> launches, const Buffer& host, const Buffer& arena, uint64_t offset) {
  for (const Dispatch& launch : launches) {
    PlacedDispatch placed{launch, {}};
    for (const Binding& binding : launch.bindings)
      placed.ranges.push_back(binding.value == 0 ? ByteRange{&host, binding.byteOffset, binding.byteSize}
                                                 : ByteRange{&arena, offset + binding.byteOffset, binding.byteSize});
    placed_.push_back(std::move(placed));
  }
}

void FrameSteps::take(const HostPicture& from, const Rectangle& part, const TensorView& to, const Buffer& arena,
                      uint64_t offset, uint32_t channel, uint32_t cleared) {
  const TakePixels take{from.pixels, to, part.x, part.y, channel, cleared};
  place(xrds::dispatches(take, gpu_.traits()), *from.buffer, arena, offset);
}

TensorView FrameSteps::taken(const HostPicture& from) {
  const HostPixels& pixels = from.pixels;
  const TensorView to = create({pixels.height, pixels.width, 4});
  take(read(from), {0, 0, pixels.width, pixels.height}, to, bufferOf(to), 0, 0, 1);
  return to;
}

void FrameSteps::run(std::vector<Operator> operators) {
  Graph graph = graph_;
  for (Operator& op : operators) {
    graph.nodes.push_back({"", std::move(op)});
    graph.nodes.back().name = factsOf(graph.nodes.back()).name;
  }
  for (LoweredDispatch& lowered : lower(graph, gpu_.traits())) {
    PlacedDispatch& dispatch = placed_.emplace_back(PlacedDispatch{std::move(lowered.dispatch), {}});
    for (const Binding& binding : dispatch.dispatch.bindings)
      dispatch.ranges.push_back({buffers_[binding.value].get(), binding.byteOffset, binding.byteSize});
  }
}

uint64_t FrameSteps::byteSize() const {
  uint64_t sum = 0;
  for (const auto& buffer : buffers_) sum += buffer->byteSize();
  for (const Buffer& copy : copies_) sum += copy.byteSize();
  return sum;
}

}  // namespace xrds
