// Open Image Denoise's networks in front of the upscaler, on the device: small ones of random weights in their place.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "image/exr/read.h"
#include "tests/cli/frames.h"
#include "tests/cli/process.h"

namespace xrds::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// A frame, and a folder with the networks that it takes.
struct DenoisedFrame : SmallFrame {
  std::string networks = (folder / "networks").string();

  DenoisedFrame() { writeDenoisers(networks); }
  /// With the networks where `xrds import oidn` puts them, and a library, which halves radiance.
  StartOptions both() const { return {.environment = {{"XRDS_DENOISERS", networks}, {"XRDS_OIDN", XRDS_FAKE_OIDN}}}; }
  Ended upscale(const std::vector<std::string>& more, const StartOptions& start = {}) const {
    return runXrds(arguments(more), start);
  }
};

// What single pixels of the small model of random weights make of a rounding of its inputs.
constexpr float kRounded = 1e-3F;

void expectNear(const Image& found, const Image& expected, float tolerance) {
  ASSERT_EQ(found.pixels.size(), expected.pixels.size());
  for (size_t i = 0; i < expected.pixels.size(); ++i)
    ASSERT_NEAR(found.pixels[i], expected.pixels[i], tolerance * (0.1F + std::abs(expected.pixels[i]))) << i;
}

// A layer of aux.exr in the means of scale x scale pixels.
Layer meansOf(const SmallFrame& frame, const std::string& name, const std::string& axes) {
  std::vector<std::string> channels;
  for (const char axis : axes) channels.push_back(name + "." + axis);
  const Image full = readLayer(readExrHeader(frame.aux), {0, name, channels});
  return {name, axes, [full](int x, int y, int c) {
            float sum = 0;
            for (int i = 0; i < 16; ++i) sum += full.at(4 * x + i % 4, 4 * y + i / 4, c);
            return sum / 16;
          }};
}

// The colour as `xrds denoise` makes it with the means of the guides.
TEST(CliDenoiseNetworks, MakeWhatTheyMakeByThemselves) {
  const DenoisedFrame frame;
  const std::string noisy = (frame.folder / "noisy.exr").string(), clean = (frame.folder / "clean.exr").string();
  writeParts(noisy, {{boxOf(10, 8),
                      boxOf(10, 8),
                      {layerOf("", readColour(frame.color).pixels, 10), meansOf(frame, "albedo", "RGB"),
                       meansOf(frame, "normal", "XYZ")}}});
  const Ended denoised = runXrds({"denoise", noisy, "-o", clean, "--guides", "clean", "--denoisers", frame.networks});
  ASSERT_EQ(denoised.exitCode, 0) << denoised.error;
  SmallFrame two;
  two.color = clean;
  two.aux = frame.aux;
  ASSERT_EQ(runXrds(two.arguments()).exitCode, 0);

  const Ended ended = frame.upscale({"--denoise-first", "--clean-guides", "--denoisers", frame.networks});
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_NE(ended.output.find("Denoised first, by rt_hdr_calb_cnrm."), std::string::npos) << ended.output;
  EXPECT_EQ(headerOf(frame.out).attributes.text("xrds:denoiser"), "rt_hdr_calb_cnrm");
  expectNear(readColour(frame.out), readColour(two.out), kRounded);
}

TEST(CliDenoiseNetworks, AreTakenWhereTheyAreUnlessTheLibraryIsAskedFor) {
  const DenoisedFrame frame;
  const std::string file = (frame.folder / "run.json").string();
  const auto denoisedBy = [&](const std::vector<std::string>& more) {
    std::vector<std::string> options{"--denoise-first", "--json", file};
    options.insert(options.end(), more.begin(), more.end());
    const Ended ended = frame.upscale(options, frame.both());
    EXPECT_EQ(ended.exitCode, 0) << ended.error;
    return Json::parse(readBytes(file))["denoisedBy"].get<std::string>();
  };
  EXPECT_EQ(denoisedBy({}), "rt_hdr_calb_cnrm");
  const Image guided = readColour(frame.out);
  EXPECT_EQ(denoisedBy({"--denoise-by", "networks", "--clean-guides"}), "rt_hdr_calb_cnrm");
  EXPECT_NE(readColour(frame.out), guided);  // of guides without their own networks
  EXPECT_EQ(denoisedBy({"--denoise-by", "library"}), "Open Image Denoise 2.7.7");
  EXPECT_NE(readColour(frame.out), guided);
  fs::remove(fs::path(frame.networks) / "rt_nrm.safetensors");
  EXPECT_EQ(denoisedBy({}), "Open Image Denoise 2.7.7");
  EXPECT_EQ(denoisedBy({"--clean-guides"}), "rt_hdr_calb_cnrm");
}

TEST(CliDenoiseNetworks, AreMissedWhereTheyAreAskedFor) {
  const DenoisedFrame frame;
  fs::remove(fs::path(frame.networks) / "rt_alb.safetensors");
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{"--denoisers", frame.networks}, {"--denoise-by", "networks"}}) {
    std::vector<std::string> options{"--denoise-first"};
    options.insert(options.end(), more.begin(), more.end());
    const Ended ended = frame.upscale(options, frame.both());
    EXPECT_EQ(ended.exitCode, 4) << ended.error;
    EXPECT_NE(ended.error.find("There is no network rt_alb of Open Image Denoise"), std::string::npos) << ended.error;
  }
  EXPECT_EQ(frame.upscale({"--denoisers", frame.networks}).exitCode, 2);
  const Ended unreadable = frame.upscale({"--denoise-first", "--denoisers", std::string(5000, 'x')});
  EXPECT_EQ(unreadable.exitCode, 4) << unreadable.error;
}

TEST(CliDenoiseNetworks, TakeAnEnsemblesPassesAndHalfPrecision) {
  const DenoisedFrame frame;
  const std::vector<std::string> options{"--denoise-first", "--denoisers", frame.networks};
  std::vector<Image> made;
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{}, {"--ensemble", "8"}, {"--precision", "fp16"}}) {
    std::vector<std::string> all = options;
    all.insert(all.end(), more.begin(), more.end());
    const Ended ended = frame.upscale(all);
    ASSERT_EQ(ended.exitCode, 0) << ended.error;
    made.push_back(readColour(frame.out));
  }
  EXPECT_NE(made[0], made[1]);
  EXPECT_NE(made[0], made[2]);
  double difference = 0, power = 0;
  for (size_t i = 0; i < made[0].pixels.size(); ++i) {
    difference += std::pow(made[2].pixels[i] - made[0].pixels[i], 2);
    power += std::pow(made[0].pixels[i], 2);
  }
  EXPECT_LT(std::sqrt(difference / power), 0.05);
}

/// Two frames of a sequence that are those of `frame`.
Ended upscaleTwo(const DenoisedFrame& frame, const std::vector<std::string>& options) {
  for (const char* name : {"c.0001.exr", "c.0002.exr"})
    fs::copy(frame.color, frame.folder / name, fs::copy_options::overwrite_existing);
  std::vector<std::string> arguments = frame.arguments(options);
  for (std::string& argument : arguments) {
    if (argument == frame.color) argument = (frame.folder / "c.####.exr").string();
    if (argument == frame.out) argument = (frame.folder / "o.####.exr").string();
  }
  return runXrds(arguments);
}

TEST(CliDenoiseNetworks, GiveSequencesTheBytesOfTheirFrames) {
  const DenoisedFrame frame;
  std::vector<std::string> options{"--denoise-first", "--denoisers", frame.networks};
  for (const bool limited : {false, true}) {
    if (limited) options.insert(options.end(), {"--memory", "1G"});
    ASSERT_EQ(frame.upscale(options).exitCode, 0);
    const Ended ended = upscaleTwo(frame, options);
    ASSERT_EQ(ended.exitCode, 0) << ended.error;
    for (const char* one : {"o.0001.exr", "o.0002.exr"}) EXPECT_EQ(readBytes(frame.folder / one), readBytes(frame.out));
  }
}

// Where the memory is limited, images come back between one network and the next.
TEST(CliDenoiseNetworks, MakeTheSameInFrontOfTheUpscalerAndOneAfterTheOther) {
  const DenoisedFrame frame;
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{}, {"--clean-guides"}, {"--precision", "fp16"}, {"--exposure", "0.5"}}) {
    std::vector<std::string> options{"--denoise-first", "--denoisers", frame.networks, "--profile"};
    options.insert(options.end(), more.begin(), more.end());
    const Ended inFront = frame.upscale(options);
    ASSERT_EQ(inFront.exitCode, 0) << inFront.error;
    EXPECT_NE(inFront.output.find("binned_exposure"), std::string::npos) << inFront.output;
    const Image made = readColour(frame.out);
    options.insert(options.end(), {"--memory", "1G"});
    const Ended behind = frame.upscale(options);
    ASSERT_EQ(behind.exitCode, 0) << behind.error;
    EXPECT_EQ(behind.output.find("binned_exposure"), std::string::npos) << behind.output;
    expectNear(made, readColour(frame.out), more.size() > 1 && more[1] == "fp16" ? 2e-2F : kRounded);
  }
}

// Of what this model changes in a denoised colour, 0.75 where it makes it darker, 0.25 where brighter; on the device,
// between one network and the next, and by the library.
TEST(CliDenoiseNetworks, TakeThePartOfTheChangeThatTheModelStates) {
  const DenoisedFrame frame;
  const std::string render = (frame.folder / "render.exr").string(), clean = (frame.folder / "clean.exr").string(),
                    whole = (frame.folder / "whole.exr").string(), out = (frame.folder / "part.exr").string();
  const Layer colour{"", "RGB", [](int x, int y, int c) { return 0.2F + 0.1F * static_cast<float>((x + y + c) % 7); }};
  writeParts(render, {{boxOf(40, 32), boxOf(40, 32), {colour, albedoLayer("albedo", 40), normalLayer("normal", 40)}}});
  const std::string model = XRDS_GOLDEN_FOLDER "/s1_restrained.model.safetensors";
  const auto make = [&](const std::vector<std::string>& words) {
    const Ended ended = runXrds(words, frame.both());
    EXPECT_EQ(ended.exitCode, 0) << ended.error;
  };
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{}, {"--memory", "1G"}, {"--denoise-by", "library"}}) {
    if (more.empty() || more[0] == "--memory") {
      make({"denoise", render, "-o", clean, "--guides", "clean"});
    } else {
      std::vector<float> half = readColour(render).pixels;
      for (float& number : half) number /= 2;
      writeParts(clean, {{boxOf(40, 32), boxOf(40, 32), {layerOf("", half, 40)}}});
    }
    std::vector<std::string> first{"upscale", render, "-o", out, "--model", model, "--denoise-first", "--clean-guides"};
    first.insert(first.end(), more.begin(), more.end());
    make({"upscale", clean, render, "-o", whole, "--model", model, "--aux-colour", "never"});
    make(first);
    const Image before = readColour(clean);
    Image expected = readColour(whole);
    for (size_t i = 0; i < expected.pixels.size(); ++i) {
      const float from = std::max(before.pixels[i], 0.F), change = expected.pixels[i] - from;
      expected.pixels[i] = from + (change < 0 ? 0.75F : 0.25F) * change;
    }
    EXPECT_NE(readColour(whole), expected);
    expectNear(readColour(out), expected, kRounded);
  }
}

// Merged first, of which nothing changes where both frames are the same and still; then denoised.
TEST(CliDenoiseNetworks, ComeAfterFramesAreMerged) {
  const DenoisedFrame frame;
  const Layer still{"Vector", "XYZW", [](int, int, int) { return 0.F; }};
  writeParts(frame.aux,
             {{boxOf(40, 32), boxOf(40, 32), {albedoLayer("albedo", 40), normalLayer("normal", 40), still}}});
  const std::vector<std::string> options{"--denoise-first", "--denoisers", frame.networks};
  ASSERT_EQ(frame.upscale(options).exitCode, 0);
  std::vector<std::string> merged = options;
  merged.emplace_back("--temporal");
  const Ended ended = upscaleTwo(frame, merged);
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  expectNear(readColour((frame.folder / "o.0001.exr").string()), readColour(frame.out), 2e-3F);
}

}  // namespace
}  // namespace xrds::test
