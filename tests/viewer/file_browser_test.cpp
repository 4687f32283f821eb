#include "viewer/display/file_browser.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gtest/gtest.h>

#include "image/test_files.h"
#include "tests/temporary_folder.h"

namespace xrds::test {
namespace {

namespace fs = std::filesystem;

/// A folder with some files, and what was taken from it.
struct FileBrowserTest : testing::Test {
  TemporaryFolder folder;
  std::vector<std::string> taken;
  FileBrowser browser{[this](const std::vector<std::string>& files) { taken = files; }};

  void SetUp() override {
    for (const char* name : {"b.exr", "A.EXR", "c.png", ".hidden.exr"}) writeBytes(folder / name, "12");
    for (const char* name : {"renders", "Archive", ".git"}) fs::create_directory(folder / name);
    writeBytes(folder / "renders/shot.exr", "");
    browser.open();
    browser.go(folder / "");
  }
  std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const FileBrowser::Entry& entry : browser.entries()) found.push_back(entry.name);
    return found;
  }
  void press(std::initializer_list<int> keys) {
    for (const int key : keys) browser.pressKey(key, 0);
  }
};

TEST_F(FileBrowserTest, ListsFoldersThenImages) {
  EXPECT_EQ(names(), (std::vector<std::string>{"Archive", "renders", "A.EXR", "b.exr"}));
  EXPECT_EQ(browser.entries()[2].byteSize, 2u);
  EXPECT_TRUE(browser.failure().empty());
}

TEST_F(FileBrowserTest, IsWalkedByKeys) {
  press({GLFW_KEY_R, GLFW_KEY_ENTER});
  EXPECT_EQ(names(), (std::vector<std::string>{"shot.exr"}));
  press({GLFW_KEY_BACKSPACE});
  EXPECT_EQ(browser.entries()[browser.cursor()].name, "renders") << "where one came from";
  press({GLFW_KEY_END, GLFW_KEY_DOWN, GLFW_KEY_ENTER});
  EXPECT_FALSE(browser.isOpen());
  EXPECT_EQ(taken, (std::vector<std::string>{folder / "b.exr"}));
}

TEST_F(FileBrowserTest, TakesSeveralFiles) {
  press({GLFW_KEY_A, GLFW_KEY_SPACE, GLFW_KEY_SPACE, GLFW_KEY_HOME, GLFW_KEY_SPACE, GLFW_KEY_ENTER});
  EXPECT_EQ(taken, (std::vector<std::string>{folder / "A.EXR", folder / "b.exr"})) << "and no folder";
}

TEST_F(FileBrowserTest, TakesAFolderToWatchAndNothingWhenItIsClosed) {
  browser.pressKey(GLFW_KEY_ESCAPE, 0);
  EXPECT_FALSE(browser.isOpen());
  EXPECT_TRUE(taken.empty());
  browser.open();
  browser.pressKey(GLFW_KEY_ENTER, GLFW_MOD_CONTROL);
  EXPECT_EQ(taken, (std::vector<std::string>{browser.folder().string()}));
}

TEST_F(FileBrowserTest, GoesWhereItIsTold) {
  browser.go("renders/");
  EXPECT_EQ(browser.folder().filename(), "renders");
  browser.go(folder / "none");
  EXPECT_FALSE(browser.failure().empty());
  EXPECT_TRUE(browser.entries().empty());
  browser.pressKey(GLFW_KEY_ENTER, 0);  // on nothing
  EXPECT_TRUE(browser.isOpen());
  browser.go(folder / "b.exr");
  EXPECT_EQ(taken, (std::vector<std::string>{folder / "b.exr"}));
  browser.go("/");
  browser.goUp();
  EXPECT_EQ(browser.folder(), "/");
}

}  // namespace
}  // namespace xrds::test
