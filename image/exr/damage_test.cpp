#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfOutputFile.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <string>

#include "image/exr/read.h"
#include "image/test_files.h"
#include "tests/temporary_folder.h"
#include "xrds/error.h"

#ifndef _WIN32
#include <unistd.h>
#endif

namespace xrds {
namespace {

using test::FixturePart;
using test::readBytes;
using test::TemporaryFolder;
using test::writeBytes;
using test::writeFixture;

constexpr Box kFrame{-3, -2, 36, 41};

std::vector<std::vector<FixturePart>> damageFixtures() {
  return {{{"", kFrame, kFrame, {"R", "G", "B"}, Imf::HALF, Imf::ZIP_COMPRESSION}},
          {{"", kFrame, kFrame, {"R", "G", "B"}, Imf::FLOAT, Imf::PIZ_COMPRESSION, 16}},
          {{"", kFrame, kFrame, {"R", "G", "B"}, Imf::HALF, Imf::DWAA_COMPRESSION}},
          {{"a", kFrame, kFrame, {"R", "G", "B"}, Imf::FLOAT, Imf::RLE_COMPRESSION},
           {"b", kFrame, kFrame, {"n.X", "n.Y", "n.Z"}, Imf::HALF, Imf::PXR24_COMPRESSION, 16}}};
}

// Reads everything; an Error is a fair answer, any other exception or a crash is not.
bool readsWhole(const std::filesystem::path& path) {
  try {
    const ExrFile file = readExrHeader(path);
    for (size_t part = 0; part < file.parts.size(); ++part) {
      for (const ExrLayer& layer : file.parts[part].layers) {
        for (const ExrChannel& channel : layer.channels) {
          static_cast<void>(readLayer(file, {part, layer.name, {channel.name}}));
        }
      }
    }
    return true;
  } catch (const Error&) {
    return false;
  }
}

TEST(ExrDamage, RefusesFilesCutAtAnyLength) {
  const TemporaryFolder folder;
  for (const auto& parts : damageFixtures()) {
    writeFixture(folder / "whole.exr", parts);
    const std::string bytes = readBytes(folder / "whole.exr");
    ASSERT_TRUE(readsWhole(folder / "whole.exr"));
    const size_t step = bytes.size() / 150 + 1;
    for (size_t length = 0; length < bytes.size(); length += length < 64 ? 1 : step) {
      writeBytes(folder / "cut.exr", bytes.substr(0, length));
      EXPECT_FALSE(readsWhole(folder / "cut.exr")) << length << " of " << bytes.size() << " bytes";
    }
  }
}

std::string refusalOf(const std::filesystem::path& path) {
  try {
    static_cast<void>(readExrHeader(path));
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(ExrDamage, WhatIsMissingAndWhatIsClosedAreToldApart) {
  const TemporaryFolder folder;
  EXPECT_NE(refusalOf(folder / "none.exr").find("there is no such file"), std::string::npos);
#ifndef _WIN32  // to which a name that is too long is that of no file
  EXPECT_EQ(refusalOf(folder / std::string(5000, 'x')).find("there is no such file"), std::string::npos);
  if (geteuid() == 0) return;  // who may read everything
  const auto closed = folder / "closed.exr";
  writeFixture(closed, damageFixtures().front());
  std::filesystem::permissions(closed, std::filesystem::perms::none);
  EXPECT_NE(refusalOf(closed).find("Permission denied"), std::string::npos) << refusalOf(closed);
#endif
}

TEST(ExrDamage, SurvivesFlippedBytes) {
  const TemporaryFolder folder;
  std::mt19937 random(20231);
  for (const auto& parts : damageFixtures()) {
    writeFixture(folder / "whole.exr", parts);
    const std::string bytes = readBytes(folder / "whole.exr");
    for (int round = 0; round < 150; ++round) {
      std::string damaged = bytes;
      const size_t reach = round % 2 == 0 ? std::min<size_t>(bytes.size(), 512) : bytes.size();
      for (int flip = 0; flip <= round % 3; ++flip) {
        damaged[random() % reach] = static_cast<char>(random());
      }
      writeBytes(folder / "damaged.exr", damaged);
      EXPECT_NO_THROW(readsWhole(folder / "damaged.exr")) << "round " << round;
    }
  }
}

TEST(ExrDamage, RefusesAbsentEmptyForeignAndFolder) {
  const TemporaryFolder folder;
  writeBytes(folder / "empty.exr", "");
  writeBytes(folder / "text.exr", "not an image");
  EXPECT_THROW(static_cast<void>(readExrHeader(folder / "absent.exr")), Error);
  EXPECT_THROW(static_cast<void>(readExrHeader(folder / "empty.exr")), Error);
  EXPECT_THROW(static_cast<void>(readExrHeader(folder / "text.exr")), Error);
  EXPECT_THROW(static_cast<void>(readExrHeader(folder / "")), Error);
}

// Replaces the corners of the data window inside the header bytes.
std::string withDataWindow(std::string bytes, int32_t minX, int32_t minY, int32_t maxX, int32_t maxY) {
  const std::string entry("dataWindow\0box2i\0", 17);
  const size_t start = bytes.find(entry) + entry.size() + 4;
  size_t offset = start;
  for (const int32_t value : {minX, minY, maxX, maxY}) {
    for (unsigned shift = 0; shift < 32; shift += 8) {
      bytes[offset++] = static_cast<char>(static_cast<uint32_t>(value) >> shift);
    }
  }
  return bytes;
}

TEST(ExrDamage, RefusesHugeAndImpossibleWindows) {
  const TemporaryFolder folder;
  writeFixture(folder / "whole.exr", {damageFixtures()[0]});
  const std::string bytes = readBytes(folder / "whole.exr");
  constexpr int32_t kLargest = 2147483647;
  const std::vector<Box> boxes = {{0, 0, kLargest, kLargest},
                                  {-kLargest - 1, -kLargest - 1, kLargest, kLargest},
                                  {0, 0, 1 << 29, 0},
                                  {0, 0, 0, 1 << 29},
                                  {0, 0, 30000, 30000},
                                  {10, 10, 0, 0},
                                  {0, 0, 16383, 16383},
                                  {kLargest, 0, kLargest, 10},
                                  {-1073741823, 0, 1073741823, 40},
                                  {0, 0, 1 << 24, 15}};
  for (const Box& box : boxes) {
    writeBytes(folder / "huge.exr", withDataWindow(bytes, box.minX, box.minY, box.maxX, box.maxY));
    EXPECT_FALSE(readsWhole(folder / "huge.exr")) << toString(box);
  }
}

// OpenEXR itself would allocate what the attribute claims.
TEST(ExrDamage, RefusesAnAttributeLargerThanTheFile) {
  const TemporaryFolder folder;
  for (const auto& parts : damageFixtures()) {
    writeFixture(folder / "whole.exr", parts);
    const std::string bytes = readBytes(folder / "whole.exr");
    for (const std::string& entry :
         {std::string("channels\0chlist\0", 16), std::string("lineOrder\0lineOrder\0", 20)}) {
      std::string damaged = bytes;
      damaged.replace(damaged.rfind(entry) + entry.size(), 4, "\xff\xff\xff\x7f");
      writeBytes(folder / "claims.exr", damaged);
      EXPECT_NE(refusalOf(folder / "claims.exr").find("an attribute of 2147483647 bytes"), std::string::npos);
    }
  }
}

TEST(ExrDamage, RefusesBlocksThatAFewBytesCannotFill) {
  const TemporaryFolder folder;
  writeFixture(folder / "whole.exr", {{"", kFrame, kFrame, {"R", "G", "B"}, Imf::FLOAT, Imf::DWAB_COMPRESSION}});
  writeBytes(folder / "wide.exr", withDataWindow(readBytes(folder / "whole.exr"), 0, 0, (1 << 18) - 1, 255));
  EXPECT_NE(refusalOf(folder / "wide.exr").find("found 12 bytes a pixel in blocks of 262144 x 256"), std::string::npos)
      << refusalOf(folder / "wide.exr");
}

TEST(ExrDamage, NamesTheFileAndTheRemedy) {
  const TemporaryFolder folder;
  writeBytes(folder / "empty.exr", "");
  try {
    static_cast<void>(readExrHeader(folder / "empty.exr"));
    FAIL();
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("empty.exr"), std::string::npos);
    EXPECT_NE(text.find("empty file"), std::string::npos);
  }
}

}  // namespace
}  // namespace xrds
