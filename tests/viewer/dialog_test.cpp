// The dialog that opens files.
#include "tests/cli/frames.h"
#include "tests/viewer/viewer_display.h"

namespace xrds::test {
namespace {

TEST_F(ViewerDisplay, OpensFilesChosenByKeys) {
  std::filesystem::create_directory(folder / "renders");
  copy(kColour, "renders/lr.exr");
  copy(kAuxiliary, "renders/aux.exr");
  const Ended ended =
      run("wait\nprint\nkey Ctrl+O\nwait\nscreenshot dialog.png\nkey Enter\nkey Space\nkey Space\nkey Enter\nawait 1\n"
          "wait\nprint\n",
          smallDisplay({}));
  EXPECT_TRUE(has(ended.output, "pictures=0")) << ended.output;
  EXPECT_TRUE(has(ended.output, "pictures=1 files=lr.exr")) << ended.output;
  EXPECT_EQ(readPng(folder / "dialog.png").width, 400);
}

TEST_F(ViewerDisplay, OpensFilesChosenByMouse) {
  copy(kColour, "lr.exr");
  // The folder holds only the display's configuration before: the file is the last row.
  const Ended ended = run("key Ctrl+O\nkey End\nwait\nmove 30 319\nwait\npress\nwait\nrelease\nawait 1\nwait\nprint\n",
                          {"--size", "400x340", "--model", goldenModel("s1_none_noaux")});
  EXPECT_TRUE(has(ended.output, "pictures=1 files=lr.exr")) << ended.output;
}

TEST_F(ViewerDisplay, KeysGoToTheDialogAloneWhileItIsOpen) {
  const Ended ended = run("key Ctrl+O\nkey C\nkey Escape\nwait\nprint\n", smallDisplay({kColour, kAuxiliary}));
  EXPECT_TRUE(has(ended.output, "precision=fp32")) << ended.output;
}

}  // namespace
}  // namespace xrds::test
