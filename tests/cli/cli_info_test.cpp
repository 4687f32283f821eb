// info and devices: what a model costs and what there is to run it on.
#include <nlohmann/json.hpp>

#include "network/network_model.h"
#include "tests/cli/frames.h"
#include "tests/print_case.h"

namespace xrds::test {
namespace {

using Json = nlohmann::json;

// The number behind the name of a row.
double numberOf(const std::string& output, const std::string& row) {
  const size_t at = output.find("\n" + row + " ");
  return at == std::string::npos ? -1 : std::stod(output.substr(at + row.size() + 1));
}

// What `info --json` writes.
Json infoJson(const std::vector<std::string>& arguments, Ended* ended = nullptr) {
  const TemporaryFolder folder;
  const std::string file = (folder / "info.json").string();
  std::vector<std::string> all{"info"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  all.insert(all.end(), {"--json", file});
  const Ended run = runXrds(all);
  if (ended) *ended = run;
  EXPECT_EQ(run.exitCode, 0) << run.error;
  return Json::parse(readBytes(file));
}

TEST(CliInfo, DescribesAModelAndListsTheShippedOnes) {
  const Ended ended = runXrds({"info", goldenModel("s4_guided"), "--size", "64x32"});
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  for (const char* word : {"albedo,normal", "hash", "MACs of the network", "MACs executed", "planned peak", "64 x 32"})
    EXPECT_TRUE(contains(ended.output, word)) << word;
  EXPECT_TRUE(contains(runXrds({"info"}).output, "xrds-x4-compact"));
}

TEST(CliInfo, FindsModelsInTheFolderOfTheEnvironment) {
  const TemporaryFolder folder;
  writeBytes(folder / "mine.safetensors", readBytes(goldenModel("s4_guided")));
  const StartOptions options{.environment = {{"XRDS_MODELS", (folder / "").string()}}};
  EXPECT_EQ(runXrds({"info", "mine"}, options).exitCode, 0);
  EXPECT_TRUE(contains(runXrds({"info"}, options).output, "mine\n"));
}

TEST(CliInfo, ListsTheLayersOfAnExrFile) {
  const SmallFrame frame;
  const Ended ended = runXrds({"info", frame.aux});
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  for (const char* line :
       {"part 0, 40 x 32", "\ncolour                     none", "\nalbedo                     albedo",
        "\nnormal                     normal", "\ndepth                      none"})
    EXPECT_TRUE(contains(ended.output, line)) << line << "\nin\n" << ended.output;
  const Ended ofColour = runXrds({"info", frame.color});
  EXPECT_TRUE(contains(ofColour.output, "\ncolour                     (unnamed)")) << ofColour.output;
  EXPECT_TRUE(contains(ofColour.output, "\nsamples a pixel            not in the file")) << ofColour.output;
  expectFailure(runXrds({"info", frame.color, "--size", "64x64"}), 2, "--size", frame.folder, 2);
  expectFailure(runXrds({"info", (frame.folder / "none.EXR").string()}), 3, "there is no such file", frame.folder, 2);
}

using test::PrintTo;

/// A row of the paper's Tables 9 and 10.
struct PaperRow {
  uint32_t groups = 0, blocks = 0;
  std::string gigaMultiplyAdds;
};

class CliInfoOfThePaper : public testing::TestWithParam<PaperRow> {};

TEST_P(CliInfoOfThePaper, PrintsItsCount) {
  const TemporaryFolder folder;
  const auto file = folder / "paper.safetensors";
  const NetworkModel model =
      NetworkModel::random({.groups = GetParam().groups, .blocks = GetParam().blocks, .base = BaseImage::none}, 1);
  writeTensors(file, model.file(), DataType::f16);
  Ended ended;
  const Json json = infoJson({file.string(), "--kernels", "lane"}, &ended);
  EXPECT_TRUE(contains(ended.output, "MACs of the network        " + GetParam().gigaMultiplyAdds + " G"))
      << ended.output;
  EXPECT_NEAR(json["networkMultiplyAdds"].get<double>() / 1e9, std::stod(GetParam().gigaMultiplyAdds), 0.005);
  // Joined maps are less work, the token pairs of attention more.
  const Json& fp32 = json["precisions"][0];
  EXPECT_LT(fp32["multiplyAdds"].get<uint64_t>(), json["networkMultiplyAdds"].get<uint64_t>());
  EXPECT_GT(fp32["attentionMultiplyAdds"].get<uint64_t>(), 0u);
  EXPECT_NEAR(numberOf(ended.output, "MACs executed"),
              (fp32["multiplyAdds"].get<double>() + fp32["attentionMultiplyAdds"].get<double>()) / 1e9, 0.005);
}

INSTANTIATE_TEST_SUITE_P(Tables, CliInfoOfThePaper,
                         testing::Values(PaperRow{3, 5, "723.68"}, PaperRow{3, 3, "519.13"}, PaperRow{3, 1, "314.59"},
                                         PaperRow{2, 5, "507.86"}, PaperRow{1, 5, "292.04"}),
                         [](const auto& info) {
                           return std::to_string(info.param.groups) + "x" + std::to_string(info.param.blocks);
                         });

TEST(CliInfo, CostsTheFrameThatUpscaleRuns) {
  const SmallFrame frame;
  const Json json = infoJson({"xrds-x4-nano", "--size", "40x32", "--memory", "1G"});
  for (const std::string precision : {"fp32", "fp16"}) {
    const Json& cost = json["precisions"][precision == "fp32" ? 0 : 1];
    ASSERT_EQ(cost["precision"], precision);
    const Ended run = runXrds(frame.arguments({"--precision", precision}, "xrds-x4-nano"));
    ASSERT_EQ(run.exitCode, 0) << run.error;
    const size_t end = run.output.find(" MB of device memory"), begin = run.output.rfind(' ', end - 1);
    ASSERT_NE(end, std::string::npos) << run.output;
    const double bytes = cost["memory"]["plannedBytes"].get<double>() + cost["memory"]["weightBytes"].get<double>();
    EXPECT_NEAR(std::stod(run.output.substr(begin)), bytes / 1e6, 0.1);
    // What fits in one piece is the same plan.
    EXPECT_EQ(cost["tiling"]["columns"].get<int>() * cost["tiling"]["rows"].get<int>(), 1);
    EXPECT_EQ(cost["tiling"]["weightBytes"], cost["memory"]["weightBytes"]);
    EXPECT_NEAR(cost["tiling"]["arenaBytes"].get<double>(), cost["memory"]["plannedBytes"].get<double>(), 255);
  }
}

// Tiles of xrds denoise give the picture of the whole frame.
TEST(CliInfo, TilesOfADenoiserAreExact) {
  const std::string denoiser = XRDS_GOLDEN_FOLDER "/unet/hdr_albedo_base.model.safetensors";
  const auto tiled = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{denoiser, "--size", "1024x1024", "--memory", "60M"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return infoJson(arguments)["precisions"][0]["tiling"];
  };
  const Json tiling = tiled({});
  EXPECT_GT(tiling["columns"].get<int>() * tiling["rows"].get<int>(), 1);
  EXPECT_EQ(tiling, tiled({"--tiles", "exact"}));
}

TEST(CliInfo, WritesEveryNumber) {
  const Json json = infoJson({"xrds-x4-nano", "--size", "512x256", "--kernels", "tile"});
  EXPECT_EQ(json["model"], "xrds-x4-nano");
  EXPECT_EQ(json["metadata"]["scale"], "4");
  EXPECT_EQ(json["modelHash"].get<std::string>().size(), 16u);
  EXPECT_EQ(json["width"], 512);
  EXPECT_EQ(json["height"], 256);
  EXPECT_EQ(json["kernelFamily"], "tile");
  EXPECT_GT(json["parameters"].get<uint64_t>(), 10'000u);
  ASSERT_EQ(json["precisions"].size(), 2u);
  for (const Json& precision : json["precisions"]) {
    const Json& memory = precision["memory"];
    EXPECT_LE(memory["lowerBoundBytes"].get<uint64_t>(), memory["plannedBytes"].get<uint64_t>());
    EXPECT_LT(memory["plannedBytes"].get<uint64_t>(), memory["unaliasedBytes"].get<uint64_t>());
    EXPECT_FALSE(precision.contains("tiling"));  // no memory was given
  }
  const Json listed = infoJson({});
  EXPECT_GE(listed["models"].size(), 9u);
}

TEST(CliInfo, RefusesWhatItCannotAnswer) {
  const TemporaryFolder folder;
  expectFailure(runXrds({"info", "xrds-x4-nano", "--kernels", "foo"}), 2, "--kernels", folder, 0);
  expectFailure(runXrds({"info", "xrds-x4-nano", "--json", (folder / "a.txt").string()}), 2, ".json", folder, 0);
  expectFailure(runXrds({"devices", "--json", (folder / "no" / "a.json").string()}), 6, "a.json", folder, 0);
}

TEST(CliDevices, ListsWhatTheOptionTakes) {
  const TemporaryFolder folder;
  const std::string file = (folder / "devices.json").string();
  const Ended ended = runXrds({"devices", "--json", file});
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_TRUE(ended.output.starts_with("0  ")) << ended.output;
  const Json json = Json::parse(readBytes(file));
  ASSERT_FALSE(json["devices"].empty());
  const Json& first = json["devices"][0];
  EXPECT_EQ(first["index"], 0);
  EXPECT_GT(first["memoryBytes"].get<uint64_t>(), 0u);
  for (const char* key : {"name", "kind", "uuid", "driver", "apiVersion", "kernelFamily"})
    EXPECT_TRUE(contains(ended.output, first[key].get<std::string>())) << key;
}

TEST(CliDevices, NameTheKernelsThatWouldRun) {
  EXPECT_TRUE(
      contains(runXrds({"devices"}, {.environment = {{"XRDS_KERNEL_FAMILY", "plain"}}}).output, "kernels plain\n"));
}

TEST(CliKernelFamily, OfNoSuchNameIsAUsageErrorEverywhere) {
  const SmallFrame frame;
  const StartOptions wrong{.environment = {{"XRDS_KERNEL_FAMILY", "foo"}}};
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           frame.arguments(), {"devices"}, {"doctor"}, {"info"}, {"bench", "stress", "--short"}}) {
    const Ended ended = runXrds(arguments, wrong);
    expectFailure(ended, 2, "XRDS_KERNEL_FAMILY is 'foo'", frame.folder, 2);
    EXPECT_TRUE(contains(ended.error, "plain, lane, tile, matrix, fused")) << ended.error;
  }
  EXPECT_EQ(runXrds({"--help"}, wrong).exitCode, 0);
}

}  // namespace
}  // namespace xrds::test
