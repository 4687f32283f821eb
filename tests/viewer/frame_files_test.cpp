#include "viewer/frame_files.h"

#include <gtest/gtest.h>

#include "image/test_files.h"
#include "tests/temporary_folder.h"
#include "xrds/error.h"

namespace xrds::test {
namespace {

namespace fs = std::filesystem;
const fs::path kSamples = XRDS_SAMPLE_FOLDER;
const FrameFiles kOutdoor{kSamples / "outdoor_lr64.exr", kSamples / "outdoor_aux16.exr", kSamples / "outdoor_gt.exr"};

TEST(FrameFiles, AreToldApartInAnyOrder) {
  const std::vector<fs::path> files{kOutdoor.colour, kOutdoor.auxiliary, kOutdoor.reference};
  EXPECT_EQ(sortFiles(files), kOutdoor);
  EXPECT_EQ(sortFiles({files[2], files[0], files[1]}), kOutdoor);
  EXPECT_EQ(sortFiles({files[1], files[2], files[0]}), kOutdoor);
  EXPECT_EQ(sortFiles({files[0], files[2]}), (FrameFiles{kOutdoor.colour, {}, kOutdoor.reference}));
  EXPECT_THROW(sortFiles({}), Error);
  EXPECT_THROW(sortFiles({kSamples / "none.exr"}), Error);
}

TEST(FrameFiles, LoadAsOneFrame) {
  const LoadedFrame frame = loadFrame(kOutdoor, {});
  EXPECT_EQ(frame.colour.width, 80);
  EXPECT_EQ(frame.scale, 4);
  EXPECT_EQ(frame.inputs, (std::vector<std::string>{"albedo", "normal"}));
  ASSERT_EQ(frame.auxiliary.size(), 2u);
  EXPECT_EQ(frame.auxiliary[1].width, 320);
  ASSERT_TRUE(frame.reference);
  EXPECT_EQ(frame.reference->height, 240);
  EXPECT_EQ(frame.output.dataWindow.width(), 320);
}

TEST(FrameFiles, LoadWithoutAuxiliaryImages) {
  const LoadedFrame frame = loadFrame({kOutdoor.colour, {}, {}}, {});
  EXPECT_TRUE(frame.inputs.empty());
  EXPECT_EQ(frame.scale, 0);
  EXPECT_THROW(loadFrame({kOutdoor.colour, {}, kSamples / "glossy_gt.exr"}, {}), Error);  // 6.4 times as wide
}

TEST(FrameFiles, NameTheSizeThatAReferenceMustHave) {
  const auto refusalOf = [](const FrameFiles& files) -> std::string {
    try {
      static_cast<void>(loadFrame(files, {}));
    } catch (const Error& refusal) {
      return refusal.what();
    }
    return "";
  };
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "has 80 x 60 pixels, not 320 x 240 as the result has.",
                      refusalOf({kOutdoor.colour, kOutdoor.auxiliary, kOutdoor.colour}));
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "not a multiple of the colour's 80 x 60.",
                      refusalOf({kOutdoor.colour, {}, kSamples / "glossy_gt.exr"}));
}

TEST(FrameFiles, OfAFolderAreTheNewest) {
  const TemporaryFolder folder;
  EXPECT_THROW(newestFrame(folder / ""), Error);
  const auto put = [&](const fs::path& from, const char* name, int seconds) {
    fs::copy_file(from, folder / name);
    fs::last_write_time(folder / name, fs::file_time_type::clock::now() + std::chrono::seconds(seconds));
  };
  put(kOutdoor.colour, "z.exr", -50);
  put(kOutdoor.auxiliary, "aux.exr", -40);
  put(kOutdoor.colour, "a.exr", -30);
  EXPECT_EQ(newestFrame(folder / ""), (FrameFiles{folder / "a.exr", folder / "aux.exr", {}}));
  put(kOutdoor.colour, "m.exr", -20);
  EXPECT_EQ(newestFrame(folder / "").colour, folder / "m.exr");
}

TEST(FrameFiles, OfAFolderMayBeInUpperCaseAndBesideDamagedOnes) {
  const TemporaryFolder folder;
  fs::copy_file(kOutdoor.colour, folder / "C.EXR");
  fs::copy_file(kOutdoor.auxiliary, folder / "A.EXR");
  writeBytes(folder / "old.exr", "half");
  fs::last_write_time(folder / "old.exr", fs::file_time_type::clock::now() - std::chrono::hours(1));
  EXPECT_EQ(newestFrame(folder / ""), (FrameFiles{folder / "C.EXR", folder / "A.EXR", {}}));
  fs::last_write_time(folder / "old.exr", fs::file_time_type::clock::now() + std::chrono::hours(1));
  EXPECT_THROW(newestFrame(folder / ""), Error);  // it may still be written
}

TEST(Sequence, IsOrderedByNumber) {
  const TemporaryFolder folder;
  for (const char* name : {"a.0010.exr", "a.0009.exr", "a.12345.exr", "a.x.exr", "b.0009.exr", "b.0010.exr", "a.9.exr"})
    writeBytes(folder / name, "");
  EXPECT_TRUE(isSequence("a.####.exr"));
  EXPECT_FALSE(isSequence("a.0001.exr"));
  const auto frames = sequenceOf({folder / "a.####.exr", {}, {}});
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].files.colour.filename(), "a.0009.exr");
  EXPECT_EQ(frames[2].files.colour.filename(), "a.12345.exr");
  EXPECT_THROW(sequenceOf({folder / "a.####.exr", folder / "b.####.exr", {}}), Error);  // b has no 12345
  fs::remove(folder / "a.12345.exr");
  EXPECT_EQ(sequenceOf({folder / "a.####.exr", folder / "b.####.exr", {}})[1].files.auxiliary.filename(), "b.0010.exr");
  EXPECT_EQ(sequenceOf({folder / "a.####.exr", folder / "b.0009.exr", {}})[1].files.auxiliary.filename(), "b.0009.exr");
  EXPECT_THROW(sequenceOf({folder / "c.##.exr", {}, {}}), Error);
  EXPECT_THROW(sequenceOf({folder / "b.0009.exr", folder / "a.####.exr", {}}), Error);
}

TEST(Sequence, OfSeveralPatternsIsToldApartInAnyOrder) {
  const TemporaryFolder folder;
  for (const char* number : {"0003", "0004"}) {
    fs::copy_file(kOutdoor.colour, folder / ("c." + std::string(number) + ".exr"));
    fs::copy_file(kOutdoor.auxiliary, folder / ("a." + std::string(number) + ".exr"));
  }
  const fs::path colour = folder / "c.####.exr", auxiliary = folder / "a.%04d.exr", still = folder / "a.0003.exr";
  EXPECT_EQ(sortPatterns({colour, auxiliary}), (FrameFiles{colour, auxiliary, {}}));
  EXPECT_EQ(sortPatterns({auxiliary, colour}), (FrameFiles{colour, auxiliary, {}}));
  EXPECT_EQ(sortPatterns({kOutdoor.reference, still, colour}), (FrameFiles{colour, still, kOutdoor.reference}));
  EXPECT_EQ(sortPatterns({colour, kOutdoor.reference}), (FrameFiles{colour, kOutdoor.reference, {}}));
  fs::remove(folder / "c.0003.exr");
  EXPECT_EQ(sortPatterns({auxiliary, colour}), (FrameFiles{colour, auxiliary, {}}));  // by frame 4: 3 is not whole
  fs::remove(folder / "c.0004.exr");
  EXPECT_EQ(sortPatterns({auxiliary, colour}), (FrameFiles{auxiliary, colour, {}}));
}

}  // namespace
}  // namespace xrds::test
