// The command on the golden frames, written as OpenEXR, against what PyTorch made of them.
#include <cmath>

#include "network/safetensors.h"
#include "tests/cli/frames.h"

namespace xrds::test {
namespace {

double differenceOf(const Image& found, const std::vector<float>& expected, float exposure) {
  double difference = 0, power = 0;
  for (size_t i = 0; i < expected.size(); ++i) {
    const double x = std::log1p(std::max(0.F, found.pixels[i] * exposure)),
                 y = std::log1p(std::max(0.F, expected[i] * exposure));
    difference += (x - y) * (x - y);
    power += y * y;
  }
  return std::sqrt(difference / power);
}

/// What PyTorch made of a frame, and the frame written as OpenEXR.
struct GoldenFrame {
  explicit GoldenFrame(const std::string& model)
      : golden(readTensors(std::string(XRDS_GOLDEN_FOLDER "/") + model + ".io.safetensors")),
        arguments{"upscale", colour, "-o", out, "--model", goldenModel(model), "--precision"} {
    writeParts(colour, {part("colour", "")});
    if (!golden.tensors.contains("albedo")) return;
    Part guides = part("albedo", "albedo");
    if (golden.tensors.contains("normal")) guides.layers.push_back(part("normal", "normal").layers.front());
    writeParts(aux, {guides});
    arguments.insert(arguments.begin() + 2, aux);
  }

  /// The picture, which must be within the tolerance of PyTorch's.
  Image expectGolden(const std::string& precision, double tolerance, const StartOptions& options = {}) const {
    std::vector<std::string> all = arguments;
    all.push_back(precision);
    const Ended ended = runXrds(all, options);
    EXPECT_EQ(ended.exitCode, 0) << ended.error;
    if (ended.exitCode != 0) return {};
    Image found = readColour(out);
    EXPECT_LT(differenceOf(found, golden.tensors.at("output").values, golden.tensors.at("exposure").values[0]),
              tolerance)
        << precision;
    return found;
  }

  TemporaryFolder folder;
  std::string colour = (folder / "colour.exr").string(), aux = (folder / "aux.exr").string(),
              out = (folder / "out.exr").string();
  TensorFile golden;
  std::vector<std::string> arguments;

 private:
  Part part(const char* tensor, const char* name) const {
    const StoredTensor& image = golden.tensors.at(tensor);
    const int height = static_cast<int>(image.shape[0]), width = static_cast<int>(image.shape[1]);
    return {boxOf(width, height), boxOf(width, height), {layerOf(name, image.values, width)}};
  }
};

class CliGoldens : public testing::TestWithParam<const char*> {};

TEST_P(CliGoldens, MatchesPyTorch) {
  const GoldenFrame frame(GetParam());
  for (const auto& [precision, tolerance] : {std::pair{"fp32", 1e-4}, std::pair{"fp16", 5e-3}})
    frame.expectGolden(precision, tolerance);
}

INSTANTIATE_TEST_SUITE_P(Some, CliGoldens, testing::Values("s4_guided", "s4_none_noaux"),
                         [](const auto& info) { return std::string(info.param); });

// Vectors of 128, 256 and 512 bits give lavapipe subgroups of 4, 8 and 16.
TEST(CliGolden, MatchesPyTorchInSubgroupsOfEverySize) {
  if (runXrds({"devices"}).output.find("llvmpipe") == std::string::npos) GTEST_SKIP() << "There is no lavapipe.";
  const GoldenFrame frame("s4_guided");
  std::vector<Image> pictures;
  for (const std::string width : {"128", "256", "512"}) {
    SCOPED_TRACE(width + " bits");
    const StartOptions options{.environment = {{"LP_NATIVE_VECTOR_WIDTH", width}}};
    ASSERT_NE(runXrds({"devices"}, options).output.find(width + " bits"), std::string::npos);
    pictures.push_back(frame.expectGolden("fp32", 1e-4, options));
    frame.expectGolden("fp16", 5e-3, options);
  }
  EXPECT_EQ(pictures[1], pictures[2]);
}

}  // namespace
}  // namespace xrds::test
