#include "tests/cli/frames.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <algorithm>
#include <cmath>

namespace xrds::test {
namespace {

std::string channelName(const Layer& layer, size_t c) {
  return (layer.name.empty() ? "" : layer.name + ".") + layer.channels[c];
}

Imf::Header headerFor(const Part& part) {
  const auto box = [](const Box& w) { return Imath::Box2i({w.minX, w.minY}, {w.maxX, w.maxY}); };
  Imf::Header header(box(part.displayWindow), box(part.dataWindow));
  header.setType(Imf::SCANLINEIMAGE);
  if (!part.name.empty()) header.setName(part.name);
  header.insert("renderer", Imf::StringAttribute("made up"));
  header.insert("cameraZoom", Imf::FloatAttribute(1.5F));
  for (const Layer& layer : part.layers)
    for (size_t c = 0; c < layer.channels.size(); ++c)
      header.channels().insert(channelName(layer, c), Imf::Channel(Imf::FLOAT));
  for (const auto& [name, m] : part.matrices) {
    Imath::M44f matrix;
    std::copy(m.begin(), m.end(), &matrix[0][0]);
    header.insert(name, Imf::M44fAttribute(matrix));
  }
  for (const auto& [name, text] : part.texts) header.insert(name, Imf::StringAttribute(text));
  for (const auto& [name, number] : part.numbers) header.insert(name, Imf::IntAttribute(number));
  return header;
}

void writePart(Imf::MultiPartOutputFile& file, int number, const Part& part) {
  const Box& w = part.dataWindow;
  std::vector<std::vector<float>> planes;
  Imf::FrameBuffer buffer;
  for (const Layer& layer : part.layers)
    for (size_t c = 0; c < layer.channels.size(); ++c) {
      std::vector<float>& plane = planes.emplace_back();
      for (int y = 0; y < w.height(); ++y)
        for (int x = 0; x < w.width(); ++x) plane.push_back(layer.pixels(x, y, static_cast<int>(c)));
      buffer.insert(channelName(layer, c),
                    Imf::Slice::Make(Imf::FLOAT, plane.data(), Imath::V2i(w.minX, w.minY), w.width(), w.height()));
    }
  Imf::OutputPart output(file, number);
  output.setFrameBuffer(buffer);
  output.writePixels(static_cast<int>(w.height()));
}

}  // namespace

void writeParts(const std::filesystem::path& path, const std::vector<Part>& parts) {
  std::vector<Imf::Header> headers;
  headers.reserve(parts.size());
  for (const Part& part : parts) headers.push_back(headerFor(part));
  Imf::MultiPartOutputFile file(path.string().c_str(), headers.data(), static_cast<int>(headers.size()));
  for (size_t i = 0; i < parts.size(); ++i) writePart(file, static_cast<int>(i), parts[i]);
}

Box boxOf(int width, int height) { return {0, 0, width - 1, height - 1}; }

Layer colourLayer(const std::string& name, int width) {
  return {name, "RGB", [width](int x, int y, int c) {
            return (2 * x < width ? 0.2F : 1.1F) + 0.02F * static_cast<float>(y % 7) + 0.05F * static_cast<float>(c);
          }};
}

Layer albedoLayer(const std::string& name, int width) {
  return {name, "RGB", [width](int x, int y, int c) {
            return (2 * x < width ? 0.3F : 0.8F) + 0.005F * static_cast<float>(y % 9) + 0.02F * static_cast<float>(c);
          }};
}

Layer normalLayer(const std::string& name, int width) {
  return {name, "XYZ", [width](int x, int y, int c) {
            const float angle = (2 * x < width ? 0.4F : 2.2F) + 0.01F * static_cast<float>(y % 5);
            return c == 0 ? std::cos(angle) : c == 1 ? 0.F : std::sin(angle);
          }};
}

Layer layerOf(const std::string& name, const std::vector<float>& values, int width) {
  return {name, "RGB",
          [&values, width](int x, int y, int c) { return values[3 * (static_cast<size_t>(y) * width + x) + c]; }};
}

void writeHalfEvenFrame(const std::filesystem::path& color, const std::filesystem::path& aux, int edge, int brighter) {
  const auto layer = [edge](const std::string& name, const char* channels, int scale, float even, int from) {
    return Layer{name, channels, [=](int x, int y, int c) {
                   const float more = y >= from ? 0.05F : 0;
                   if (x >= scale * edge) return even + more;
                   return 0.1F + more + 0.9F * static_cast<float>((x * 7919 + y * 104729 + c * 31 + x * y) % 256) / 255;
                 }};
  };
  constexpr int kNever = 280;
  writeParts(color, {{boxOf(90, 70), boxOf(90, 70), {layer("", "RGB", 1, 0.4F, brighter)}}});
  writeParts(aux, {{boxOf(360, 280),
                    boxOf(360, 280),
                    {layer("albedo", "RGB", 4, 0.4F, kNever), layer("normal", "XYZ", 4, 0, kNever)}}});
}

SmallFrame::SmallFrame() {
  writeParts(color, {{boxOf(10, 8), boxOf(10, 8), {colourLayer("", 10)}}});
  writeParts(aux, {{boxOf(40, 32), boxOf(40, 32), {albedoLayer("albedo", 40), normalLayer("normal", 40)}}});
}

std::vector<std::string> SmallFrame::arguments(const std::vector<std::string>& more, const std::string& model) const {
  std::vector<std::string> all{
      "upscale", color, aux, "-o", out, "--model", model.empty() ? goldenModel("s4_guided") : model};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

std::string goldenModel(const std::string& name) { return XRDS_GOLDEN_FOLDER "/" + name + ".model.safetensors"; }

void writeDenoisers(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  for (const auto& [from, to] : {std::pair{"hdr_albedo_normal_large", "rt_hdr_calb_cnrm"},
                                 {"hdr_small", "rt_hdr"},
                                 {"albedo_small", "rt_alb"},
                                 {"normal_small", "rt_nrm"}})
    std::filesystem::copy_file(goldenModel(std::string("unet/") + from), folder / (std::string(to) + ".safetensors"));
}

ExrPart headerOf(const std::string& path) { return readExrHeader(path).parts.front(); }

Image readColour(const std::string& path) {
  const ExrFile file = readExrHeader(path);
  return readLayer(file, findAov(file, AovRole::kColor));
}

void expectFailure(const Ended& ended, int exitCode, const std::string& words, const TemporaryFolder& folder,
                   size_t fileCount) {
  EXPECT_EQ(ended.exitCode, exitCode) << ended.error;
  EXPECT_TRUE(ended.error.starts_with("xrds: ")) << ended.error;
  EXPECT_NE(ended.error.find(words), std::string::npos) << ended.error;
  EXPECT_EQ(ended.error.find("bug"), std::string::npos) << ended.error;
  EXPECT_EQ(folder.fileCount(), fileCount);
}

}  // namespace xrds::test
