// What the panel and the labels say, on displays of all sizes.
#include <sstream>

#include "tests/viewer/viewer_display.h"

namespace xrds::test {
namespace {

/// Red, green and blue of the row `name` in what `print` printed.
std::vector<double> rowOf(const std::string& text, const std::string& name) {
  std::smatch found;
  std::vector<double> values;
  if (!std::regex_search(text, found, std::regex(" " + name + "@[0-9]+,[0-9]+=([-+.0-9e]+),([-+.0-9e]+),([-+.0-9e]+)")))
    return values;
  for (size_t i = 1; i <= 3; ++i) values.push_back(std::stod(found[i]));
  return values;
}

TEST_F(ViewerDisplay, TellsTheErrorsOfAPixelInTheErrorView) {
  const Ended ended =
      run("key P\nkey Shift+1\nkey 7\nmove 110 140\nwait\nprint\n", smallDisplay({kColour, kAuxiliary, kReference}));
  const auto output = rowOf(ended.output, "xrds"), expected = rowOf(ended.output, "reference"),
             error = rowOf(ended.output, "error");
  ASSERT_EQ(output.size(), 3u) << ended.output;
  ASSERT_EQ(expected.size(), 3u) << ended.output;
  ASSERT_EQ(error.size(), 3u) << ended.output;
  for (size_t c = 0; c < 3; ++c) {
    const double difference = output[c] - expected[c];
    EXPECT_NEAR(error[c], difference * difference / (expected[c] * expected[c] + 0.01), 1e-3 + 0.02 * error[c]);
  }
}

TEST_F(ViewerDisplay, TellsTimesThatAddUp) {
  const Ended ended = run("wait\ntimes\n", smallDisplay({kColour, kAuxiliary}));
  std::istringstream words(ended.output.substr(ended.output.find("times ") + 6));
  double steps = 0, parts = 0, network = 0, total = 0;
  for (std::string word; words >> word;) {
    const double value = std::stod(word.substr(word.find('=') + 1));
    if (word.starts_with("total="))
      total = value;
    else
      (word.starts_with("part-") ? parts : steps) += value;
    if (word.starts_with("network=")) network = value;
  }
  EXPECT_GT(total, 0) << ended.output;
  EXPECT_NEAR(steps, total, 0.01) << ended.output;
  EXPECT_NEAR(parts, network, 0.01) << ended.output;
  EXPECT_TRUE(has(ended.output, " read-files=")) << ended.output;
}

TEST_F(ViewerDisplay, FoldsThePanelInSmallWindows) {
  // Unfolded by a click on its button, folded again, and hidden.
  run("wait\nscreenshot folded.png\nmove 290 18\nwait\npress\nwait\nrelease\nwait\nmove 20 200\nwait\n"
      "screenshot unfolded.png\nkey P\nwait\nscreenshot hidden.png\nwait\n",
      {kColour, kAuxiliary, "--model", "xrds-x4-nano", "--size", "320x240"});
  const Image folded = readPng(folder / "folded.png"), unfolded = readPng(folder / "unfolded.png"),
              hidden = readPng(folder / "hidden.png");
  const auto rest = [](const Image& shot) { return cropped(shot, 0, 40, 320, 200); };
  EXPECT_EQ(meanDifference(rest(folded), rest(hidden)), 0) << "the picture has the whole display";
  EXPECT_GT(meanDifference(cropped(folded, 260, 0, 60, 30), cropped(hidden, 260, 0, 60, 30)), 1) << "but for a button";
  EXPECT_GT(meanDifference(cropped(unfolded, 60, 40, 240, 160), cropped(hidden, 60, 40, 240, 160)), 10);
}

TEST_F(ViewerDisplay, LaysOutSmallWindowsAsItDid) {
  const std::string name = "a_shot_of_the_outdoor_scene_with_a_name_that_is_far_too_long_for_any_panel.0001.exr";
  copy(kColour, name);
  for (const auto& [size, file] : {std::pair{"320x240", "small_320.png"}, {"480x300", "small_480.png"}}) {
    run(std::string("key Shift+7\nkey 0\nwait\nscreenshot ") + file + "\nwait\n",
        {name, kAuxiliary, kReference, "--model", "xrds-x4-nano", "--size", size});
    expectLikeStored(folder / file);
  }
}

}  // namespace
}  // namespace xrds::test
