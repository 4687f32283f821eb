#include "viewer/tracer/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "viewer/tracer/metal_energy.h"
#include "viewer/tracer/packed_scene.h"
#include "viewer/tracer/programs.h"
#include "viewer/vulkan/kernel.h"

namespace xrds {
namespace {

// Samples of a pixel in one submission, and pixels of one submission on a CPU device: some 15 ms of work.
constexpr uint32_t kSamplesAtOnce = 4;
constexpr uint32_t kColourPixelsAtOnce = 2048, kAuxiliaryPixelsAtOnce = 16384;
constexpr uint64_t kTexelBytes = sizeof(Texel), kAlignment = DeviceBuffer::kSpareBytes;

// llvmpipe compiles a program anew for texel buffers whose sizes differ in bits 8 to 15, of bytes or of texels; these
// have the same there.
constexpr uint64_t kVariantStep = 65536, kVariantTexels = 256;

template <class T>
void fill(std::optional<DeviceBuffer>& buffer, VulkanDevice& gpu, const std::vector<T>& texels) {
  const uint64_t count = (texels.size() + kVariantStep - 1) / kVariantStep * kVariantStep + kVariantTexels;
  buffer.emplace(gpu, count * sizeof(T));
  buffer->upload(0, std::as_bytes(std::span(texels)));
}

/// A picture that a kernel refines: sums of its samples, and their mean; [height, planes, width, 4] each.
struct Picture {
  Picture(VulkanDevice& gpu, uint32_t wide, uint32_t high, uint32_t planeCount, uint32_t pixelsAtOnce)
      : width(wide), height(high), planes(planeCount), sums(gpu, byteSize()), mean(gpu, byteSize()) {
    constexpr auto kGroup = static_cast<uint32_t>(trace::kTraceGroupHeight);
    const uint64_t most = (gpu.properties.limits.maxStorageBufferRange - kAlignment) / rowBytes();
    rowsAtOnce = gpu.isCpu() ? std::max(pixelsAtOnce / width / kGroup, 1U) * kGroup : height;
    rowsAtOnce = static_cast<uint32_t>(std::clamp<uint64_t>(most, 1, std::min(rowsAtOnce, height)));
    sums.clear();
    mean.clear();
  }
  uint64_t rowBytes() const { return kTexelBytes * planes * width; }
  uint64_t byteSize() const { return rowBytes() * height; }
  /// Of the buffers, what a run sees.
  uint64_t partBytes() const { return rowBytes() * rowsAtOnce + kAlignment; }

  uint32_t width, height, planes, rowsAtOnce = 0;
  DeviceBuffer sums, mean;
  std::optional<Kernel> kernel;
  uint32_t samples = 0;
};

}  // namespace

struct PathTracer::State {
  State(VulkanDevice& device, const PackedScene& scene, uint32_t width, uint32_t height, uint32_t scale,
        const TraceOptions& options);
  void makeKernel(VulkanDevice& device, Picture& picture, std::string_view program);
  void uploadView(uint32_t samples);
  bool addPass(Picture& picture, uint32_t samples, const Progress& progress);

  trace::TraceParams params;
  std::optional<DeviceBuffer> nodes, triangles, materials, textures, sky, lights, energy;
  DeviceBuffer view;
  Picture colour, auxiliary;
  Camera camera;
  bool isNewView = true;
};

PathTracer::State::State(VulkanDevice& device, const PackedScene& scene, uint32_t width, uint32_t height,
                         uint32_t scale, const TraceOptions& options)
    : params(scene.params),
      view(device, (kVariantStep + kVariantTexels) * kTexelBytes),
      colour(device, width, height, 1, kColourPixelsAtOnce),
      auxiliary(device, scale * width, scale * height, 2, kAuxiliaryPixelsAtOnce) {
  fill(nodes, device, scene.nodes);
  fill(triangles, device, scene.triangles);
  fill(materials, device, scene.materials);
  fill(textures, device, scene.textures);
  fill(sky, device, scene.sky);
  fill(lights, device, scene.lights);
  fill(energy, device, metalEnergyTable());
  params.indirectClamp = options.indirectClamp > 0 ? options.indirectClamp : 1e30F;
  params.maxBounces = static_cast<int>(options.maxBounces);
  params.seed = options.seed;
  makeKernel(device, colour, "trace_radiance");
  makeKernel(device, auxiliary, "trace_auxiliary");
}

void PathTracer::State::makeKernel(VulkanDevice& device, Picture& picture, std::string_view program) {
  std::vector<Kernel::Texels> texels;
  for (const auto* buffer : {&nodes, &triangles, &materials, &textures, &sky, &lights, &energy})
    texels.push_back({&**buffer, buffer == &textures ? VK_FORMAT_R16G16B16A16_SFLOAT : VK_FORMAT_R32G32B32A32_SFLOAT});
  texels.push_back({&view, VK_FORMAT_R32G32B32A32_SFLOAT});
  picture.kernel.emplace(device, tracerProgram(program), texels, picture.sums, picture.mean, picture.partBytes(),
                         static_cast<uint32_t>(sizeof params));
}

void PathTracer::State::uploadView(uint32_t samples) {
  const float aspect = static_cast<float>(colour.width) / static_cast<float>(colour.height);
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
  trace::TraceParams own = params;
  own.width = static_cast<int>(picture.width);
  own.height = static_cast<int>(picture.height);
  const auto groups = [](uint32_t pixels, int size) {
    return (pixels + static_cast<uint32_t>(size) - 1) / static_cast<uint32_t>(size);
  };
  const size_t total = (picture.height + picture.rowsAtOnce - 1) / picture.rowsAtOnce;
  for (size_t done = 0; done < total; ++done) {
    const uint32_t begin = static_cast<uint32_t>(done) * picture.rowsAtOnce,
                   end = std::min(begin + picture.rowsAtOnce, picture.height);
    const uint64_t last =
        picture.byteSize() - picture.rowsAtOnce * picture.rowBytes();  // where the last part may begin
    const uint64_t offset = std::min(begin * picture.rowBytes(), last) / kAlignment * kAlignment;
    own.rowBegin = static_cast<int>(begin);
    own.rowEnd = static_cast<int>(end);
    own.storeOrigin = static_cast<int>(offset / kTexelBytes);
    picture.kernel->run(std::as_bytes(std::span(&own, 1)), static_cast<uint32_t>(offset),
                        groups(picture.width, trace::kTraceGroupWidth), groups(end - begin, trace::kTraceGroupHeight));
    if (progress && !progress(done + 1, total)) return false;
  }
  picture.samples += samples;
  return true;
}

PathTracer::PathTracer(VulkanDevice& gpu, const TraceScene& scene, uint32_t width, uint32_t height, uint32_t scale,
                       const TraceOptions& options)
    : state_(new State(gpu, packScene(scene), width, height, scale, options)) {
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
    state_->colour.sums.clear();
    state_->auxiliary.sums.clear();
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
const DeviceBuffer& PathTracer::colour() const { return state_->colour.mean; }
const DeviceBuffer& PathTracer::auxiliary() const { return state_->auxiliary.mean; }

}  // namespace xrds
