#include "sequence/frame_range.h"

#include <cctype>
#include <charconv>
#include <cstdint>
#include <optional>
#include <unordered_set>

#include "xrds/error.h"

namespace xrds {
namespace {

class Reader {
 public:
  explicit Reader(const std::string& text) : text_(text) {}

  bool atEnd() {
    skipSpaces();
    return place_ == text_.size();
  }

  bool takes(char symbol) {
    skipSpaces();
    if (place_ == text_.size() || text_[place_] != symbol) return false;
    ++place_;
    return true;
  }

  int number() {
    skipSpaces();
    int value = 0;
    const char* begin = text_.data() + place_;
    const auto [end, failure] = std::from_chars(begin, text_.data() + text_.size(), value);
    if (failure != std::errc() ||
        (end != text_.data() + text_.size() && std::isalpha(static_cast<unsigned char>(*end))))
      fail("expected a number " + where());
    if (value > kLargestFrame || value < -kLargestFrame)
      fail("expected numbers of at most " + std::to_string(kLargestFrame) + ", found " + std::to_string(value));
    place_ += static_cast<size_t>(end - begin);
    return value;
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw Error("'" + text_ + "' names no frames: " + what + "; give them as 1-240, 1-240:2 or 1-3,7,10-20:5.");
  }

 private:
  std::string where() const { return place_ == text_.size() ? "at the end" : "at '" + text_.substr(place_, 12) + "'"; }

  void skipSpaces() {
    while (place_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[place_]))) ++place_;
  }

  const std::string& text_;
  size_t place_ = 0;
};

// "a", or from a to b by the step.
struct Item {
  int64_t first = 0, last = 0, step = 1;
};

Item readItem(Reader& reader) {
  Item item;
  item.first = item.last = reader.number();
  if (!reader.takes('-')) return item;
  item.last = reader.number();
  if (reader.takes(':')) item.step = reader.number();
  if (item.step == 0 || (item.last - item.first) * item.step < 0)
    reader.fail("a step of " + std::to_string(item.step) + " does not lead from " + std::to_string(item.first) +
                " to " + std::to_string(item.last));
  return item;
}

// How far the frames from `begin` on go by one step: the place after the last of them.
size_t endOfRun(const std::vector<int>& frames, size_t begin) {
  if (begin + 1 >= frames.size()) return frames.size();
  const int64_t step = int64_t{frames[begin + 1]} - frames[begin];
  size_t end = begin + 2;
  while (end < frames.size() && int64_t{frames[end]} - frames[end - 1] == step) ++end;
  return end;
}

}  // namespace

std::vector<int> parseFrames(const std::string& text) {
  Reader reader(text);
  std::vector<int> frames;
  std::unordered_set<int> seen;
  do {
    const Item item = readItem(reader);
    for (int64_t frame = item.first; item.step > 0 ? frame <= item.last : frame >= item.last; frame += item.step) {
      if (!seen.insert(static_cast<int>(frame)).second) continue;
      if (frames.size() == kMostFrames) reader.fail("expected at most " + std::to_string(kMostFrames) + " frames");
      frames.push_back(static_cast<int>(frame));
    }
  } while (reader.takes(',') || !reader.atEnd());
  return frames;
}

std::string describeFrames(const std::vector<int>& frames) {
  std::string text;
  for (size_t begin = 0; begin < frames.size();) {
    size_t end = endOfRun(frames, begin);
    const int64_t step = end - begin > 1 ? int64_t{frames[begin + 1]} - frames[begin] : 1;
    if (end - begin == 2 && step != 1) end = begin + 1;  // "1, 7", not "1-7:6"
    text += (text.empty() ? "" : ", ") + std::to_string(frames[begin]);
    if (end - begin > 1) text += "-" + std::to_string(frames[end - 1]);
    if (end - begin > 1 && step != 1) text += ":" + std::to_string(step);
    begin = end;
  }
  return text;
}

}  // namespace xrds
