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

class CliGolden : public testing::TestWithParam<const char*> {};

TEST_P(CliGolden, MatchesPyTorch) {
  const TemporaryFolder folder;
  const TensorFile golden = readTensors(std::string(XRDS_GOLDEN_FOLDER "/") + GetParam() + ".io.safetensors");
  const auto layer = [&](const char* tensor, const char* name) {
    const StoredTensor& image = golden.tensors.at(tensor);
    const int height = static_cast<int>(image.shape[0]), width = static_cast<int>(image.shape[1]);
    return Part{boxOf(width, height), boxOf(width, height), {layerOf(name, image.values, width)}};
  };
  const std::string colour = (folder / "colour.exr").string(), aux = (folder / "aux.exr").string(),
                    out = (folder / "out.exr").string();
  writeParts(colour, {layer("colour", "")});
  std::vector<std::string> arguments{"upscale", colour};
  if (golden.tensors.contains("albedo")) {
    Part part = layer("albedo", "albedo");
    if (golden.tensors.contains("normal")) part.layers.push_back(layer("normal", "normal").layers.front());
    writeParts(aux, {part});
    arguments.push_back(aux);
  }
  for (const auto& [precision, tolerance] : {std::pair{"fp32", 1e-4}, std::pair{"fp16", 5e-3}}) {
    std::vector<std::string> all = arguments;
    for (const std::string& word : {std::string("-o"), out, std::string("--model"), goldenModel(GetParam()),
                                    std::string("--precision"), std::string(precision)})
      all.push_back(word);
    const Ended ended = runXrds(all);
    ASSERT_EQ(ended.exitCode, 0) << ended.error;
    EXPECT_LT(
        differenceOf(readColour(out), golden.tensors.at("output").values, golden.tensors.at("exposure").values[0]),
        tolerance)
        << precision;
  }
}

INSTANTIATE_TEST_SUITE_P(Some, CliGolden, testing::Values("s4_guided", "s4_none_noaux"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace xrds::test
