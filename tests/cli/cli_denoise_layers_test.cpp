// Layers of light of `xrds denoise`, in files of many kinds, by small networks of random weights.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "image/exr/planes.h"
#include "image/exr/read.h"
#include "tests/cli/frames.h"
#include "tests/cli/process.h"

namespace xrds::test {
namespace {

float light(int x, int y, int c) { return 0.1F + 0.05F * static_cast<float>((7 * x + 3 * y + c) % 11); }

Layer of(const std::string& name, float factor) {
  return {name, "RGB", [=](int x, int y, int c) { return factor * light(x, y, c); }};
}

Image layer(const std::string& path, const std::string& name) {
  return readLayer(readExrHeader(path), {0, name, {name + ".R", name + ".G", name + ".B"}});
}

/// A render of 40 x 32 pixels with lights, a colour pass, guides and data, and networks for it.
struct NoisyFrame {
  TemporaryFolder folder;
  std::string render = (folder / "render.exr").string(), out = (folder / "out.exr").string(),
              networks = (folder / "networks").string();

  NoisyFrame() {
    const auto colour = [](int x, int, int) { return x < 20 ? 0.25F : 0.5F; };
    const auto combined = [=](int x, int y, int c) { return light(x, y, c) * (2 * colour(x, y, c) + 0.3F); };
    write({{"ViewLayer.Combined", "RGBA", combined},
           of("ViewLayer.DiffDir", 1.5F),
           of("ViewLayer.DiffInd", 0.5F),
           {"ViewLayer.DiffCol", "RGB", colour},
           of("ViewLayer.Emit", 0.3F),
           {"ViewLayer.Denoising Albedo", "RGB", colour},
           {"ViewLayer.Denoising Normal", "XYZ", normalLayer("", 40).pixels},
           {"ViewLayer.Depth", "Z", [](int x, int y, int) { return float(x + y); }}});
    writeDenoisers(networks);
  }
  void write(const std::vector<Layer>& layers) const { writeParts(render, {{boxOf(40, 32), boxOf(40, 32), layers}}); }
  Ended denoise(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"denoise", render, "-o", out, "--denoisers", networks};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runXrds(arguments);
  }
};

TEST(CliDenoiseLayers, AddUpToTheFrame) {
  const NoisyFrame frame;
  const auto of = [&](const std::string& name) { return layer(frame.out, "ViewLayer." + name); };
  for (const std::string guides : {"prefilter", "clean", "none"}) {
    ASSERT_EQ(frame.denoise({"--guides", guides}).exitCode, 0);
    const Image alone = readColour(frame.out);
    const Ended ended = frame.denoise({"--guides", guides, "--layers", "all"});
    ASSERT_EQ(ended.exitCode, 0) << ended.error;
    EXPECT_NE(ended.output.find("Layers of light: DiffDir, DiffInd, Emit, DiffCol.\nCopied: "), std::string::npos)
        << ended.output;
    EXPECT_EQ(ended.error.find("add up"), std::string::npos) << ended.error;
    const Image beauty = of("Combined"), direct = of("DiffDir"), indirect = of("DiffInd"), colour = of("DiffCol"),
                emission = of("Emit");
    EXPECT_EQ(beauty, alone);
    for (size_t i = 0; i < beauty.pixels.size(); ++i) {
      const float wanted = std::max(beauty.pixels[i], 0.F);
      ASSERT_NEAR((direct.pixels[i] + indirect.pixels[i]) * colour.pixels[i] + emission.pixels[i], wanted,
                  1e-5F * wanted);
    }
    EXPECT_NE(emission, layer(frame.render, "ViewLayer.Emit"));
    EXPECT_EQ(colour == layer(frame.render, "ViewLayer.DiffCol"), guides != "prefilter") << guides;
    for (const char* name : {"ViewLayer.Depth.Z", "ViewLayer.Denoising Albedo.G", "ViewLayer.Denoising Normal.X"})
      EXPECT_EQ(readPlanes(readExrHeader(frame.out), 0, {name}, boxOf(40, 32))[0].bytes,
                readPlanes(readExrHeader(frame.render), 0, {name}, boxOf(40, 32))[0].bytes)
          << name;
    EXPECT_EQ(readPlanes(readExrHeader(frame.out), 0, {"ViewLayer.Combined.A"}, boxOf(40, 32)).size(), 1U);
  }
}

TEST(CliDenoiseLayers, OfSequencesAreThoseOfTheFrames) {
  const NoisyFrame frame;
  ASSERT_EQ(frame.denoise({"--layers", "all"}).exitCode, 0);
  const std::string single = readBytes(frame.out);
  for (const char* name : {"r.0001.exr", "r.0002.exr"}) std::filesystem::copy(frame.render, frame.folder / name);
  const Ended ended =
      runXrds({"denoise", (frame.folder / "r.####.exr").string(), "-o", (frame.folder / "o.####.exr").string(),
               "--denoisers", frame.networks, "--layers", "all"});
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  for (const char* name : {"o.0001.exr", "o.0002.exr"}) EXPECT_EQ(readBytes(frame.folder / name), single);
  EXPECT_EQ(frame.denoise({"--layers", "Emitt"}).exitCode, 3);
}

// Each view layer has lights and colours of its own.
TEST(CliDenoiseLayers, AreThoseOfTheViewLayerOfTheColour) {
  const NoisyFrame frame;
  const auto view = [](const std::string& name, float colour) {
    return std::vector<Layer>{of(name + ".Combined", 2 * colour),
                              of(name + ".DiffDir", 2),
                              {name + ".DiffCol", "RGB", [=](int, int, int) { return colour; }}};
  };
  std::vector<Layer> both = view("A", 0.25F);
  for (const Layer& one : view("B", 0.5F)) both.push_back(one);
  frame.write(both);
  const Ended ended = frame.denoise({"--guides", "none", "--color", "B.Combined", "--layers", "all"});
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  const Image colour = layer(frame.out, "B.DiffCol"), picture = layer(frame.out, "B.Combined"),
              direct = layer(frame.out, "B.DiffDir");
  for (size_t i = 0; i < colour.pixels.size(); ++i) {
    EXPECT_EQ(colour.pixels[i], 0.5F);
    EXPECT_NEAR(direct.pixels[i] * 0.5F, picture.pixels[i], 1e-5F * picture.pixels[i]);
  }
  EXPECT_TRUE(contains(ended.output, "Left out: Combined (another colour), DiffDir (light that the colour's render"))
      << ended.output;
}

TEST(CliDenoiseLayers, ThatOverlapAreToldAndCountOnce) {
  const NoisyFrame frame;
  frame.write({of("", 1), of("all", 1), of("half", 0.5F)});
  const Ended ended = frame.denoise({"--guides", "none", "--layers", "all,half"});
  EXPECT_TRUE(contains(ended.error, "add up to 150.0 % of the colour")) << ended.error;
  const Ended named = frame.denoise({"--guides", "none", "--layers", "half, half"});
  ASSERT_EQ(named.exitCode, 0) << named.error;
  EXPECT_TRUE(contains(named.error, "add up to 50.0 % of the colour")) << named.error;
  EXPECT_EQ(frame.denoise({"--guides", "none", "--layers", ","}).exitCode, 2);
}

// Channels of a light that are not its colour, layers of other parts with their attributes, a prefix of their own.
TEST(CliDenoiseLayers, LeaveAllOthersAsTheyAre) {
  const NoisyFrame frame;
  const Box box = boxOf(40, 32);
  writeParts(frame.render,
             {{box, box, {{"", "RGB", of("", 1).pixels}, {"light.key", "RGBA", of("", 0.6F).pixels}}, "beauty"},
              {box, box, {of("mask.key", 0.2F)}, "masks", {{"cryptomatte/0/name", "mask"}}}});
  const Ended ended = frame.denoise({"--guides", "none", "--layers", "light.key"});
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_TRUE(contains(ended.output, "Layers of light: key.")) << ended.output;
  const std::vector<ExrLayer> layers = readExrHeader(frame.out).parts[0].layers;
  std::vector<std::string> names;
  for (const ExrLayer& one : layers)
    for (const ExrChannel& channel : one.channels) names.push_back(channel.name);
  for (const char* name : {"light.key.A", "mask.key.R"}) EXPECT_EQ(std::count(names.begin(), names.end(), name), 1);
  EXPECT_EQ(headerOf(frame.out).attributes.text("cryptomatte/0/name"), "mask");
}

// Of two files of one size.
TEST(CliDenoiseLayers, CopyWhatTheFileOfTheGuidesLacks) {
  const NoisyFrame frame, guides;
  const auto data = [](const std::string& name, float value) {
    return Layer{name, "Z", [=](int, int, int) { return value; }};
  };
  frame.write({of("L.Combined", 1), of("L.Emit", 1), data("L.Depth", 1), data("L.Mist", 2)});
  guides.write({of("L.Combined", 2), albedoLayer("L.Denoising Albedo", 40), normalLayer("L.Denoising Normal", 40),
                data("L.Depth", 3)});
  const Ended ended = runXrds(
      {"denoise", frame.render, guides.render, "-o", frame.out, "--denoisers", frame.networks, "--layers", "all"});
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_TRUE(contains(ended.output, "Copied: Denoising Albedo, Denoising Normal, Depth, Mist.")) << ended.output;
  for (const auto& [name, value] : {std::pair{"L.Depth.Z", 3.F}, {"L.Mist.Z", 2.F}}) {
    const std::vector<ExrPlane> plane = readPlanes(readExrHeader(frame.out), 0, {name}, boxOf(40, 32));
    float first = 0;
    std::memcpy(&first, plane[0].bytes.data(), sizeof first);
    EXPECT_EQ(first, value) << name;
  }
}

TEST(CliDenoiseLayers, ThatAreBrokenAreRepairedAndTold) {
  const NoisyFrame frame;
  const auto broken = [](int x, int y, int c) {
    return x == 3 && y == 2 ? std::nanf("") : x == 5 ? -1.F : light(x, y, c);
  };
  frame.write({of("L.Combined", 1), {"L.DiffDir", "RGB", broken}});
  const Ended ended = frame.denoise({"--guides", "none", "--layers", "all"});
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_TRUE(contains(ended.error, "1 pixel of layer 'L.DiffDir' not finite")) << ended.error;
  EXPECT_TRUE(contains(ended.error, "32 pixels of layer 'L.DiffDir' negative")) << ended.error;
}

}  // namespace
}  // namespace xrds::test
