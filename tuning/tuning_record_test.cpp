#include "tuning/tuning_record.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/temporary_folder.h"

namespace xrds {
namespace {

namespace fs = std::filesystem;

class TuningRecordFile : public testing::Test {
 protected:
  const test::TemporaryFolder folder_;
};

TuningRecord fullRecord() {
  TuningRecord record;
  const TrialKey key{16, "linear 64 > 192 (f32 f32) 0 1"};
  const KernelChoice lane{KernelFamily::lane, {.outputs = 32}}, tile{KernelFamily::tile, {.rows = 4, .subgroup = 32}};
  Finding right, wrong;
  right.program = {"linear_lane_f32", 11};
  right.right = true;
  right.microseconds = 1234.5;
  wrong.program = {"linear_tile_f32", 12};
  wrong.why = "its error is 0.5\tof the result";
  record.findings[{key, lane}] = right;
  record.findings[{key, tile}] = wrong;
  record.winners[key] = {.kernel = lane,
                         .program = {"linear_lane_f32", 11},
                         .fixedProgram = {"linear_plain_f32", 13},
                         .microseconds = 1234.5,
                         .fixedMicroseconds = 99999};
  record.struckOff["conv3x3_tile_f32"] = {14, "it lost the device"};
  record.frames["16 fp32 lane 77"] = {.taken = true,
                                      .normsInLinear = false,
                                      .seconds = 1.5,
                                      .fixedSeconds = 2,
                                      .tuningSeconds = 60,
                                      .date = 1790000000,
                                      .label = "compact, fp32"};
  record.trying = ProgramStamp{"conv3x3_lane_f32", 15};
  return record;
}

TEST_F(TuningRecordFile, GivesBackWhatWasWritten) {
  const TuningFile file(folder_.path(), "device and driver");
  ASSERT_TRUE(file.write(fullRecord()));
  const TuningRecord read = file.read();
  EXPECT_EQ(toText(read), toText(fullRecord()));
  EXPECT_EQ(read.findings.size(), 2u);
  EXPECT_EQ(read.winners.begin()->second.kernel, (KernelChoice{KernelFamily::lane, {.outputs = 32}}));
  EXPECT_EQ(read.frames.begin()->second.normsInLinear, false);
  EXPECT_EQ(read.frames.begin()->second.layersFused, std::nullopt);
  EXPECT_EQ(read.frames.begin()->second.label, "compact, fp32");
  EXPECT_EQ(read.trying, (ProgramStamp{"conv3x3_lane_f32", 15}));
}

TEST_F(TuningRecordFile, OfAnotherDriverIsNotRead) {
  const TuningFile file(folder_.path(), "driver 1"), other(folder_.path(), "driver 2");
  ASSERT_TRUE(file.write(fullRecord()));
  EXPECT_NE(file.path(), other.path());
  EXPECT_EQ(toText(other.read()), toText({}));
  fs::copy_file(file.path(), other.path());
  EXPECT_EQ(toText(other.read()), toText({}));
}

TEST_F(TuningRecordFile, WhatCannotBeWrittenIsKnownToTheProcess) {
  const TuningFile file(folder_.path(), "driver"), none({}, "driver");
  fs::create_directories(file.path());
  for (const TuningFile* each : {&file, &none}) {
    EXPECT_FALSE(each->write(fullRecord()));
    EXPECT_EQ(toText(each->read()), toText(fullRecord()));
    EXPECT_FALSE(each->write({}));
    EXPECT_EQ(toText(each->read()), toText({}));
  }
  EXPECT_FALSE(file.write(fullRecord()));
  fs::remove(file.path());
  ASSERT_TRUE(file.write(fullRecord()));
  fs::remove(file.path());
  EXPECT_EQ(toText(file.read()), toText({})) << "what is written is the file's";
}

TEST_F(TuningRecordFile, DamagedIsEmpty) {
  const TuningFile file(folder_.path(), "driver");
  ASSERT_TRUE(file.write(fullRecord()));
  std::string whole;
  {
    std::ifstream in(file.path(), std::ios::binary);
    whole.assign(std::istreambuf_iterator<char>(in), {});
  }
  for (size_t i = 0; i < whole.size(); i += 7) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    std::ofstream(file.path(), std::ios::binary) << damaged;
    EXPECT_EQ(toText(file.read()), toText({})) << "byte " << i;
  }
  std::ofstream(file.path(), std::ios::binary) << whole.substr(0, whole.size() / 2);
  EXPECT_EQ(toText(file.read()), toText({}));
  fs::remove(file.path());
  EXPECT_EQ(toText(file.read()), toText({}));
}

TEST(TuningRecord, TextOfAnotherKindIsEmpty) {
  const std::string text = toText(fullRecord());
  for (const std::string& bad : {std::string("something\n"), std::string("xrds tuning 1\n"), text + "unknown\t1\n",
                                 text + "winner\t16\n", text + "frame\tx\tyes\n", text.substr(0, text.size() - 1)})
    EXPECT_EQ(toText(fromText(bad)), toText({})) << bad;
}

TEST(TuningRecord, WhatWasTriedWhenAProcessEndedIsStruckOff) {
  TuningRecord record = fullRecord();
  record.takeStock();
  EXPECT_FALSE(record.trying);
  EXPECT_TRUE(record.isStruckOff({"conv3x3_lane_f32", 15}));
  EXPECT_FALSE(record.isStruckOff({"conv3x3_lane_f32", 16})) << "another program of that name";
}

// The fixed choice is what frames run without tuning, and a killed process says nothing of it.
TEST(TuningRecord, TheFixedChoiceIsStruckOffAtTheSecondEnd) {
  TuningRecord record = fullRecord();
  record.isFixedTried = true;
  const ProgramStamp fixed = *record.trying;
  record = fromText(toText(record));
  record.takeStock();
  EXPECT_FALSE(record.trying);
  EXPECT_FALSE(record.isStruckOff(fixed));
  EXPECT_EQ(record.suspects.count(fixed.name), 1u);
  record = fromText(toText(record));
  record.trying = ProgramStamp{fixed.name, fixed.hash + 1};
  record.isFixedTried = true;
  record.takeStock();
  EXPECT_FALSE(record.isStruckOff(*fullRecord().trying)) << "it was another program";
  record.trying = ProgramStamp{fixed.name, fixed.hash + 1};
  record.takeStock();
  EXPECT_TRUE(record.isStruckOff({fixed.name, fixed.hash + 1}));
}

TEST(TuningRecord, WhatIsOfChangedProgramsIsDropped) {
  TuningRecord record = fullRecord();
  record.dropStale([](const std::string& name) -> uint64_t {
    return name == "linear_lane_f32" ? 11 : name == "linear_plain_f32" ? 13 : name == "linear_tile_f32" ? 12 : 0;
  });
  EXPECT_EQ(record.findings.size(), 2u);
  EXPECT_EQ(record.winners.size(), 1u);
  EXPECT_EQ(record.frames.size(), 1u);
  EXPECT_TRUE(record.struckOff.empty());
  EXPECT_FALSE(record.trying);
  record.dropStale([](const std::string& name) -> uint64_t { return name == "linear_tile_f32" ? 12 : 0; });
  EXPECT_EQ(record.findings.size(), 1u);
  EXPECT_TRUE(record.winners.empty());
  EXPECT_TRUE(record.frames.empty()) << "it was timed with a winner that is gone";
}

}  // namespace
}  // namespace xrds
