// What changes the picture of `xrds upscale` changes that of the viewer as well: both are the same, bit for bit.
#include "image/exr/read.h"
#include "tests/cli/frames.h"
#include "tests/viewer/viewer_display.h"

namespace xrds::test {
namespace {

struct ViewerUpscaleOptions : ViewerDisplay {
  // So few pixels that the frame is made ready soonest, in a row that tiles can be cut from; and four times as many to
  // a side with a noisy colour of their own.
  std::string colour = (folder / "colour.exr").string(), full = (folder / "full.exr").string(),
              output = (folder / "upscaled.exr").string();

  const Box fullSize = boxOf(320, 12);

  ViewerUpscaleOptions() {
    writeParts(colour, {{boxOf(80, 3), boxOf(80, 3), {noisy("", 80)}}});
    writeParts(full, {{fullSize, fullSize, {noisy("", 320), albedoLayer("albedo", 320), normalLayer("normal", 320)}}});
  }
  static Layer noisy(const std::string& name, int width) {
    return {name, "RGB", [even = colourLayer(name, width).pixels](int x, int y, int c) {
              return even(x, y, c) * (0.7F + 0.6F * static_cast<float>((x * 7919 + y * 104729 + c * 31) % 256) / 255);
            }};
  }

  // The pictures of the command and of the viewer, with these options.
  std::pair<Image, Image> pictures(const std::vector<std::string>& options) {
    std::vector<std::string> command{"upscale", colour, full, "-o", output, "--quiet"}, viewer{colour, full};
    for (auto* arguments : {&command, &viewer}) arguments->insert(arguments->end(), options.begin(), options.end());
    const Ended ended = runXrds(command);
    EXPECT_EQ(ended.exitCode, 0) << ended.error;
    run("wait\nsave viewed.exr\nwait\nprint\n", viewer);
    return {readColour(output), readColour((folder / "viewed.exr").string())};
  }
  Image samePicture(std::vector<std::string> options) {
    options.insert(options.end(), {"--model", "xrds-x4-nano"});
    const auto [upscaled, viewed] = pictures(options);
    EXPECT_EQ(upscaled, viewed);
    return viewed;
  }
};

TEST_F(ViewerUpscaleOptions, MakeThePictureOfTheCommand) {
  const auto with = [&](std::vector<std::string> options) {
    options.insert(options.end(), {"--exposure", "0.7", "--samples", "64,16"});
    return options;
  };
  const Image plain = samePicture(with({})), brighter = samePicture({"--exposure", "3", "--samples", "64,16"});
  EXPECT_NE(brighter, plain);
  EXPECT_NE(samePicture({"--exposure", "3", "--samples", "4,16", "--wrap"}), brighter);
  const Image mean = samePicture(with({"--ensemble", "8"}));
  EXPECT_NE(mean, plain);
  EXPECT_NE(samePicture(with({"--ensemble", "4", "--wrap", "--memory", "1700000"})), mean);
  EXPECT_EQ(samePicture(with({"--memory", "1700000", "--tiles", "exact"})), plain);
  EXPECT_NE(samePicture(with({"--memory", "1700000"})), plain);
}

TEST_F(ViewerUpscaleOptions, ChooseTheModelOfTheCommand) {
  const std::vector<std::string> few{"--exposure", "0.7", "--aux-colour", "never", "--samples", "2,16"};
  const auto [upscaled, viewed] = pictures(few);
  EXPECT_EQ(upscaled, viewed);
  std::vector<std::string> skipping = few;
  skipping.insert(skipping.begin(), {colour, full, "--skip", "safe"});
  const Ended ended = run("wait\nprint\nkey K\nkey K\nwait\nprint\n", skipping);
  EXPECT_EQ(occurrences(ended.output, "model=xrds-x4-compact "), 1U) << ended.output;
  EXPECT_EQ(occurrences(ended.output, "model=xrds-x4-live "), 1U) << ended.output;
}

// A layer that is the same everywhere is left out, of a sequence one that is so in other frames, too.
TEST_F(ViewerUpscaleOptions, LeaveConstantGuidesOut) {
  const auto constant = [](int, int, int c) { return c == 2 ? 0.5F : 0.25F; };
  const auto guides = [&](const std::string& file, const Layer& albedo, const Layer& normal) {
    writeParts(file, {{fullSize, fullSize, {albedo, normal}}});
  };
  const Layer albedo = albedoLayer("albedo", 320), normal = normalLayer("normal", 320);
  const Layer noAlbedo{"albedo", "RGB", constant}, noNormal{"normal", "XYZ", constant};
  const auto chosen = [&](const Layer& albedoThere, const Layer& normalThere) {
    guides(full, albedoThere, normalThere);
    const auto [upscaled, viewed] = pictures({"--exposure", "0.7"});
    EXPECT_EQ(upscaled, viewed);
    return run("wait\nprint\n", {colour, full}).output;
  };
  const std::string ofNormal = chosen(albedo, noNormal), ofAlbedo = chosen(noAlbedo, normal);
  EXPECT_TRUE(has(ofNormal, "model=xrds-x4-compact-albedo ")) << ofNormal;
  EXPECT_TRUE(has(ofNormal, "The normal is the same everywhere; taking model xrds-x4-compact-albedo.")) << ofNormal;
  EXPECT_TRUE(has(ofAlbedo, "model=xrds-x4-compact-plain ")) << ofAlbedo;
  const auto frame = [&](int number) { return (folder / ("full.000" + std::to_string(number) + ".exr")).string(); };
  for (int number = 1; number <= 3; ++number) {
    copy(colour, "colour.000" + std::to_string(number) + ".exr");
    guides(frame(number), noAlbedo, normal);
  }
  const std::vector<std::string> sequence{(folder / "colour.####.exr").string(), (folder / "full.####.exr").string()};
  const Ended empty = run("wait\nprint\n", sequence);
  EXPECT_TRUE(has(empty.output, "model=xrds-x4-compact-plain ")) << empty.output;
  guides(frame(3), albedo, normal);
  const Ended shown = run("wait\nprint\nkey PageDown\nwait\nprint\n", sequence);
  EXPECT_EQ(occurrences(shown.output, "model=xrds-x4-compact "), 2U) << shown.output;
}

TEST_F(ViewerUpscaleOptions, GoWithALiveView) {
  const auto shown = [&](const std::string& name, std::vector<std::string> more) {
    more.insert(more.end(), {"--live", "room", "--live-size", "16x16", "--samples", "4", "--model", "xrds-x4-nano"});
    run("wait\nsave " + name + "\nwait\n", more);
    return readColour((folder / name).string());
  };
  EXPECT_NE(shown("once.exr", {}), shown("twice.exr", {"--ensemble", "2"}));
}

TEST_F(ViewerUpscaleOptions, ThatExcludeEachOtherAreRefused) {
  const auto refusal = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {colour, full, "--model", "xrds-x4-nano"});
    const Ended ended = runViewer(desktop, folder, "wait\n", options);
    EXPECT_EQ(ended.exitCode, 2) << ended.error;
    return ended.error;
  };
  EXPECT_TRUE(has(refusal({"--wrap", "--ensemble", "8"}), "4 leaves out the diagonal"));
  EXPECT_TRUE(has(refusal({"--wrap", "--skip", "safe"}), "a panorama is computed in full"));
  EXPECT_TRUE(has(refusal({"--samples", "4,x"}), "two positive numbers"));
  EXPECT_TRUE(has(refusal({"--samples", "0"}), "--samples"));
  const Ended live = runViewer(desktop, folder, "wait\n", {"--live", "room", "--samples", "4,16"});
  EXPECT_EQ(live.exitCode, 2) << live.error;
  EXPECT_TRUE(has(live.error, "--samples of a live view is one number, found '4,16'")) << live.error;
}

}  // namespace
}  // namespace xrds::test
