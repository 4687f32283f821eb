#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace xrds {

/// The most frames that one range may name.
inline constexpr size_t kMostFrames = 1'000'000;

/// The largest number of a frame, of negative ones without the sign: those beside it are numbers, too.
inline constexpr int kLargestFrame = 1'000'000'000;

/// The frames that "1-240:2" or "1-3, 7, 20-10:-5" names, in that order, each once: numbers and ranges with both ends,
/// whose step is 1 unless it is given; the grammar of Open Job Description's range expressions
/// (https://github.com/OpenJobDescription/openjd-specifications, <IntRangeExpr>), in which spaces mean nothing, but
/// that spaces alone may stand between items, too. Throws Error if the text is none, or names more than kMostFrames or
/// one above kLargestFrame.
std::vector<int> parseFrames(const std::string& text);

/// The text of frames, for messages: "1-3, 7, 10-20:5".
std::string describeFrames(const std::vector<int>& frames);

}  // namespace xrds
