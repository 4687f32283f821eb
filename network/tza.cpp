#include "network/tza.h"

#include <algorithm>
#include <cstring>

#include "engine/bytes.h"
#include "xrds/error.h"

namespace xrds {
namespace {

constexpr uint16_t kMagic = 0x41D7;
constexpr uint8_t kVersion = 2;
constexpr size_t kHeadBytes = 12;
constexpr uint32_t kMostTensors = 1024, kLongestName = 64, kLargestSide = 4096;

/// Reads numbers from front to back.
class Reader {
 public:
  Reader(std::span<const std::byte> bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  template <class T>
  T next() {
    T number;
    std::memcpy(&number, take(sizeof(T)).data(), sizeof(T));
    return number;
  }
  std::string text(size_t length) {
    const auto taken = take(length);
    return {reinterpret_cast<const char*>(taken.data()), length};
  }
  void seek(uint64_t offset) {
    if (offset > bytes_.size()) throw truncated();
    at_ = offset;
  }
  Error truncated() const { return Error(name_ + " points outside of itself: it is truncated or damaged."); }

 private:
  std::span<const std::byte> take(size_t count) {
    if (count > bytes_.size() - at_) throw truncated();
    at_ += count;
    return bytes_.subspan(at_ - count, count);
  }
  std::span<const std::byte> bytes_;
  const std::string& name_;
  size_t at_ = 0;
};

bool isPlain(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.';
  });
}

/// The bytes of a tensor in the archive.
struct Range {
  uint64_t begin = 0, end = 0;
};

void checkApart(std::vector<Range> ranges, const std::string& name) {
  std::sort(ranges.begin(), ranges.end(), [](const Range& a, const Range& b) { return a.begin < b.begin; });
  for (size_t i = 1; i < ranges.size(); ++i)
    if (ranges[i].begin < ranges[i - 1].end) throw Error(name + " has tensors that share bytes.");
}

}  // namespace

bool isTza(std::span<const std::byte> bytes) {
  if (bytes.size() < kHeadBytes) return false;
  uint16_t magic = 0;
  std::memcpy(&magic, bytes.data(), sizeof magic);
  return magic == kMagic && std::to_integer<uint8_t>(bytes[2]) == kVersion;
}

TensorFile parseTza(std::span<const std::byte> bytes, const std::string& name) {
  if (!isTza(bytes)) throw Error(name + " is no TZA archive of version 2.");
  Reader reader(bytes, name);
  reader.seek(4);
  reader.seek(reader.next<uint64_t>());
  const auto count = reader.next<uint32_t>();
  if (count > kMostTensors) throw Error(name + " claims " + std::to_string(count) + " tensors, which is too many.");
  TensorFile file;
  std::vector<Range> ranges;
  for (uint32_t i = 0; i < count; ++i) {
    const auto length = reader.next<uint16_t>();
    const std::string key = reader.text(std::min<size_t>(length, kLongestName + 1));
    if (length > kLongestName || !isPlain(key)) throw Error(name + " has a tensor with a name that is no name.");
    const std::string what = name + ": tensor '" + key + "'";
    const auto rank = reader.next<uint8_t>();
    if (rank != 1 && rank != 4) throw Error(what + " has " + std::to_string(rank) + " dimensions, expected 1 or 4.");
    StoredTensor tensor;
    uint64_t elements = 1;
    for (uint32_t side = 0; side < rank; ++side) {
      tensor.shape.push_back(reader.next<uint32_t>());
      if (tensor.shape.back() == 0 || tensor.shape.back() > kLargestSide)
        throw Error(what + " has a side of " + std::to_string(tensor.shape.back()) + ", which no network has.");
      elements *= tensor.shape.back();  // at most 2^48
    }
    if (reader.text(rank) != (rank == 1 ? "x" : "oihw")) throw Error(what + " has an unknown layout.");
    const std::string type = reader.text(1);
    if (type != "h" && type != "f") throw Error(what + " is of an unknown type.");
    const DataType stored = type == "h" ? DataType::f16 : DataType::f32;
    const auto offset = reader.next<uint64_t>();
    if (offset > bytes.size() || elements * byteSize(stored) > bytes.size() - offset) throw reader.truncated();
    ranges.push_back({offset, offset + elements * byteSize(stored)});
    tensor.values = decode(bytes.subspan(offset, elements * byteSize(stored)), stored);
    if (!file.tensors.emplace(key, std::move(tensor)).second) throw Error(what + " is there twice.");
  }
  checkApart(std::move(ranges), name);
  return file;
}

}  // namespace xrds
