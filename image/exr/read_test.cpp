#include "image/exr/read.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <gtest/gtest.h>

#include "image/test_files.h"
#include "tests/print_case.h"
#include "tests/temporary_folder.h"
#include "xrds/error.h"

namespace xrds {
namespace {

using test::FixturePart;
using test::fixtureValue;
using test::PrintTo;
using test::TemporaryFolder;
using test::writeFixture;

constexpr Box kFrame{0, 0, 36, 20};

// Every value must be what the fixture stores for the channel of that place in `channelOrder`.
void expectFixture(const Image& image, const Box& box, const std::vector<size_t>& channelOrder) {
  ASSERT_EQ(image.width, box.width());
  ASSERT_EQ(image.height, box.height());
  ASSERT_EQ(image.channels, static_cast<int>(channelOrder.size()));
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < image.channels; ++c) {
        ASSERT_EQ(image.at(x, y, c), fixtureValue(x + box.minX, y + box.minY, channelOrder[size_t(c)]))
            << x << ", " << y << ", " << c;
      }
    }
  }
}

struct Storage {
  const char* name;
  FixturePart part;
};

class ReadsStorage : public ::testing::TestWithParam<Storage> {};

TEST_P(ReadsStorage, ReturnsEveryValue) {
  const TemporaryFolder folder;
  FixturePart part = GetParam().part;
  part.channels = {"R", "G", "B"};
  writeFixture(folder / "a.exr", {part});
  const ExrFile file = readExrHeader(folder / "a.exr");
  ASSERT_EQ(file.parts.size(), 1U);
  EXPECT_EQ(file.parts[0].dataWindow, part.dataWindow);
  EXPECT_EQ(file.parts[0].displayWindow, part.displayWindow);
  EXPECT_EQ(file.parts[0].tiled, part.tileSize > 0);
  EXPECT_EQ(file.parts[0].layers.at(0).channels.at(0).type,
            part.type == Imf::HALF ? ExrPixelType::kHalf : ExrPixelType::kFloat);
  expectFixture(readLayer(file, {0, "", {"R", "G", "B"}}), part.dataWindow, {0, 1, 2});
  expectFixture(readLayer(file, {0, "", {"B", "R"}}), part.dataWindow, {2, 0});
}

INSTANTIATE_TEST_SUITE_P(
    Exr, ReadsStorage,
    ::testing::Values(Storage{"FloatZip", {"", kFrame, kFrame, {}, Imf::FLOAT}},
                      Storage{"HalfZip", {"", kFrame, kFrame, {}, Imf::HALF}},
                      Storage{"HalfPiz", {"", kFrame, kFrame, {}, Imf::HALF, Imf::PIZ_COMPRESSION}},
                      Storage{"FloatUncompressed", {"", kFrame, kFrame, {}, Imf::FLOAT, Imf::NO_COMPRESSION}},
                      Storage{"HalfRle", {"", kFrame, kFrame, {}, Imf::HALF, Imf::RLE_COMPRESSION}},
                      Storage{"FloatZips", {"", kFrame, kFrame, {}, Imf::FLOAT, Imf::ZIPS_COMPRESSION}},
                      Storage{"Tiled", {"", kFrame, kFrame, {}, Imf::FLOAT, Imf::ZIP_COMPRESSION, 16}},
                      Storage{"TiledHalfOddTile", {"", kFrame, kFrame, {}, Imf::HALF, Imf::PIZ_COMPRESSION, 7}},
                      Storage{"OffsetWindow", {"", {5, 7, 30, 18}, kFrame}},
                      Storage{"NegativeOriginOverscan", {"", {-8, -6, 44, 26}, kFrame, {}, Imf::HALF}},
                      Storage{"TiledNegativeOrigin",
                              {"", {-8, -6, 44, 26}, {-2, -2, 9, 9}, {}, Imf::HALF, Imf::ZIP_COMPRESSION, 16}},
                      Storage{"OnePixel", {"", {3, 3, 3, 3}, kFrame}}),
    [](const auto& storage) { return storage.param.name; });

TEST(ExrRead, SplitsLayersAtTheLastDot) {
  const TemporaryFolder folder;
  writeFixture(folder / "a.exr",
               {{"", kFrame, kFrame, {"View.Layer.Combined.R", "View.Layer.Combined.G", "A", "Depth.Z", "dot."}}});
  const ExrFile file = readExrHeader(folder / "a.exr");
  std::vector<std::string> names;
  for (const ExrLayer& layer : file.parts[0].layers) {
    names.push_back(layer.name);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"", "Depth", "View.Layer.Combined", "dot"}));
  EXPECT_EQ(file.parts[0].layers[2].channels[0].suffix, "G");
  EXPECT_EQ(file.parts[0].layers[3].channels[0].suffix, "");
}

TEST(ExrRead, ReadsPartsOfDifferentSizesAndKinds) {
  const TemporaryFolder folder;
  const Box low{-2, -2, 11, 9};
  const Box high{-8, -8, 47, 39};
  writeFixture(folder / "a.exr",
               {{"beauty", low, {0, 0, 9, 7}, {"R", "G", "B"}, Imf::HALF},
                {"crypto", high, {0, 0, 9, 7}, {"id00.r"}, Imf::UINT},
                {"albedo", high, {0, 0, 9, 7}, {"R", "G", "B"}, Imf::FLOAT, Imf::ZIP_COMPRESSION, 16}});
  const ExrFile file = readExrHeader(folder / "a.exr");
  ASSERT_EQ(file.parts.size(), 3U);
  EXPECT_EQ(file.parts[2].name, "albedo");
  expectFixture(readLayer(file, {0, "", {"R", "G", "B"}}), low, {0, 1, 2});
  expectFixture(readLayer(file, {2, "", {"R", "G", "B"}}), high, {0, 1, 2});
}

TEST(ExrRead, ListsViews) {
  const TemporaryFolder folder;
  const FixturePart part{"", kFrame, kFrame, {"R", "right.R"}};
  Imf::Header header = test::fixtureHeader(part);
  Imf::addMultiView(header, {"left", "right"});
  writeFixture(folder / "a.exr", {part}, {header});
  EXPECT_EQ(readExrHeader(folder / "a.exr").views, (std::vector<std::string>{"left", "right"}));
  writeFixture(folder / "b.exr", {{"l", kFrame, kFrame, {"R"}, Imf::HALF, Imf::ZIP_COMPRESSION, 0, "left"}});
  EXPECT_EQ(readExrHeader(folder / "b.exr").parts[0].view, "left");
}

TEST(ExrRead, RefusesWholeNumbersSubsamplingAndStrangers) {
  const TemporaryFolder folder;
  writeFixture(folder / "a.exr", {{"", kFrame, kFrame, {"id.R"}, Imf::UINT}});
  const ExrFile file = readExrHeader(folder / "a.exr");
  EXPECT_EQ(file.parts[0].layers[0].channels[0].type, ExrPixelType::kUint);
  EXPECT_THROW(static_cast<void>(readLayer(file, {0, "id", {"id.R"}})), Error);
  EXPECT_THROW(static_cast<void>(readLayer(file, {0, "", {"Q"}})), Error);
  EXPECT_THROW(static_cast<void>(readLayer(file, {1, "", {"id.R"}})), Error);

  Imf::Header header(4, 4);
  header.channels().insert("BY", Imf::Channel(Imf::HALF, 2, 2));
  { const Imf::OutputFile untouched((folder / "b.exr").string().c_str(), header); }
  const ExrFile chroma = readExrHeader(folder / "b.exr");
  EXPECT_EQ(chroma.parts[0].layers[0].channels[0].xSampling, 2);
  EXPECT_THROW(static_cast<void>(readLayer(chroma, {0, "", {"BY"}})), Error);
}

TEST(ExrRead, RefusesDeepFilesByName) {
  const TemporaryFolder folder;
  Imf::Header header(4, 4);
  header.channels().insert("R", Imf::Channel(Imf::HALF));
  header.setType(Imf::DEEPSCANLINE);
  header.compression() = Imf::ZIPS_COMPRESSION;
  { const Imf::DeepScanLineOutputFile untouched((folder / "deep.exr").string().c_str(), header); }
  const ExrFile file = readExrHeader(folder / "deep.exr");
  EXPECT_TRUE(file.parts[0].deep);
  try {
    static_cast<void>(readLayer(file, {0, "", {"R"}}));
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("deep"), std::string::npos) << error.what();
  }
}

TEST(ExrRead, DescribesWhatTheFileHolds) {
  const TemporaryFolder folder;
  writeFixture(folder / "a.exr", {{"", kFrame, kFrame, {"R", "G", "B", "Ns.X", "Ns.Y", "Ns.Z"}, Imf::HALF}});
  const std::string text = describe(readExrHeader(folder / "a.exr"));
  EXPECT_NE(text.find("part 0, 37 x 21: (unnamed) [B G R] half"), std::string::npos) << text;
  EXPECT_NE(text.find("Ns [X Y Z] half"), std::string::npos) << text;
}

TEST(ExrRead, ShowsNoControlCharacters) {
  const TemporaryFolder folder;
  writeFixture(folder / "a.exr", {{"", kFrame, kFrame, {"bell\x07\x1b[2J.R", "caf\xc3\xa9.R"}}});
  const std::string text = describe(readExrHeader(folder / "a.exr"));
  EXPECT_NE(text.find("bell??[2J"), std::string::npos) << text;
  EXPECT_NE(text.find("caf\xc3\xa9"), std::string::npos) << text;
}

}  // namespace
}  // namespace xrds
