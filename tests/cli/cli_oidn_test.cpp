// `xrds denoise` with small networks of random weights in the place of Open Image Denoise's, and what it refuses.
#include <cmath>
#include <fstream>

#include "network/safetensors.h"
#include "tests/cli/frames.h"

namespace xrds::test {
namespace {

const std::string kGolden = XRDS_GOLDEN_FOLDER "/unet/";

/// A golden frame as one EXR file, and a folder with its network under the name that the command asks for.
struct NoisyFrame {
  TemporaryFolder folder;
  TensorFile golden;
  std::string in = (folder / "in.exr").string(), out = (folder / "out.exr").string();

  NoisyFrame(const std::string& name, const std::string& network)
      : golden(readTensors(kGolden + name + ".io.safetensors")) {
    const auto& shape = golden.tensors.at("colour").shape;
    const int height = static_cast<int>(shape[0]), width = static_cast<int>(shape[1]);
    Part part{boxOf(width, height), boxOf(width, height), {}};
    for (const char* image : {"colour", "albedo", "normal"})
      if (golden.tensors.contains(image))
        part.layers.push_back(
            layerOf(image == std::string("colour") ? "" : image, golden.tensors.at(image).values, width));
    writeParts(in, {part});
    std::filesystem::create_directory(folder / "networks");
    std::filesystem::copy_file(kGolden + name + ".model.safetensors", folder / "networks" / (network + ".safetensors"));
  }
  Ended denoise(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"denoise", in, "-o", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runXrds(arguments, {.environment = {{"XRDS_DENOISERS", (folder / "networks").string()}}});
  }
  double difference() const {
    const Image found = readColour(out);
    const std::vector<float>& expected = golden.tensors.at("output").values;
    double difference = 0, power = 0;
    for (size_t i = 0; i < expected.size(); ++i) {
      difference += std::pow(double{found.pixels.at(i)} - expected[i], 2);
      power += std::pow(double{expected[i]}, 2);
    }
    return std::sqrt(difference / power);
  }
};

TEST(CliOidn, MatchesPyTorch) {
  const NoisyFrame frame("ldr_albedo_normal_small", "rt_ldr_alb_nrm");
  for (const auto& [precision, tolerance] : {std::pair{"fp32", 1e-4}, std::pair{"fp16", 5e-3}}) {
    const Ended ended = frame.denoise({"--ldr", "--guides", "noisy", "--precision", precision});
    ASSERT_EQ(ended.exitCode, 0) << ended.error;
    EXPECT_LT(frame.difference(), tolerance) << precision;
  }
  expectFailure(frame.denoise({"--ldr", "--guides", "noisy", "--exposure", "2"}), 2, "cannot go with --ldr",
                frame.folder, 3);
}

TEST(CliOidn, TakesTheColourAlone) {
  const NoisyFrame frame("hdr_small", "rt_hdr");
  const Ended ended = frame.denoise({});
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_NE(ended.output.find("pixels by rt_hdr on"), std::string::npos) << ended.output;
  EXPECT_LT(frame.difference(), 1e-4);
}

TEST(CliOidn, DenoisesAnAlbedoWithoutANormal) {
  const NoisyFrame frame("hdr_albedo_base", "rt_hdr_alb");
  const std::string network = (frame.folder / "networks/rt_alb.safetensors").string();
  std::filesystem::copy_file(kGolden + "albedo_small.model.safetensors", network);
  const Ended ended = frame.denoise({});
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_GT(frame.difference(), 1e-3);  // from the colour with the albedo as it is
  const Image found = readColour(frame.out);

  const auto& shape = frame.golden.tensors.at("colour").shape;
  const int height = static_cast<int>(shape[0]), width = static_cast<int>(shape[1]);
  const Box box = boxOf(width, height);
  const std::string alone = (frame.folder / "albedo.exr").string(), clean = (frame.folder / "clean.exr").string();
  writeParts(alone, {{box, box, {layerOf("", frame.golden.tensors.at("albedo").values, width)}}});
  const Ended albedo = runXrds({"upscale", alone, "-o", clean, "--model", network});
  ASSERT_EQ(albedo.exitCode, 0) << albedo.error;
  writeParts(frame.in, {{box,
                         box,
                         {layerOf("", frame.golden.tensors.at("colour").values, width),
                          layerOf("albedo", readColour(clean).pixels, width)}}});
  ASSERT_EQ(frame.denoise({"--guides", "noisy"}).exitCode, 0);
  const Image expected = readColour(frame.out);
  ASSERT_EQ(found.pixels.size(), expected.pixels.size());
  for (size_t i = 0; i < found.pixels.size(); ++i) EXPECT_NEAR(found.pixels[i], expected.pixels[i], 1e-5) << i;
}

TEST(CliOidn, SaysWhatToImportWhereANetworkIsMissing) {
  const NoisyFrame frame("hdr_small", "rt_ldr");
  const Ended ended = frame.denoise({});
  EXPECT_EQ(ended.exitCode, 4) << ended.error;
  EXPECT_NE(ended.error.find("There is no network rt_hdr of Open Image Denoise"), std::string::npos) << ended.error;
  EXPECT_NE(ended.error.find("xrds import oidn PATH"), std::string::npos) << ended.error;
}

TEST(CliOidn, RefusesToImportWhatIsNoLibrary) {
  const TemporaryFolder folder;
  const std::string file = (folder / "library.so").string();
  std::ofstream(file) << std::string(5000, 'x');
  const Ended ended = runXrds({"import", "oidn", file, "-o", (folder / "networks").string()});
  expectFailure(ended, 4, "is no library of Open Image Denoise", folder, 1);
}

TEST(CliOidn, NamesTheFolderThatTakesNoModels) {
  const TemporaryFolder folder;
  const std::string file = (folder / "library.so").string();
  std::ofstream(file) << std::string(5000, 'x');
  for (const std::string& place : {file, file + "/networks"})
    expectFailure(runXrds({"import", "oidn", file, "-o", place}), 6,
                  "The models cannot be written to '" + place + "': '" + file + "' is no folder", folder, 1);
}

TEST(CliOidn, RefusesGuidesOfAnotherSize) {
  const SmallFrame frame;
  const Ended ended = runXrds({"denoise", frame.color, frame.aux, "-o", frame.out});
  expectFailure(ended, 3, "times the colour's size", frame.folder, 2);
}

}  // namespace
}  // namespace xrds::test
