// Command lines that do not fit: what was typed, what was probably meant, and where to read on.
#include "tests/cli/frames.h"

namespace xrds::test {
namespace {

struct Slip {
  std::vector<std::string> typed;
  std::string said;
};

TEST(CliUsage, NamesTheSlipAndWhatIsNearest) {
  const Slip slips[] = {
      {{"upscal", "x"}, "There is no command 'xrds upscal'; the nearest is 'upscale'; see xrds --help."},
      {{"denois", "x.exr", "-o", "y.exr"},
       "There is no command 'xrds denois'; the nearest is 'denoise'; see xrds --help."},
      {{"bench", "qualty"},
       "There is no command 'xrds bench qualty'; the nearest is 'quality'; see xrds bench --help."},
      {{"frobnicate"}, "There is no command 'xrds frobnicate'; there are upscale, advise, compare,"},
      {{"frobnicate", "--help"}, "There is no command 'xrds frobnicate'; there are upscale, advise, compare,"},
      {{"import", "frobnicate"}, "There is no command 'xrds import frobnicate'; there is oidn; see xrds import --help"},
      {{"frobnicate", "upscale"}, "There is no command 'xrds frobnicate'; there are upscale, advise, compare,"},
      {{"frobnicate", "devices", "--help"},
       "There is no command 'xrds frobnicate'; there are upscale, advise, compare,"},
      {{"bench", "qualty", "stress"}, "There is no command 'xrds bench qualty'; the nearest is 'quality';"},
      {{"bench", "qualty", "--help"},
       "There is no command 'xrds bench qualty'; the nearest is 'quality'; see xrds bench --help."},
      {{"upscale", "a.exr", "b.exr", "-o", "c.exr", "--modle", "m"},
       "xrds upscale has no option '--modle'; the nearest is '--model'; see xrds upscale --help."},
      {{"upscale", "a.exr", "--outptu=c.exr"}, "xrds upscale has no option '--outptu'; the nearest is '--output';"},
      {{"compare", "a.exr", "b.exr", "--nonsense"},
       "xrds compare has no option '--nonsense'; see xrds compare --help."},
      {{"compare", "a.exr", "b.exr", "c.exr"}, "xrds compare takes no further argument 'c.exr';"},
      {{"--vesion"}, "xrds has no option '--vesion'; the nearest is '--version'; see xrds --help."},
      {{"upscale", "a.exr"}, "--output is required; see xrds upscale --help."},
  };
  for (const auto& [typed, said] : slips) {
    const Ended ended = runXrds(typed);
    EXPECT_EQ(ended.exitCode, 2) << said;
    EXPECT_TRUE(ended.error.starts_with("xrds: " + said)) << ended.error;
  }
}

// Such as a variable of a script that is not set.
TEST(CliUsage, RefusesValuesThatAreEmptyOrNoNumber) {
  const SmallFrame frame;
  const std::string picture = frame.color;
  const Slip slips[] = {
      {frame.arguments({"--json", ""}), "--json is empty: give it a value, or leave it out."},
      {frame.arguments({"--device", ""}), "--device is empty: give it a value, or leave it out."},
      {{"info", ""}, "MODEL is empty: give it a value, or leave it out."},
      {{"compare", picture, picture, "--heat-max", "nan"},
       "--heat-max: expected a number from 1e-06 to 1, found 'nan'; see xrds compare --help."},
      {{"compare", picture, picture, "--min-psnr", "-1"},
       "--min-psnr: expected a number from 0 to 1000, found '-1'; see xrds compare --help."},
      {{"advise", picture, picture, "--within", "nan"},
       "--within: expected a number from 0.001 to 1e+09, found 'nan';"},
      {{"advise", picture, picture, "--guide-seconds", "-1"},
       "--guide-seconds: expected a number from 0 to 1e+09, found '-1';"},
      {frame.arguments({"--ensemble", "many"}), "--ensemble: many not in {1,2,4,8}; see xrds upscale --help."},
  };
  for (const auto& [typed, said] : slips) {
    const Ended ended = runXrds(typed);
    expectFailure(ended, 2, said, frame.folder, 2);
    EXPECT_TRUE(ended.error.starts_with("xrds: " + said)) << ended.error;
  }
}

// One word, one meaning: of `upscale` a layer, in both spellings; of `bench` neither.
TEST(CliUsage, ColourIsALayerAndSamplesAreSamples) {
  const SmallFrame frame;
  for (const char* spelling : {"--color", "--colour"})
    EXPECT_EQ(runXrds(frame.arguments({spelling, "RGB"})).exitCode, 0) << spelling;
  for (const char* spelling : {"--color", "--colour"})
    for (const char* verb : {"quality", "network", "skip", "tiles"}) {
      const Ended ended = runXrds({"bench", verb, spelling, "64"});
      EXPECT_EQ(ended.exitCode, 2);
      EXPECT_NE(ended.error.find(std::string("has no option '") + spelling + "'"), std::string::npos) << ended.error;
      EXPECT_NE(ended.error.find("the colour's samples a pixel are --samples"), std::string::npos) << ended.error;
    }
}

TEST(CliUsage, SaysWhereItLookedForModels) {
  const SmallFrame frame;
  const std::string elsewhere = (frame.folder / "none").string();
  const Ended ended = runXrds({"upscale", frame.color, frame.aux, "-o", frame.out, "--model", "compact"},
                              {.environment = {{"XRDS_MODELS", elsewhere}}});
  expectFailure(ended, 4, "There is no model 'compact'", frame.folder, 2);
  EXPECT_EQ(ended.error.find("none,"), std::string::npos) << ended.error;
}

}  // namespace
}  // namespace xrds::test
