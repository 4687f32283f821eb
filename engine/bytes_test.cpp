#include "engine/bytes.h"

#include <gtest/gtest.h>

#include <string_view>

namespace xrds {
namespace {

const std::vector<float> kNumbers{0, -1.5F, 65504, 0x1p-24F};  // binary16 holds each

TEST(Bytes, DecodeToWhatWasEncoded) {
  for (const DataType type : {DataType::f32, DataType::f16}) {
    const auto bytes = encode(kNumbers, type);
    EXPECT_EQ(bytes.size(), kNumbers.size() * byteSize(type));
    EXPECT_EQ(decode(bytes, type), kNumbers);
  }
}

TEST(Bytes, HaveThePublishedHash) {
  const auto bytesOf = [](std::string_view text) { return std::as_bytes(std::span(text)); };
  EXPECT_EQ(hashOf({}), 0xcbf29ce484222325);
  EXPECT_EQ(hashOf(bytesOf("foobar")), 0x85944171f73967e8);
  EXPECT_EQ(hashOf(bytesOf("bar"), hashOf(bytesOf("foo"))), hashOf(bytesOf("foobar")));
}

}  // namespace
}  // namespace xrds
