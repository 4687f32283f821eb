#include "sequence/file_pattern.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/temporary_folder.h"
#include "xrds/error.h"
#include "xrds/path_text.h"

namespace xrds {
namespace {

namespace fs = std::filesystem;

class FilePatterns : public testing::Test {
 protected:
  void touch(const char* name) const { std::ofstream(folder_ / name) << "x"; }
  std::string at(const char* name) const { return (folder_ / name).string(); }

  const test::TemporaryFolder folder_;
};

TEST_F(FilePatterns, FieldsOfDigits) {
  EXPECT_EQ(FilePattern("a/b.####.exr").of(7), "a/b.0007.exr");
  EXPECT_EQ(FilePattern("a/b.####.exr").of(12345), "a/b.12345.exr");
  EXPECT_EQ(FilePattern("a/b.####.exr").of(-7), "a/b.-0007.exr");
  EXPECT_EQ(FilePattern("a/b.%04d.exr").of(-7), "a/b.-007.exr");
  EXPECT_EQ(FilePattern("b%05d.exr").of(7), "b00007.exr");
  EXPECT_EQ(FilePattern("b%d.exr").of(7), "b7.exr");
  EXPECT_EQ(FilePattern("b.exr").of(7), "b.exr");
  EXPECT_FALSE(FilePattern("b.exr").isMany());
  EXPECT_EQ(FilePattern("a/b.##.exr").in("c").of(3), "c/b.03.exr");
  for (const char* text : {"a##_##.exr", "a%04d#.exr", "a%099d.exr", "a%099999999999d.exr"})
    EXPECT_THROW(FilePattern{text}, Error) << text;
}

TEST_F(FilePatterns, AreToldAsTheyWereGiven) {
  for (const char* text : {"a/b.%04d.exr", "b%d.exr", "a/b.####.exr", "b.exr"})
    EXPECT_EQ(fs::path(FilePattern(text).text()), fs::path(text));  // whatever separates folders
  EXPECT_EQ(fs::path(FilePattern("a/b.%d.exr").in("c").text()), fs::path("c/b.%d.exr"));
}

TEST_F(FilePatterns, AFileOfThatVeryNameIsOneFile) {
  touch("a#.exr");
  EXPECT_FALSE(FilePattern::mayBeMany(at("a#.exr")));
  EXPECT_EQ(FilePattern(at("a#.exr")).of(7), at("a#.exr"));
  EXPECT_TRUE(FilePattern::mayBeMany(at("b#.exr")));
}

TEST_F(FilePatterns, FramesThatAreThere) {
  for (const char* name : {"b.0003.exr", "b.0001.exr", "b.12345.exr", "b.-0002.exr", "b.-002.exr", "b.00004.exr",
                           "b.05.exr", "b.x.exr", "c.0001.exr", "b.0006.png", "b.exr"})
    touch(name);
  EXPECT_EQ(FilePattern(at("b.####.exr")).frames(), (std::vector<int>{-2, 1, 3, 12345}));
  EXPECT_EQ(FilePattern(at("b.%02d.exr")).frames(), (std::vector<int>{5, 12345}));
  EXPECT_EQ(FilePattern(at("d.####.exr")).frames(), std::vector<int>{});
  EXPECT_THROW(FilePattern("/nowhere/d.####.exr").frames(), Error);
}

// Also where paths are not stored as UTF-8.
TEST_F(FilePatterns, NamesHaveAnyLetters) {
  const fs::path folder = folder_.path() / u8"Größe";
  const std::string text = folder_.path().string() + "/Größe";
  fs::create_directory(folder);
  for (const char8_t* name : {u8"日本.0001.exr", u8"日本.0003.exr", u8"Übung#.exr"})
    std::ofstream(folder / name) << "x";
  const FilePattern pattern(text + "/日本.####.exr");
  EXPECT_EQ(pattern.frames(), (std::vector<int>{1, 3}));
  EXPECT_EQ(pattern.of(2), folder / u8"日本.0002.exr");
  EXPECT_EQ(pathOf(pattern.text()), folder / u8"日本.####.exr");
  EXPECT_EQ(FilePattern(text).of(12), folder / u8"日本.0012.exr");
  EXPECT_FALSE(FilePattern::mayBeMany(text + "/Übung#.exr"));
}

TEST_F(FilePatterns, AFolderOfOneSeries) {
  for (const char* name : {"v2_b.0098.exr", "v2_b.0099.exr", "v2_b.0100.exr", "notes.txt", "cover.exr"}) touch(name);
  const FilePattern pattern(folder_.path().string());
  EXPECT_EQ(pattern.text(), at("v2_b.####.exr"));
  EXPECT_EQ(pattern.frames(), (std::vector<int>{98, 99, 100}));
  touch("v2_b.-0002.exr");
  EXPECT_EQ(FilePattern(folder_.path().string()).frames(), (std::vector<int>{-2, 98, 99, 100}));
  touch("v2_c.0001.exr");
  EXPECT_THROW(FilePattern{folder_.path().string()}, Error);
}

}  // namespace
}  // namespace xrds
