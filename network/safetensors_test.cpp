#include "network/safetensors.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "network/network_model.h"
#include "tests/temporary_folder.h"
#include "xrds/error.h"

namespace xrds {
namespace {

std::vector<std::byte> fileBytes(const std::string& header, size_t bodyBytes) {
  std::vector<std::byte> bytes(8 + header.size() + bodyBytes);
  const uint64_t size = header.size();
  std::memcpy(bytes.data(), &size, 8);
  std::memcpy(bytes.data() + 8, header.data(), header.size());
  return bytes;
}

std::string refusal(const std::string& header, size_t bodyBytes) {
  try {
    parseTensors(fileBytes(header, bodyBytes), "file");
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Safetensors, ReadsWhatItWrites) {
  TensorFile file;
  file.metadata = {{"format", "xrds"}};
  file.tensors["a"] = {{2, 3}, {1, -2, 0.5f, 65504, 6e-8f, 0}};
  file.tensors["b"] = {{1}, {3}};
  const test::TemporaryFolder folder;
  const auto path = folder / "tensors.safetensors";
  for (const DataType type : {DataType::f32, DataType::f16}) {
    writeTensors(path, file, type);
    const TensorFile read = readTensors(path);
    EXPECT_EQ(read.metadata, file.metadata);
    ASSERT_EQ(read.tensors.size(), 2u);
    EXPECT_EQ(read.tensors.at("a").shape, (std::vector<uint64_t>{2, 3}));
    for (size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(read.tensors.at("a").values[i], file.tensors["a"].values[i], type == DataType::f32 ? 0 : 3e-8);
  }
}

TEST(Safetensors, RefusesHostileHeaders) {
  EXPECT_NE(refusal("not json", 0).find("no readable"), std::string::npos);
  EXPECT_NE(refusal("[1, 2]", 0).find("no readable"), std::string::npos);
  EXPECT_NE(refusal(R"({"a":{"dtype":"F32","shape":[2],"data_offsets":[0,8]}})", 4).find("truncated"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"a":{"dtype":"F32","shape":[3],"data_offsets":[0,8]}})", 8).find("belies"), std::string::npos);
  EXPECT_NE(
      refusal(
          R"({"a":{"dtype":"F32","shape":[1],"data_offsets":[0,4]},"a":{"dtype":"F32","shape":[1],"data_offsets":[4,8]}})",
          8)
          .find("the tensor 'a' twice"),
      std::string::npos);
  EXPECT_NE(refusal(R"({"a":{"dtype":"F32","shape":[2],"data_offsets":[8,0]}})", 8).find("outside"), std::string::npos);
  EXPECT_NE(refusal(R"({"a":{"dtype":"I64","shape":[1],"data_offsets":[0,8]}})", 8).find("I64"), std::string::npos);
  EXPECT_NE(refusal(R"({"a":{"dtype":"F32","shape":[4294967296,4294967296],"data_offsets":[0,8]}})", 8).find("large"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"a":{"shape":[2],"data_offsets":[0,8]}})", 8).find("wrong or missing"), std::string::npos);
  EXPECT_NE(refusal(R"({"a":{"dtype":"F32","shape":[-1],"data_offsets":[0,8]}})", 8), "accepted");
  EXPECT_NE(refusal(R"({"a":{"dtype":"F32","shape":[9e72],"data_offsets":[0,8]}})", 8).find("no whole number"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"a":{"dtype":"F32","shape":[2],"data_offsets":[0,"8"]}})", 8).find("no whole number"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"a":7})", 8).find("wrong or missing"), std::string::npos);
  EXPECT_NE(
      refusal(
          R"({"a":{"dtype":"F32","shape":[2],"data_offsets":[0,8]},"b":{"dtype":"F32","shape":[2],"data_offsets":[0,8]}})",
          8)
          .find("share"),
      std::string::npos);
  EXPECT_THROW(parseTensors({}, "empty"), Error);
  EXPECT_THROW(readTensors("does/not/exist.safetensors"), Error);
}

TEST(Safetensors, NoByteFlipCrashes) {
  const test::TemporaryFolder folder;
  const auto path = folder / "flip.safetensors";
  NetworkConfig config{
      .scale = 2, .channels = 8, .auxChannels = 4, .groups = 1, .blocks = 1, .window = 4, .headChannels = 4};
  writeTensors(path, NetworkModel::random(config, 1).file(), DataType::f16);
  std::vector<char> text(std::filesystem::file_size(path));
  std::FILE* stream = std::fopen(path.string().c_str(), "rb");
  ASSERT_EQ(std::fread(text.data(), 1, text.size(), stream), text.size());
  std::fclose(stream);
  std::mt19937 random(3);
  int refused = 0;
  for (int trial = 0; trial < 400; ++trial) {
    auto damaged = text;
    if (trial % 4 == 0) damaged.resize(random() % damaged.size());
    for (int flips = 0; flips < 3 && !damaged.empty(); ++flips)
      damaged[random() % std::min<size_t>(damaged.size(), 6000)] ^= 1 << random() % 8;
    try {
      NetworkModel::fromTensors(parseTensors(std::as_bytes(std::span(damaged)), "damaged"), "damaged");
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 300);
}

}  // namespace
}  // namespace xrds
