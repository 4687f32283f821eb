// Every failure: one clear sentence, its exit code, and no file left behind.
#include <cmath>

#include "network/safetensors.h"
#include "tests/cli/frames.h"

namespace xrds::test {
namespace {

Ended upscale(const SmallFrame& frame, const std::vector<std::string>& more = {}) {
  return runXrds(frame.arguments(more));
}
Ended upscaleWith(const SmallFrame& frame, const std::string& model) { return runXrds(frame.arguments({}, model)); }

TEST(CliFailure, InputThatIsMissingEmptyTruncatedOrGarbage) {
  const SmallFrame frame;
  expectFailure(runXrds({"upscale", (frame.folder / "none.exr").string(), frame.aux, "-o", frame.out}), 3,
                "no such file", frame.folder, 2);
  const std::string good = readBytes(frame.color);
  writeBytes(frame.color, "");
  expectFailure(upscale(frame), 3, "empty file", frame.folder, 2);
  writeBytes(frame.color, good.substr(0, good.size() - 200));
  expectFailure(upscale(frame), 3, "damaged or unfinished", frame.folder, 2);
  writeBytes(frame.color, good.substr(0, 100));
  expectFailure(upscale(frame), 3, "a complete OpenEXR image", frame.folder, 2);
  writeBytes(frame.color, "this is no image at all");
  expectFailure(upscale(frame), 3, "another kind of file", frame.folder, 2);
}

TEST(CliFailure, SizesThatDoNotFit) {
  const SmallFrame frame;
  const auto setAux = [&](int width, int height) {
    writeParts(
        frame.aux,
        {{boxOf(width, height), boxOf(width, height), {albedoLayer("albedo", width), normalLayer("normal", width)}}});
  };
  setAux(41, 32);
  expectFailure(upscale(frame), 3, "no whole multiple", frame.folder, 2);
  setAux(20, 16);
  expectFailure(upscale(frame), 4, "upscales by 4", frame.folder, 2);
  setAux(30, 24);
  expectFailure(runXrds({"upscale", frame.color, frame.aux, "-o", frame.out}), 4, "no model of this scale",
                frame.folder, 2);
  const std::string colour = readBytes(frame.color);
  writeParts(frame.color, {{boxOf(10, 8), boxOf(40, 32), {colourLayer("", 10)}}});
  const std::vector<Layer> guides{albedoLayer("albedo", 40), normalLayer("normal", 40)};
  writeParts(frame.aux, {{boxOf(40, 32), boxOf(40, 32), guides, "guides"},
                         {boxOf(20, 16), boxOf(40, 32), {colourLayer("", 20)}, "rgba"}});
  expectFailure(upscaleWith(frame, "xrds-x4-full"), 3, "--albedo and --aux-colour", frame.folder, 2);
  writeBytes(frame.color, colour);
  setAux(40, 32);
  expectFailure(upscale(frame, {"--reference", frame.color}), 3, "expected the result's 40 x 32", frame.folder, 2);
}

TEST(CliFailure, LayersThatAreUnknownAmbiguousOrAbsent) {
  const SmallFrame frame;
  expectFailure(upscale(frame, {"--albedo", "bogus"}), 3, "a layer 'bogus'", frame.folder, 2);
  expectFailure(runXrds({"upscale", frame.color, "-o", frame.out}), 3, "No albedo", frame.folder, 2);
  expectFailure(runXrds({"upscale", frame.color, "-o", frame.out}), 3, "--model xrds-x4-compact-plain", frame.folder,
                2);
  writeParts(frame.aux, {{boxOf(40, 32),
                          boxOf(40, 32),
                          {albedoLayer("a.albedo", 40), albedoLayer("b.albedo", 40), normalLayer("normal", 40)}}});
  expectFailure(upscale(frame), 3, "ambiguous", frame.folder, 2);
  EXPECT_EQ(upscale(frame, {"--albedo", "b.albedo"}).exitCode, 0);
}

TEST(CliFailure, OutputsThatCannotBeWritten) {
  const SmallFrame frame;
  const auto to = [&](const std::string& path) {
    return runXrds({"upscale", frame.color, frame.aux, "-o", path, "--model", goldenModel("s4_guided")});
  };
  expectFailure(to((frame.folder / "none/out.exr").string()), 6, "existing folder", frame.folder, 2);
  expectFailure(to("/proc/out.exr"), 6, "takes no new files", frame.folder, 2);  // not even for the superuser
  expectFailure(to((frame.folder / "out.png").string()), 2, "ends in .exr", frame.folder, 2);
  expectFailure(upscale(frame, {"--preview", (frame.folder / "none/p.png").string()}), 6, "existing folder",
                frame.folder, 2);
  expectFailure(upscale(frame, {"--preview", (frame.folder / "p.jpg").string()}), 2, "ends in .png", frame.folder, 2);
  const std::string png = (frame.folder / "p.png").string();
  for (const char* option : {"--side-by-side", "--skip-map"})
    expectFailure(upscale(frame, {"--preview", png, option, png}), 2, "same file", frame.folder, 2);
}

TEST(CliFailure, AFullDisk) {
  const SmallFrame frame;
  ASSERT_EQ(upscale(frame).exitCode, 0);  // compiles the programs, so that nothing else needs the disk
  const std::string before = readBytes(frame.out);
  const Ended ended = runXrds(frame.arguments(), {.largestFileBytes = 1000});
  expectFailure(ended, 6, "disk", frame.folder, 3);
  EXPECT_EQ(readBytes(frame.out), before);  // the older result is untouched
}

/// A copy of the small model with a change.
std::string changedModel(const SmallFrame& frame, const std::function<void(TensorFile&)>& change) {
  TensorFile file = readTensors(goldenModel("s4_guided"));
  change(file);
  const std::string path = (frame.folder / "model.safetensors").string();
  writeTensors(path, file, DataType::f32);
  return path;
}

TEST(CliFailure, ModelsThatAreDamagedOrForeign) {
  const SmallFrame frame;
  const std::string path = (frame.folder / "model.safetensors").string(), good = readBytes(goldenModel("s4_guided"));
  const auto with = [&](const std::string& bytes) {
    writeBytes(path, bytes);
    return upscaleWith(frame, path);
  };
  expectFailure(upscaleWith(frame, "bogus"), 4, "xrds-x4-compact", frame.folder, 2);
  expectFailure(upscaleWith(frame, "bogus.safetensors"), 4, "bogus.safetensors", frame.folder, 2);
  expectFailure(with(good.substr(0, good.size() - 100)), 4, "truncated", frame.folder, 3);
  expectFailure(with(good.substr(0, 5)), 4, "truncated", frame.folder, 3);
  expectFailure(with(std::string(8, '\xff') + good.substr(8)), 4, "truncated", frame.folder, 3);
  expectFailure(with(good.substr(0, 8) + std::string(good.size() - 8, '[')), 4, "header", frame.folder, 3);
  const auto changed = [&](const std::function<void(TensorFile&)>& change) {
    return upscaleWith(frame, changedModel(frame, change));
  };
  expectFailure(changed([](TensorFile& f) { f.metadata["block"] = "swin"; }), 4, "block 'swin'", frame.folder, 3);
  expectFailure(changed([](TensorFile& f) { f.metadata["format"] = "other"; }), 4, "another format", frame.folder, 3);
  expectFailure(changed([](TensorFile& f) { f.metadata["channels"] = "99999999999"; }), 4, "expected a number",
                frame.folder, 3);
  expectFailure(changed([](TensorFile& f) { f.tensors.erase(f.tensors.begin()); }), 4, "misses the tensor",
                frame.folder, 3);
  expectFailure(changed([](TensorFile& f) { f.tensors.begin()->second.values[0] = NAN; }), 4, "not finite",
                frame.folder, 3);
  expectFailure(upscaleWith(frame, goldenModel("s4_guided_extra_aux")), 4, "auxiliary image 'extra'", frame.folder, 3);
}

TEST(CliFailure, WrongOptions) {
  const SmallFrame frame;
  for (const auto& wrong : std::vector<std::vector<std::string>>{{"--precision", "fp8"},
                                                                 {"--exposure", "0"},
                                                                 {"--exposure", "nan"},
                                                                 {"--exposure", "1e-42"},
                                                                 {"--exposure", ""},
                                                                 {"--bogus"}})
    expectFailure(upscale(frame, wrong), 2, "see xrds upscale --help", frame.folder, 2);
  expectFailure(runXrds({}), 2, "subcommand", frame.folder, 2);
  expectFailure(runXrds({"upscale", frame.color}), 2, "--output", frame.folder, 2);
  for (const char* size : {"12", "0x8", "12x8x", "-4x8", "15x16", "999999x8"})
    expectFailure(runXrds({"info", goldenModel("s4_guided"), "--size", size}), 2, "", frame.folder, 2);
  expectFailure(runXrds({"info", goldenModel("s4_guided"), "--size", "99996x99996"}), 2, "too large", frame.folder, 2);
}

TEST(CliFailure, NoDevice) {
  const SmallFrame frame;
  expectFailure(upscale(frame, {"--device", "bogus"}), 5, "bogus", frame.folder, 2);
  const std::string none = (frame.folder / "none.json").string();
  const StartOptions options{
      .environment = {{"VK_ICD_FILENAMES", none}, {"VK_DRIVER_FILES", none}, {"VK_LOADER_DEBUG", "none"}}};
  expectFailure(runXrds(frame.arguments(), options), 5, "Vulkan", frame.folder, 2);
  expectFailure(runXrds({"devices"}, options), 5, "Vulkan", frame.folder, 2);
}

}  // namespace
}  // namespace xrds::test
