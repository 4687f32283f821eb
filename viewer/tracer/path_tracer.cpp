#include "viewer/tracer/path_tracer.h"

#include <optional>
#include <utility>

#include "engine/recording.h"
#include "viewer/tracer/metal_energy.h"
#include "viewer/tracer/packed_scene.h"

namespace xrds {
namespace {

// Samples of a pixel in one submission, and pixels of one submission on a CPU device: some 15 ms of work.
constexpr uint32_t kSamplesAtOnce = 4;
constexpr uint32_t kColourPixelsAtOnce = 2048, kAuxiliaryPixelsAtOnce = 16384;

template <class T>
Buffer uploaded(Gpu& gpu, const std::vector<T>& texels) {
  Buffer buffer(gpu, texels.size() * sizeof(T));
  buffer.upload(0, std::as_bytes(std::span(texels)));
  return buffer;
}

Buffer cleared(Gpu& gpu, uint64_t byteSize) {
  Buffer buffer(gpu, byteSize);
  buffer.fill(0);
  return buffer;
}

/// A picture that a kernel refines: sums of its samples, and their mean.
struct Picture {
  Picture(Gpu& gpu, const char* name, TensorShape size)
      : program(name), shape(size), sums(cleared(gpu, byteSize())), mean(cleared(gpu, byteSize())) {}
  TensorView view() const { return {0, DataType::f32, shape.height, shape.width, shape.channels, 0, shape.channels}; }
  uint64_t byteSize() const { return view().storedByteSize(); }

  const char* program;
  TensorShape shape;
  Buffer sums, mean;
  std::optional<Recording> recording;
  uint32_t samples = 0;
};

}  // namespace

struct PathTracer::State {
  State(Gpu& device, const PackedScene& scene, TensorShape size, uint32_t scale, const TraceOptions& options);
  PlacedDispatch dispatchOf(const Picture& picture, RowRange rows) const;
  void record(Picture& picture, uint32_t pixelsAtOnce);
  void uploadView(uint32_t samples);
  bool addPass(Picture& picture, uint32_t samples, const Progress& progress);

  Gpu& gpu;
  trace::TraceParams params;
  Buffer nodes, triangles, materials, textures, sky, lights, energy, view;
  Picture colour, auxiliary;
  Camera camera;
  bool isNewView = true;
};

PathTracer::State::State(Gpu& device, const PackedScene& scene, TensorShape size, uint32_t scale,
                         const TraceOptions& options)
    : gpu(device),
      params(scene.params),
      nodes(uploaded(gpu, scene.nodes)),
      triangles(uploaded(gpu, scene.triangles)),
      materials(uploaded(gpu, scene.materials)),
      textures(uploaded(gpu, scene.textures)),
      sky(uploaded(gpu, scene.sky)),
      lights(uploaded(gpu, scene.lights)),
      energy(uploaded(gpu, metalEnergyTable())),
      view(gpu, trace::kViewTexels * sizeof(Texel)),
      colour(gpu, "trace_radiance", {size.height, size.width, 4}),
      auxiliary(gpu, "trace_auxiliary", {scale * size.height, scale * size.width, 8}) {
  params.indirectClamp = options.indirectClamp > 0 ? options.indirectClamp : 1e30F;
  params.maxBounces = static_cast<int>(options.maxBounces);
  params.seed = options.seed;
  record(colour, kColourPixelsAtOnce);
  record(auxiliary, kAuxiliaryPixelsAtOnce);
}

PlacedDispatch PathTracer::State::dispatchOf(const Picture& picture, RowRange rows) const {
  const TensorView image = picture.view();
  trace::TraceParams own = params;
  own.width = static_cast<int>(image.width);
  own.height = static_cast<int>(image.height);
  own.rowBegin = static_cast<int>(rows.begin);
  own.rowEnd = static_cast<int>(rows.end);
  own.storeOrigin = static_cast<int>(storeOrigin(image, rows));

  PlacedDispatch placed;
  for (const Buffer* buffer : {&nodes, &triangles, &materials, &textures, &sky, &lights, &energy, &view}) {
    placed.dispatch.bindings.push_back({.type = buffer == &textures ? DataType::f16 : DataType::f32});
    placed.ranges.push_back({buffer});
  }
  const Binding written = writeRows(image, rows);
  for (const Buffer* buffer : {&picture.sums, &picture.mean}) {
    placed.dispatch.bindings.push_back(written);
    placed.ranges.push_back({buffer, written.byteOffset, written.byteSize});
  }
  placed.dispatch.program = picture.program;
  placed.dispatch.pushConstants = pushBytes(own);
  placed.dispatch.groupCount = {ceilDivide(image.width, trace::kTraceGroupWidth),
                                ceilDivide(rows.end - rows.begin, trace::kTraceGroupHeight), 1};
  placed.dispatch.label = picture.program;
  placed.dispatch.multiplyAdds = 1;  // one dispatch is one submission
  return placed;
}

void PathTracer::State::record(Picture& picture, uint32_t pixelsAtOnce) {
  const bool isCpu = gpu.description().kind == DeviceKind::cpu;
  const uint32_t height = picture.shape.height, group = trace::kTraceGroupHeight;
  const uint32_t rowsAtOnce = isCpu ? std::max(pixelsAtOnce / picture.shape.width / group, 1U) * group : height;
  std::vector<PlacedDispatch> dispatches;
  for (uint32_t y = 0; y < height; y += rowsAtOnce)
    dispatches.push_back(dispatchOf(picture, {y, std::min(y + rowsAtOnce, height)}));
  picture.recording.emplace(gpu, dispatches, RecordingOptions{.multiplyAddsPerSubmission = 1});
}

void PathTracer::State::uploadView(uint32_t samples) {
  const float aspect = static_cast<float>(colour.shape.width) / static_cast<float>(colour.shape.height);
  const float half = std::tan(0.5F * camera.verticalFov);
  const Vec3 forward = normalized(camera.target - camera.position);
  const Vec3 right = normalized(cross(forward, camera.up)), up = cross(right, forward);
  const Vec3 columns[] = {camera.position, half * aspect * right, half * up, forward};
  std::vector<Texel> texels;
  for (const Vec3& v : columns) texels.push_back({v.x, v.y, v.z, 0});
  texels[0][3] = static_cast<float>(samples);
  view.upload(0, std::as_bytes(std::span(texels)));
}

bool PathTracer::State::addPass(Picture& picture, uint32_t samples, const Progress& progress) {
  uploadView(samples);
  if (!picture.recording->run(progress)) return false;
  picture.samples += samples;
  return true;
}

PathTracer::PathTracer(Gpu& gpu, const TraceScene& scene, uint32_t width, uint32_t height, uint32_t scale,
                       const TraceOptions& options)
    : state_(new State(gpu, packScene(scene), {height, width, 4}, scale, options)) {
  state_->camera = scene.camera;
}
PathTracer::~PathTracer() = default;
PathTracer::PathTracer(PathTracer&&) noexcept = default;
PathTracer& PathTracer::operator=(PathTracer&&) noexcept = default;

void PathTracer::reset(const Camera& camera) {
  state_->camera = camera;
  state_->isNewView = true;
  state_->colour.samples = state_->auxiliary.samples = 0;
}

bool PathTracer::render(SampleCounts more, const Progress& progress) {
  if (std::exchange(state_->isNewView, false)) {
    state_->colour.sums.fill(0);
    state_->auxiliary.sums.fill(0);
  }
  for (uint32_t left = more.auxiliary, now = 0; left > 0; left -= now) {
    now = std::min(left, kSamplesAtOnce);
    if (!state_->addPass(state_->auxiliary, now, progress)) return false;
  }
  for (uint32_t left = more.colour, now = 0; left > 0; left -= now) {
    now = std::min(left, kSamplesAtOnce);
    if (!state_->addPass(state_->colour, now, progress)) return false;
  }
  return true;
}

SampleCounts PathTracer::samples() const { return {state_->colour.samples, state_->auxiliary.samples}; }
const Buffer& PathTracer::colour() const { return state_->colour.mean; }
const Buffer& PathTracer::auxiliary() const { return state_->auxiliary.mean; }

}  // namespace xrds
