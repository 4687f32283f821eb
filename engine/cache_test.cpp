#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "engine/cache_file.h"
#include "tests/engine_programs.h"
#include "tests/environment_variable.h"
#include "tests/harness.h"
#include "tests/temporary_folder.h"

namespace xrds {
namespace {

namespace fs = std::filesystem;

class CacheFile : public testing::Test {
 protected:
  fs::path file() const { return folder_ / "cache.bin"; }
  std::vector<std::byte> read(std::string_view key = "device") const { return readCacheFile(file(), key); }
  bool write(std::string_view key = "device") const { return writeCacheFile(file(), key, content_); }

  std::string text() const {
    std::ifstream in(file(), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void setText(const std::string& text) const { std::ofstream(file(), std::ios::binary) << text; }

  const test::TemporaryFolder folder_;
  std::vector<std::byte> content_{std::byte{1}, std::byte{2}, std::byte{3}, std::byte{250}};
};

TEST_F(CacheFile, GivesBackWhatWasWritten) {
  EXPECT_TRUE(write());
  EXPECT_EQ(read(), content_);
}

TEST_F(CacheFile, LeavesNothingElseBehind) {
  write();
  write();
  EXPECT_EQ(folder_.fileCount(), 1u);
}

TEST_F(CacheFile, MissingIsEmpty) { EXPECT_TRUE(read().empty()); }

TEST_F(CacheFile, OfAnotherDeviceIsIgnored) {
  write("another device");
  EXPECT_TRUE(read().empty());
}

TEST_F(CacheFile, AnyChangedByteIsNoticed) {
  write();
  const std::string whole = text();
  for (size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x40);
    setText(damaged);
    EXPECT_TRUE(read().empty()) << "byte " << i;
  }
}

TEST_F(CacheFile, AnyTruncationIsNoticed) {
  write();
  const std::string whole = text();
  for (size_t size = 0; size < whole.size(); ++size) {
    setText(whole.substr(0, size));
    EXPECT_TRUE(read().empty()) << size << " bytes";
  }
  setText(whole + "x");
  EXPECT_TRUE(read().empty());
}

TEST_F(CacheFile, AFolderThatCannotBeMadeIsNoError) {
  write();
  EXPECT_FALSE(writeCacheFile(file() / "inside a file" / "cache.bin", "device", content_));
}

// One dispatch on a device whose caches lie in the folder.
std::vector<float> runWithCache(const fs::path& folder, uint32_t quads = 1) {
  Gpu gpu({.cacheFolder = folder, .programs = test::engineProgram});
  const uint64_t target = uint64_t{ceilDivide(quads * 16, kBindingAlignment)} * kBindingAlignment;
  Buffer buffer(gpu, target + quads * 16);
  test::uploadFloats(buffer, 0, std::vector<float>{1, 2, 3, 4});
  const PlacedDispatch placed = test::twicePlus(buffer, 0, target, quads, 1);
  Recording(gpu, {&placed, 1}).run();
  return test::downloadFloats(buffer, target, 4);
}

TEST_F(CacheFile, DamagedPipelineCacheIsReplacedAndHarmless) {
  const std::vector<float> expected{3, 5, 7, 9};
  EXPECT_EQ(runWithCache(folder_.path()), expected);
  fs::path pipelines;
  for (const auto& entry : fs::directory_iterator(folder_.path()))
    if (entry.path().extension() == ".bin") pipelines = entry.path();
  ASSERT_FALSE(pipelines.empty());
  const auto size = fs::file_size(pipelines);

  EXPECT_EQ(runWithCache(folder_.path()), expected);
  std::ofstream(pipelines, std::ios::binary) << "not a cache";
  EXPECT_EQ(runWithCache(folder_.path()), expected);
  EXPECT_EQ(fs::file_size(pipelines), size);
}

#ifndef _WIN32
constexpr const char* kShaderCache = "MESA_SHADER_CACHE_DIR";

// Texel ranges whose sizes, and buffers whose sizes, Mesa's cache key tells apart.
TEST_F(CacheFile, AnotherSizeCompilesNothingAnew) {
  if (test::gpu().description().kind != DeviceKind::cpu) GTEST_SKIP() << "not Mesa's CPU driver";
  const auto compiled = [&](uint32_t quads) {
    const test::EnvironmentVariable mesa(kShaderCache, folder_.path());
    EXPECT_EQ(runWithCache(folder_.path(), quads), (std::vector<float>{3, 5, 7, 9}));
    const fs::recursive_directory_iterator files(folder_.path());
    return std::count_if(begin(files), end(files), [](const auto& entry) { return entry.is_regular_file(); });
  };
  const auto once = compiled(16);
  EXPECT_GT(once, 1);
  for (const uint32_t quads : {1, 17, 48, 4096, 4097, 8192}) EXPECT_EQ(compiled(quads), once) << quads << " quads";
}

TEST_F(CacheFile, ASecondDeviceKeepsTheUsersShaderCache) {
  const test::EnvironmentVariable mesa(kShaderCache, folder_ / "users");
  for (int device = 0; device < 2; ++device) {
    EXPECT_EQ(runWithCache(folder_ / "ours"), (std::vector<float>{3, 5, 7, 9}));
    EXPECT_EQ(std::string(std::getenv(kShaderCache)).rfind(folder_ / "users", 0), 0u);
  }
}
#endif

}  // namespace
}  // namespace xrds
