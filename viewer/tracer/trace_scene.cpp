// Renders a scene to EXR files that `xrds upscale` reads, and says how long it took: for looking at and measuring the
// tracer without a display.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <exception>
#include <utility>
#include <vector>

#include "viewer/tracer/path_tracer.h"
#include "xrds/path_text.h"

namespace xrds {
namespace {

// Three channels of each plane of [height, planes, width, 4].
void writeChannels(const std::string& file, uint32_t width, uint32_t height, std::vector<const char*> names,
                   const DeviceBuffer& pixels) {
  std::vector<float> values(pixels.byteSize() / sizeof(float));
  pixels.download(0, std::as_writable_bytes(std::span(values)));
  Imf::Header header(static_cast<int>(width), static_cast<int>(height));
  Imf::FrameBuffer frame;
  const size_t pixel = 4 * sizeof(float), row = names.size() / 3 * pixel * width;
  for (size_t c = 0; c < names.size(); ++c) {
    header.channels().insert(names[c], Imf::Channel(Imf::FLOAT));
    char* const first = reinterpret_cast<char*>(&values[c / 3 * 4 * width + c % 3]);
    frame.insert(names[c], Imf::Slice(Imf::FLOAT, first, pixel, row));
  }
  Imf::OutputFile output(file.c_str(), header);
  output.setFrameBuffer(frame);
  output.writePixels(static_cast<int>(height));
}

double secondsOf(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void render(const std::string& name, const std::string& prefix, uint32_t width, uint32_t height, uint32_t scale,
            SampleCounts counts) {
  TraceScene scene;
  const auto& known = builtInSceneNames();
  const bool isBuiltIn = std::find(known.begin(), known.end(), name) != known.end();
  std::printf("scene %.3f s, ", secondsOf([&] { scene = isBuiltIn ? builtInScene(name) : loadScene(pathOf(name)); }));
  VulkanDevice gpu({});
  std::unique_ptr<PathTracer> tracer;
  std::printf("%zu triangles, tracer %.3f s, ", scene.triangles.size(),
              secondsOf([&] { tracer = std::make_unique<PathTracer>(gpu, scene, width, height, scale); }));
  tracer->render({1, 1});
  tracer->reset(scene.camera);
  double longest = 0;
  auto last = std::chrono::steady_clock::now();
  const auto progress = [&](size_t, size_t) {
    const auto now = std::chrono::steady_clock::now();
    longest = std::max(longest, std::chrono::duration<double>(now - std::exchange(last, now)).count());
    return true;
  };
  const double auxiliary = secondsOf([&] { tracer->render({0, counts.auxiliary}, progress); });
  const double colour = secondsOf([&] { tracer->render({counts.colour, 0}, progress); });
  std::printf("%.1f ms an auxiliary sample, %.1f ms a colour sample, longest submission %.1f ms\n",
              1000 * auxiliary / counts.auxiliary, 1000 * colour / counts.colour, 1000 * longest);
  writeChannels(prefix + "_colour.exr", width, height, {"R", "G", "B"}, tracer->colour());
  writeChannels(prefix + "_aux.exr", scale * width, scale * height,
                {"albedo.R", "albedo.G", "albedo.B", "normal.X", "normal.Y", "normal.Z"}, tracer->auxiliary());
}

}  // namespace
}  // namespace xrds

int main(int argc, char** argv) {
  if (argc < 6 || argc > 8) {
    std::fprintf(stderr,
                 "usage: xrds_trace SCENE PREFIX WIDTH HEIGHT SCALE [COLOUR_SAMPLES [AUXILIARY_SAMPLES]]\n"
                 "SCENE: a built-in name, a .gltf, .glb or .obj file. Writes PREFIX_colour.exr and PREFIX_aux.exr.\n");
    return 2;
  }
  const auto number = [&](int i, int otherwise) {
    return static_cast<uint32_t>(i < argc ? std::max(std::atoi(argv[i]), 1) : otherwise);
  };
  try {
    xrds::render(argv[1], argv[2], number(3, 0), number(4, 0), number(5, 0), {number(6, 64), number(7, 16)});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "xrds_trace: %s\n", error.what());
    return 1;
  }
  return 0;
}
