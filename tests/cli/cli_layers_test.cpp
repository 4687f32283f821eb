// Layers of light, which add up to the result, and all others, which are copied bit for bit.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "image/exr/planes.h"
#include "image/exr/read.h"
#include "tests/cli/frames.h"
#include "tests/cli/process.h"

namespace xrds::test {
namespace {

float light(int x, int y, int c) { return 0.1F + 0.05F * static_cast<float>((7 * x + 3 * y + c) % 11); }

Layer of(const std::string& name, float factor, int scale = 1) {
  return {name, "RGB", [=](int x, int y, int c) { return factor * light(x / scale, y / scale, c); }};
}

/// A channel of some bits, by its name and type.
struct Raw {
  const char* name;
  Imf::PixelType type;
  std::vector<uint32_t> bits;
};

// Blender's channels: ids of 32-bit floats whose bits are no numbers anyone rounds, indices, halves.
std::vector<Raw> rawChannels() {
  std::vector<Raw> channels{{"ViewLayer.CryptoObject00.r", Imf::FLOAT, {}},
                            {"ViewLayer.CryptoObject00.g", Imf::FLOAT, {}},
                            {"ViewLayer.Depth.Z", Imf::FLOAT, {}},
                            {"ViewLayer.IndexOB.X", Imf::UINT, {}},
                            {"ViewLayer.Vector.X", Imf::HALF, {}}};
  uint32_t seed = 1;
  for (Raw& channel : channels)
    for (int i = 0; i < 40 * 32; ++i) {
      seed = seed * 1664525 + 1013904223;
      channel.bits.push_back(channel.type == Imf::HALF    ? seed >> 16 & 0x7BFF
                             : channel.type == Imf::FLOAT ? seed & 0xFF7FFFFF
                                                          : seed);
    }
  return channels;
}

// The auxiliary file: albedo, normal, the colour pass and what is to be copied, with a table of Cryptomatte.
void writeGuides(const SmallFrame& frame) {
  Imf::Header header(40, 32);
  header.insert("cryptomatte/0123456/manifest", Imf::StringAttribute("{\"cube\":\"3f800001\"}"));
  header.insert("cryptomatte/0123456/name", Imf::StringAttribute("ViewLayer.CryptoObject"));
  std::vector<std::vector<float>> floats;
  Imf::FrameBuffer buffer;
  floats.reserve(9);
  const auto add = [&](const std::string& name, const std::function<float(int, int)>& value) {
    std::vector<float>& plane = floats.emplace_back();
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 40; ++x) plane.push_back(value(x, y));
    header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, plane.data(), Imath::V2i(0), 40, 32));
  };
  for (const char* c : {"R", "G", "B"}) {
    add(std::string("ViewLayer.Denoising Albedo.") + c, [](int x, int) { return x < 20 ? 0.2F : 0.7F; });
    add(std::string("ViewLayer.DiffCol.") + c,
        [](int x, int y) { return x < 20 ? 0.2F : 0.5F + 0.01F * float(y % 4); });
  }
  for (const char* c : {"X", "Y", "Z"})
    add(std::string("ViewLayer.Denoising Normal.") + c, [&](int x, int) { return *c == 'Z' && x % 2 ? 0.9F : 0.3F; });
  std::vector<Raw> raw = rawChannels();
  std::vector<std::vector<uint16_t>> halves;
  for (Raw& channel : raw) {
    header.channels().insert(channel.name, Imf::Channel(channel.type));
    const bool isHalf = channel.type == Imf::HALF;
    if (isHalf) halves.emplace_back(channel.bits.begin(), channel.bits.end());
    buffer.insert(
        channel.name,
        Imf::Slice::Make(channel.type, isHalf ? static_cast<void*>(halves.back().data()) : channel.bits.data(),
                         Imath::V2i(0), 40, 32));
  }
  Imf::OutputFile file(frame.aux.c_str(), header);
  file.setFrameBuffer(buffer);
  file.writePixels(32);
}

void writeColour(const SmallFrame& frame) {
  const Layer combined{"ViewLayer.Combined", "RGB",
                       [](int x, int y, int c) { return light(x, y, c) * (0.5F * 2 + 0.3F); }};
  writeParts(frame.color,
             {{boxOf(10, 8),
               boxOf(10, 8),
               {combined, of("ViewLayer.DiffDir", 1.5F), of("ViewLayer.DiffInd", 0.5F),
                Layer{"ViewLayer.DiffCol", "RGB", [](int, int, int) { return 0.5F; }}, of("ViewLayer.Emit", 0.3F),
                of("ViewLayer.Combined_key", 1), of("ViewLayer.Combined_fill", 0.3F), of("ViewLayer.Mine", 0.2F)}}});
}

Image layer(const std::string& path, const std::string& name) {
  return readLayer(readExrHeader(path), {0, name, {name + ".R", name + ".G", name + ".B"}});
}

// The passes add up to the colour, and the light groups to it as well.
void expectSums(const SmallFrame& frame) {
  const Image beauty = layer(frame.out, "ViewLayer.Combined"), direct = layer(frame.out, "ViewLayer.DiffDir"),
              indirect = layer(frame.out, "ViewLayer.DiffInd"), colour = layer(frame.out, "ViewLayer.DiffCol"),
              emission = layer(frame.out, "ViewLayer.Emit"), key = layer(frame.out, "ViewLayer.Combined_key"),
              fill = layer(frame.out, "ViewLayer.Combined_fill");
  for (size_t i = 0; i < beauty.pixels.size(); ++i) {
    const float wanted = beauty.pixels[i];
    ASSERT_NEAR((direct.pixels[i] + indirect.pixels[i]) * colour.pixels[i] + emission.pixels[i], wanted,
                1e-5F * wanted);
    ASSERT_NEAR(key.pixels[i] + fill.pixels[i], wanted, 1e-5F * wanted);
  }
}

// What is no light has every bit of the full-resolution render.
void expectCopies(const SmallFrame& frame) {
  std::vector<std::string> names;
  for (const Raw& channel : rawChannels()) names.emplace_back(channel.name);
  const Box window = boxOf(40, 32);
  const auto given = readPlanes(readExrHeader(frame.aux), 0, names, window),
             found = readPlanes(readExrHeader(frame.out), 0, names, window);
  for (size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(given[i].type, found[i].type) << names[i];
    EXPECT_EQ(given[i].bytes, found[i].bytes) << names[i];
    const Raw raw = rawChannels()[i];
    if (raw.type != Imf::HALF) {
      EXPECT_EQ(std::memcmp(raw.bits.data(), found[i].bytes.data(), 4 * raw.bits.size()), 0);
    }
  }
}

Ended run(const SmallFrame& frame, const std::vector<std::string>& more, const StartOptions& start = {}) {
  writeColour(frame);
  writeGuides(frame);
  return runXrds(frame.arguments(more), start);
}

TEST(CliLayers, AddUpToTheResult) {
  const SmallFrame frame;
  const Ended ended = run(frame, {"--layers", "all"});
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  for (const char* words : {"DiffDir, DiffInd, Emit", "DiffCol (of full resolution)", "Copied: ", "CryptoObject00"})
    EXPECT_NE(ended.output.find(words), std::string::npos) << words << " in: " << ended.output;
  expectSums(frame);
  EXPECT_EQ(layer(frame.out, "ViewLayer.DiffCol"), layer(frame.aux, "ViewLayer.DiffCol"));
}

TEST(CliLayers, CopiesTheOthersBitForBit) {
  const SmallFrame frame;
  const Ended ended = run(frame, {"--layers", "all", "--half"});
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  expectCopies(frame);
  const Imf::InputFile file(frame.out.c_str());
  const auto* manifest = file.header().findTypedAttribute<Imf::StringAttribute>("cryptomatte/0123456/manifest");
  ASSERT_TRUE(manifest);
  EXPECT_EQ(manifest->value(), "{\"cube\":\"3f800001\"}");
  EXPECT_EQ(file.header().channels()["ViewLayer.Combined.R"].type, Imf::HALF);
}

// The denoiser of fake_oidn.cpp halves radiance, and with clean guides everything else stays: so do the lights.
TEST(CliLayers, AddUpToTheDenoisedResult) {
  const SmallFrame frame;
  const StartOptions withFake{.environment = {{"XRDS_OIDN", XRDS_FAKE_OIDN}, {"XRDS_DENOISERS", "/nowhere"}}};
  const std::vector<std::string> names{"DiffDir", "DiffInd", "Emit", "Combined_key", "Combined_fill", "Combined"};
  ASSERT_EQ(run(frame, {"--layers", "all"}).exitCode, 0);
  std::vector<Image> noisy;
  for (const std::string& name : names) noisy.push_back(layer(frame.out, "ViewLayer." + name));
  const Ended ended = run(frame, {"--layers", "all", "--denoise-first", "--clean-guides"}, withFake);
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  expectSums(frame);
  expectCopies(frame);
  for (size_t i = 0; i < names.size(); ++i) {
    const Image half = layer(frame.out, "ViewLayer." + names[i]);
    for (size_t p = 0; p < half.pixels.size(); ++p)
      ASSERT_NEAR(half.pixels[p], 0.5F * noisy[i].pixels[p], 1e-4F * (1 + noisy[i].pixels[p])) << names[i];
  }
}

TEST(CliLayers, AreThoseThatAreNamed) {
  const SmallFrame frame;
  const Ended ended = run(frame, {"--layers", "Mine"});
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_NE(ended.error.find("add up to 15.4 % of the colour"), std::string::npos) << ended.error;
  const Image beauty = layer(frame.out, "ViewLayer.Combined"), mine = layer(frame.out, "ViewLayer.Mine");
  for (size_t i = 0; i < beauty.pixels.size(); ++i)
    ASSERT_NEAR(mine.pixels[i], beauty.pixels[i] * 0.2F / 1.3F, 1e-3F * beauty.pixels[i]);
  const std::vector<ExrLayer> layers = readExrHeader(frame.out).parts[0].layers;
  for (const ExrLayer& one : layers) EXPECT_NE(one.name, "ViewLayer.Emit");
}

TEST(CliLayers, OfBlackAndWhiteBecomeColours) {
  const SmallFrame frame;
  const auto grey = [](const std::string& name, float factor, int scale) {
    Layer layer = of(name, factor, scale);
    layer.channels = "Y";
    return layer;
  };
  writeParts(frame.color, {{boxOf(10, 8), boxOf(10, 8), {grey("Combined", 1, 1), grey("Emit", 1, 1)}}});
  writeParts(frame.aux,
             {{boxOf(40, 32),
               boxOf(40, 32),
               {albedoLayer("albedo", 40), normalLayer("normal", 40), grey("Combined", 1.5F, 4), grey("Mist", 1, 4)}}});
  const Ended ended = runXrds(frame.arguments({"--layers", "all", "--aux-colour", "never"}));
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_TRUE(contains(ended.output, "Combined (another colour)")) << ended.output;
  EXPECT_EQ(layer(frame.out, "Combined"), layer(frame.out, "Emit"));
  std::string channels;
  for (const ExrLayer& one : headerOf(frame.out).layers)
    for (const ExrChannel& channel : one.channels) channels += channel.name + " ";
  EXPECT_EQ(channels,
            "Combined.B Combined.G Combined.R Emit.B Emit.G Emit.R Mist.Y albedo.B albedo.G albedo.R "
            "normal.X normal.Y normal.Z ");
}

TEST(CliLayers, AreRefusedWhereTheyCannotBe) {
  const SmallFrame frame;
  const auto expect = [&](const std::vector<std::string>& options, int code, const std::string& words) {
    const Ended ended = run(frame, options);
    EXPECT_EQ(ended.exitCode, code) << ended.error;
    EXPECT_NE(ended.error.find(words), std::string::npos) << ended.error;
  };
  expect({"--layers", "Emitt"}, 3, "did you mean 'Emit'");
  expect({"--layers", "all", "--skip", "safe"}, 2, "--layers needs every pixel");
  writeGuides(frame);
  const SmallFrame plain;  // without lights
  const Ended ended = runXrds(plain.arguments({"--layers", "all"}));
  EXPECT_NE(ended.exitCode, 0);
  EXPECT_NE(ended.error.find("No light layer is found"), std::string::npos) << ended.error;
}

TEST(CliLayers, OfSequencesAreThoseOfTheFrames) {
  const SmallFrame frame;
  ASSERT_EQ(run(frame, {"--layers", "all"}).exitCode, 0);
  std::filesystem::copy(frame.color, frame.folder / "c.0001.exr");
  std::filesystem::copy(frame.color, frame.folder / "c.0002.exr");
  std::vector<std::string> arguments = frame.arguments({"--layers", "all", "--frames", "1-2"});
  for (std::string& argument : arguments) {
    if (argument == frame.color) argument = (frame.folder / "c.####.exr").string();
    if (argument == frame.out) argument = (frame.folder / "o.####.exr").string();
  }
  const Ended ended = runXrds(arguments);
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_EQ(readBytes(frame.folder / "o.0001.exr"), readBytes(frame.out));
  EXPECT_EQ(readBytes(frame.folder / "o.0002.exr"), readBytes(frame.out));
}

TEST(CliLayers, AreRefusedBesideAColourOfAnotherView) {
  const SmallFrame frame;
  const Box low = boxOf(10, 8);
  const auto eye = [&](const std::string& view) {
    FixturePart part{"rgba_" + view, low, low, {"R", "G", "B"}};
    part.view = view;
    return part;
  };
  writeFixture(frame.color, {eye("left"), eye("right")});
  EXPECT_EQ(runXrds(frame.arguments({"--color", "right"})).exitCode, 0);
  expectFailure(runXrds(frame.arguments({"--color", "right", "--layers", "all"})), 3, "is of view 'right'",
                frame.folder, 3);
}

// Some renderers store each part's own rectangle.
TEST(CliLayers, PartsOfAnotherDataWindowAreToldToBeLeftOut) {
  const SmallFrame frame;
  writeColour(frame);
  const Box whole = boxOf(40, 32);
  const Layer depth{"", "Z", [](int x, int, int) { return static_cast<float>(x); }};
  writeParts(frame.aux, {{whole, whole, {albedoLayer("albedo", 40), normalLayer("normal", 40)}, "guides"},
                         {whole, whole, {depth}, "near"},
                         {Box{4, 4, 31, 27}, whole, {depth}, "far"}});
  const Ended ended = runXrds(frame.arguments({"--layers", "Emit"}));
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_TRUE(contains(ended.output, "Left out: far (of another data window)")) << ended.output;
}

}  // namespace
}  // namespace xrds::test
