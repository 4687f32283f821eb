#include "image/exr/write.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <gtest/gtest.h>
#ifndef _WIN32
#include <sys/resource.h>
#include <unistd.h>
#endif

#include <algorithm>
#include <cmath>
#include <csignal>
#include <limits>

#include "image/exr/read.h"
#include "image/test_files.h"
#include "tests/temporary_folder.h"
#include "xrds/error.h"

namespace xrds {
namespace {

using test::FixturePart;
using test::TemporaryFolder;

Image gradient(int width, int height, int channels) {
  Image image(width, height, channels);
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = static_cast<float>(i) * 0.37F - 3.0F;
  }
  return image;
}

ExrOutput outputFor(const Image& image) {
  ExrOutput output;
  output.dataWindow = {0, 0, image.width - 1, image.height - 1};
  output.displayWindow = output.dataWindow;
  return output;
}

TEST(ExrWrite, ReturnsEveryFloat) {
  const TemporaryFolder folder;
  for (const int channels : {1, 3, 4}) {
    Image image = gradient(13, 7, channels);
    image.pixels[3] = std::numeric_limits<float>::infinity();
    image.pixels[4] = 1e30F;
    ExrOutput output = outputFor(image);
    output.dataWindow = {-5, -9, 7, -3};
    writeExr(folder / "a.exr", image, output);
    const ExrFile file = readExrHeader(folder / "a.exr");
    std::vector<std::string> names = {"R", "G", "B", "A"};
    names.resize(static_cast<size_t>(channels));
    EXPECT_EQ(readLayer(file, {0, "", channels == 1 ? std::vector<std::string>{"Y"} : names}), image);
    EXPECT_EQ(file.parts[0].dataWindow, output.dataWindow);
    EXPECT_EQ(folder.fileCount(), 1U);
  }
}

TEST(ExrWrite, ThreadsAndTypesGiveTheSameNumbers) {
  const TemporaryFolder folder;
  Image image(50, 700, 3);
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = static_cast<float>(i % 2039);
  }
  std::vector<std::string> files;
  for (const int threads : {0, 3}) {
    useExrThreads(threads);
    for (const ExrPixelType type : {ExrPixelType::kFloat, ExrPixelType::kHalf}) {
      ExrOutput output = outputFor(image);
      output.pixelType = type;
      writeExr(folder / "a.exr", image, output);
      EXPECT_EQ(readLayer(readExrHeader(folder / "a.exr"), {0, "", {"R", "G", "B"}}), image);
      files.push_back(test::readBytes(folder / "a.exr"));
    }
  }
  useExrThreads(0);
  EXPECT_TRUE(files[0] == files[2]);
  EXPECT_TRUE(files[1] == files[3]);
  EXPECT_THROW(useExrThreads(-1), Error);
}

TEST(ExrWrite, HalfStaysFinite) {
  const TemporaryFolder folder;
  Image image(4, 1, 3, 0.1F);
  image.pixels[0] = 1e9F;
  image.pixels[1] = -1e9F;
  ExrOutput output = outputFor(image);
  output.pixelType = ExrPixelType::kHalf;
  writeExr(folder / "a.exr", image, output);
  const ExrFile file = readExrHeader(folder / "a.exr");
  EXPECT_EQ(file.parts[0].layers[0].channels[0].type, ExrPixelType::kHalf);
  const Image read = readLayer(file, {0, "", {"R", "G", "B"}});
  EXPECT_EQ(read.pixels[0], 65504.0F);
  EXPECT_EQ(read.pixels[1], -65504.0F);
  EXPECT_NEAR(read.pixels[2], 0.1F, 1e-4F);
}

// A header with attributes of many kinds: standard, the renderer's own, of an unknown type, and of the encoding.
Imf::Header richHeader(const FixturePart& part) {
  Imf::Header header = test::fixtureHeader(part);
  Imf::addComments(header, "a comment");
  Imf::addChromaticities(header, Imf::Chromaticities());
  Imf::addFramesPerSecond(header, Imf::Rational(24, 1));
  Imf::addMultiView(header, {"left", "right"});
  header.insert("cycles.ViewLayer.samples", Imf::StringAttribute("64"));
  header.insert("cryptomatte/542cafa/name", Imf::StringAttribute("ViewLayer.CryptoObject"));
  header.insert("BlenderMultiChannel", Imf::StringAttribute("Blender V2.55.1 and newer"));
  header.insert(kMergedWithout, Imf::StringAttribute("3"));
  header.insert("renderer/seed", Imf::IntAttribute(7));
  header.insert("strange", Imf::StringAttribute("abc"));
  header.pixelAspectRatio() = 1.5F;
  return header;
}

// Gives the attribute `strange` a type that no version of OpenEXR knows.
void makeTypeUnknown(const std::filesystem::path& path) {
  std::string bytes = test::readBytes(path);
  const std::string known("strange\0string\0", 15);
  bytes.replace(bytes.find(known), known.size(), std::string("strange\0sphinx\0", 15));
  test::writeBytes(path, bytes);
}

TEST(ExrWrite, KeepsAttributesAndScalesWindows) {
  const TemporaryFolder folder;
  FixturePart part{"beauty", {-2, -3, 9, 8}, {0, 0, 7, 5}, {"R", "G", "B"}, Imf::HALF, Imf::PIZ_COMPRESSION, 16};
  test::writeFixture(folder / "in.exr", {part}, {richHeader(part)});
  makeTypeUnknown(folder / "in.exr");
  const ExrFile in = readExrHeader(folder / "in.exr");
  ExrOutput output = scaledOutput(in.parts[0], 4);
  output.texts = {{"xrds:version", "0.1"}, {"xrds:model", "m"}, {"comments", "ours"}};
  writeExr(folder / "out.exr", gradient(48, 48, 3), output);

  const Imf::InputFile written((folder / "out.exr").string().c_str());
  const Imf::Header& header = written.header();
  EXPECT_EQ(header.dataWindow(), Imath::Box2i({-8, -12}, {39, 35}));
  EXPECT_EQ(header.displayWindow(), Imath::Box2i({0, 0}, {31, 23}));
  EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("cycles.ViewLayer.samples").value(), "64");
  EXPECT_EQ(header.typedAttribute<Imf::IntAttribute>("renderer/seed").value(), 7);
  EXPECT_STREQ(header["strange"].typeName(), "sphinx");
  EXPECT_TRUE(Imf::hasChromaticities(header));
  EXPECT_TRUE(Imf::hasFramesPerSecond(header));
  EXPECT_EQ(Imf::comments(header), "ours");
  EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("xrds:model").value(), "m");
  EXPECT_EQ(header.pixelAspectRatio(), 1.5F);
  EXPECT_EQ(header.compression(), Imf::ZIP_COMPRESSION);
  EXPECT_FALSE(header.hasTileDescription());
  EXPECT_FALSE(header.hasName());
  EXPECT_FALSE(Imf::hasMultiView(header));
  EXPECT_EQ(header.find("cryptomatte/542cafa/name"), header.end());
  EXPECT_EQ(header.find("BlenderMultiChannel"), header.end());
  EXPECT_EQ(header.find(kMergedWithout), header.end());
}

TEST(ExrWrite, AttributesAreAValue) {
  const TemporaryFolder folder;
  const FixturePart part{"", {0, 0, 3, 3}, {0, 0, 3, 3}, {"R"}};
  test::writeFixture(folder / "in.exr", {part}, {richHeader(part)});
  ExrAttributes kept;
  {
    const ExrFile in = readExrHeader(folder / "in.exr");
    kept = in.parts[0].attributes;
  }
  const ExrAttributes copy = kept;
  EXPECT_EQ(copy.text("comments"), "a comment");
  EXPECT_EQ(copy.text("renderer/seed"), std::nullopt);
  EXPECT_EQ(copy.text("absent"), std::nullopt);
  const std::vector<std::string> names = copy.names();
  EXPECT_NE(std::find(names.begin(), names.end(), "strange"), names.end());
  EXPECT_EQ(std::find(names.begin(), names.end(), "channels"), names.end());
}

TEST(ExrWrite, RefusesWhatItCannotExpress) {
  const TemporaryFolder folder;
  const Image image = gradient(4, 4, 3);
  ExrOutput output = outputFor(image);
  output.dataWindow.maxX = 4;
  EXPECT_THROW(writeExr(folder / "a.exr", image, output), Error);
  EXPECT_THROW(writeExr(folder / "a.exr", gradient(4, 4, 2), outputFor(image)), Error);
  EXPECT_THROW(writeExr(folder / "a.exr", Image(), outputFor(Image())), Error);
  output = outputFor(image);
  output.pixelType = ExrPixelType::kUint;
  EXPECT_THROW(writeExr(folder / "a.exr", image, output), Error);
  EXPECT_EQ(folder.fileCount(), 0U);
}

TEST(ExrWrite, RefusesFoldersThatCannotBeWritten) {
  const TemporaryFolder folder;
  const Image image = gradient(4, 4, 3);
  test::writeBytes(folder / "file", "x");
  EXPECT_THROW(writeExr(folder / "absent" / "a.exr", image, outputFor(image)), Error);
  EXPECT_THROW(writeExr(folder / "file" / "a.exr", image, outputFor(image)), Error);
  EXPECT_THROW(writeExr(folder / "", image, outputFor(image)), Error);
#ifndef _WIN32
  EXPECT_THROW(writeExr("/dev/full", image, outputFor(image)), Error);
  EXPECT_THROW(writeExr("/proc/self/a.exr", image, outputFor(image)), Error);
  if (geteuid() != 0) {
    std::filesystem::permissions(folder / "", std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
    EXPECT_THROW(writeExr(folder / "a.exr", image, outputFor(image)), Error);
    std::filesystem::permissions(folder / "", std::filesystem::perms::owner_all);
  }
#endif
}

#ifndef _WIN32  // which has other limits, links and permissions
// Lets no file grow beyond `byteSize` while it lives, which looks to a writer like a full disk.
class FullDisk {
 public:
  explicit FullDisk(rlim_t byteSize) : oldHandler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit small{byteSize, old_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, oldHandler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit old_{};
  void (*oldHandler_)(int);
};

TEST(ExrWrite, LeavesNothingBehindOnAFullDisk) {
  const TemporaryFolder folder;
  const Image image = gradient(64, 64, 3);
  writeExr(folder / "a.exr", image, outputFor(image));
  const std::string before = test::readBytes(folder / "a.exr");
  const Image other = gradient(65, 64, 3);
  for (size_t limit = 0; limit < before.size(); limit += before.size() / 40 + 1) {
    const FullDisk full(limit);
    EXPECT_THROW(writeExr(folder / "a.exr", other, outputFor(other)), Error) << limit;
    EXPECT_THROW(writeExr(folder / "b.exr", image, outputFor(image)), Error) << limit;
  }
  EXPECT_EQ(folder.fileCount(), 1U);
  EXPECT_EQ(test::readBytes(folder / "a.exr"), before);
}

TEST(ExrWrite, ReplacesAFileAndFollowsALink) {
  const TemporaryFolder folder;
  const Image image = gradient(8, 8, 3);
  test::writeBytes(folder / "real.exr", "old");
  std::filesystem::create_symlink("real.exr", folder / "link.exr");
  writeExr(folder / "link.exr", image, outputFor(image));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.exr"));
  EXPECT_EQ(readLayer(readExrHeader(folder / "real.exr"), {0, "", {"R", "G", "B"}}), image);
  EXPECT_EQ(folder.fileCount(), 2U);
}

TEST(ExrWrite, FollowsLinksToWhatIsNotThereYet) {
  const TemporaryFolder folder;
  const Image image = gradient(8, 8, 3);
  std::filesystem::create_directory(folder / "far");
  std::filesystem::create_symlink("far/second.exr", folder / "first.exr");
  std::filesystem::create_symlink("../real.exr", folder / "far/second.exr");
  writeExr(folder / "first.exr", image, outputFor(image));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "first.exr"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "far/second.exr"));
  EXPECT_EQ(readLayer(readExrHeader(folder / "real.exr"), {0, "", {"R", "G", "B"}}), image);

  std::filesystem::create_symlink("b.exr", folder / "a.exr");
  std::filesystem::create_symlink("a.exr", folder / "b.exr");
  EXPECT_THROW(writeExr(folder / "a.exr", image, outputFor(image)), Error);
}

TEST(ExrWrite, KeepsThePermissionsOfWhatItReplaces) {
  using std::filesystem::perms;
  const TemporaryFolder folder;
  const Image image = gradient(8, 8, 3);
  const auto permissionsOf = [&](const char* name) { return std::filesystem::status(folder / name).permissions(); };
  writeExr(folder / "new.exr", image, outputFor(image));
  for (const perms wanted : {perms::owner_read | perms::owner_write,
                             perms::owner_read | perms::owner_write | perms::group_read | perms::group_write}) {
    test::writeBytes(folder / "old.exr", "old");
    std::filesystem::permissions(folder / "old.exr", wanted);
    ASSERT_NE(wanted, permissionsOf("new.exr"));
    writeExr(folder / "old.exr", image, outputFor(image));
    EXPECT_EQ(permissionsOf("old.exr"), wanted);
    EXPECT_EQ(readLayer(readExrHeader(folder / "old.exr"), {0, "", {"R", "G", "B"}}), image);
  }
}
#endif

}  // namespace
}  // namespace xrds
