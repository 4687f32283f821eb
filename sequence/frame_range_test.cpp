#include "sequence/frame_range.h"

#include <gtest/gtest.h>

#include "xrds/error.h"

namespace xrds {
namespace {

using Frames = std::vector<int>;

TEST(FrameRange, NumbersAndRanges) {
  EXPECT_EQ(parseFrames("7"), (Frames{7}));
  EXPECT_EQ(parseFrames("1-4"), (Frames{1, 2, 3, 4}));
  EXPECT_EQ(parseFrames("1-8:3"), (Frames{1, 4, 7}));
  EXPECT_EQ(parseFrames("1-3,7,10-20:5"), (Frames{1, 2, 3, 7, 10, 15, 20}));
  EXPECT_EQ(parseFrames("20-10:-5"), (Frames{20, 15, 10}));
  EXPECT_EQ(parseFrames("-2-1"), (Frames{-2, -1, 0, 1}));
  EXPECT_EQ(parseFrames("-5--3"), (Frames{-5, -4, -3}));
}

TEST(FrameRange, SpacesAreAllowedAndSeparate) {
  EXPECT_EQ(parseFrames(" 1 - 3 , 7 "), (Frames{1, 2, 3, 7}));
  EXPECT_EQ(parseFrames("1-3 7 10 - 12 : 2"), (Frames{1, 2, 3, 7, 10, 12}));
}

TEST(FrameRange, EachFrameOnceWhereItStandsFirst) { EXPECT_EQ(parseFrames("3,1-4"), (Frames{3, 1, 2, 4})); }

TEST(FrameRange, WhatIsNoneIsRefused) {
  for (const char* text : {"", " ", "a", "1-", "1-2:", "1-5:0", "5-1", "1-5:-1", "1,,2", "1,", "1..5", "1-5:2:3", "1x",
                           "99999999999", "1000000001", "-1000000001", "1-2000000", "1.5"})
    EXPECT_THROW(parseFrames(text), Error) << text;
  EXPECT_EQ(parseFrames("1-1000000").size(), kMostFrames);
}

std::string refusal(const char* text) {
  try {
    parseFrames(text);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(FrameRange, ARefusalSaysWhatIsWrongAndWhere) {
  const std::string how = "; give them as 1-240, 1-240:2 or 1-3,7,10-20:5.";
  EXPECT_EQ(refusal("1-"), "'1-' names no frames: expected a number at the end" + how);
  EXPECT_EQ(refusal("1,x"), "'1,x' names no frames: expected a number at 'x'" + how);
  EXPECT_EQ(refusal("5-1"), "'5-1' names no frames: a step of 1 does not lead from 5 to 1" + how);
  EXPECT_EQ(refusal("1-5:0,7"), "'1-5:0,7' names no frames: a step of 0 does not lead from 1 to 5" + how);
}

TEST(FrameRange, IsDescribedShortly) {
  for (const char* text : {"7", "1-3", "1-3, 7, 10-20:5", "20-10:-5", "-5--3", "1, 7", "1-2"})
    EXPECT_EQ(describeFrames(parseFrames(text)), text);
  EXPECT_EQ(describeFrames({}), "");
}

}  // namespace
}  // namespace xrds
