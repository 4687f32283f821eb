// compare, and the help.
#include <cmath>

#include "tests/cli/frames.h"

namespace xrds::test {
namespace {

TEST(CliCompare, PrintsEveryMetricAndJudges) {
  const SmallFrame frame;
  const Ended same = runXrds({"compare", frame.color, frame.color, "--min-psnr", "40"});
  EXPECT_EQ(same.exitCode, 0) << same.error;
  for (const char* name : {"PSNR", "RelMSE", "RelMSE trimmed", "RelMSE median", "FLIP"})
    EXPECT_TRUE(contains(same.output, name)) << name;
  const std::string other = (frame.folder / "other.exr").string(), map = (frame.folder / "map.png").string();
  const Layer colour = colourLayer("", 10);
  writeParts(other, {{boxOf(10, 8), boxOf(10, 8), {{"beauty", "RGB", [&](int x, int y, int c) {
                                                      return 0.8F * colour.pixels(x, y, c);
                                                    }}}}});
  EXPECT_EQ(runXrds({"compare", other, frame.color, "--heat-map", map, "--layer", "beauty", "--reference-layer", "RGB"})
                .exitCode,
            0);
  EXPECT_TRUE(readBytes(map).starts_with("\x89PNG"));
  expectFailure(runXrds({"compare", other, frame.color, "--min-psnr", "60"}), 7, "below 60", frame.folder, 4);
}

TEST(CliCompare, ComparesNormalsByTheirName) {
  const SmallFrame frame;
  const std::string normals = (frame.folder / "normals.exr").string();
  const auto slopes = [](int x, int y, int c) { return 0.1F * static_cast<float>(x - y + c); };
  writeParts(normals, {{boxOf(10, 8), boxOf(10, 8), {colourLayer("", 10), {"Normal", "XYZ", slopes}}}});
  EXPECT_EQ(runXrds({"compare", normals, normals, "--layer", "Normal", "--min-psnr", "90"}).exitCode, 0);
  EXPECT_EQ(runXrds({"compare", normals, normals, "--reference-layer", "Normal", "--min-psnr", "90"}).exitCode, 7);
  expectFailure(runXrds({"compare", normals, normals, "--layer", "Norm"}), 3, "expected a layer 'Norm'", frame.folder,
                3);
  writeParts(normals, {{boxOf(10, 8), boxOf(10, 8), {{"A.Normal", "XYZ", slopes}, {"B.Normal", "XYZ", slopes}}}});
  EXPECT_EQ(runXrds({"compare", normals, normals, "--layer", "B.Normal", "--min-psnr", "90"}).exitCode, 0);
  expectFailure(runXrds({"compare", normals, normals, "--layer", "Normal"}), 3, "found 0:A.Normal, 0:B.Normal",
                frame.folder, 3);
}

TEST(CliCompare, RefusesWhatCannotBeCompared) {
  const SmallFrame frame;
  expectFailure(runXrds({"compare", frame.color, frame.aux, "--reference-layer", "albedo"}), 3, "different sizes",
                frame.folder, 2);
  expectFailure(runXrds({"compare", frame.color, (frame.folder / "none.exr").string()}), 3, "no such file",
                frame.folder, 2);
  expectFailure(runXrds({"compare", frame.color, frame.color, "--heat-map", "/proc/map.png"}), 6, "takes no new files",
                frame.folder, 2);
  expectFailure(runXrds({"compare", frame.color, frame.color, "--heat-max", "-1"}), 2, "--heat-max", frame.folder, 2);
  writeParts(frame.color, {{boxOf(10, 8), boxOf(10, 8), {{"", "RGB", [](int, int, int) { return std::nanf(""); }}}}});
  expectFailure(runXrds({"compare", frame.color, frame.color}), 3, "finite", frame.folder, 2);
}

TEST(CliHelp, NamesVerbsAndExitCodes) {
  const Ended ended = runXrds({"--help"});
  EXPECT_EQ(ended.exitCode, 0);
  for (const char* word : {"upscale", "compare", "info", "devices", "Exit codes", "130"})
    EXPECT_TRUE(contains(ended.output, word)) << word;
  EXPECT_TRUE(contains(runXrds({"--version"}).output, "xrds 0."));
}

}  // namespace
}  // namespace xrds::test
