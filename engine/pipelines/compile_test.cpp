// Compilation in parallel: the same results as one after the other, and the same error whichever thread meets it.
#include <gtest/gtest.h>

#include "tests/engine_programs.h"
#include "tests/environment_variable.h"
#include "tests/harness.h"
#include "tests/temporary_folder.h"

namespace xrds {
namespace {

constexpr uint32_t kPrograms = 48;

// Dispatch i writes `add` + i to quad i + 1: each a program of its own.
std::vector<PlacedDispatch> manyPrograms(const Buffer& buffer, uint32_t add) {
  std::vector<PlacedDispatch> dispatches;
  for (uint32_t i = 0; i < kPrograms; ++i)
    dispatches.push_back(test::twicePlus(buffer, 0, (i + 1) * kBindingAlignment, 1, add + i));
  return dispatches;
}

void expectResults(Gpu& gpu, uint32_t add) {
  Buffer buffer(gpu, (kPrograms + 1) * kBindingAlignment);
  test::uploadFloats(buffer, 0, std::vector<float>(4, 0));
  Recording(gpu, manyPrograms(buffer, add)).run();
  for (uint32_t i = 0; i < kPrograms; ++i)
    EXPECT_EQ(test::downloadFloats(buffer, (i + 1) * kBindingAlignment, 1)[0], static_cast<float>(add + i));
}

TEST(Compile, ManyProgramsGiveTheirResults) { expectResults(test::gpu(), 2000); }

#ifndef _WIN32
// With no disk cache to help, further devices compile too, and hand over what they made.
TEST(Compile, AnEmptyCacheGivesTheSameResults) {
  const test::TemporaryFolder folder;
  const test::EnvironmentVariable mesa("MESA_SHADER_CACHE_DIR", folder.path());
  DeviceOptions options = test::gpuOptions();
  options.cacheFolder = folder.path();
  options.programs = test::engineProgram;
  Gpu gpu(std::move(options));
  expectResults(gpu, 3000);
  expectResults(gpu, 3000 + kPrograms / 2);
}
#endif

std::string failureOf(const std::vector<PlacedDispatch>& dispatches) {
  try {
    Recording(test::gpu(), dispatches);
  } catch (const std::logic_error& error) {
    return error.what();
  }
  return "none";
}

TEST(Compile, TheFirstBrokenProgramIsReportedEveryTime) {
  Buffer buffer(test::gpu(), (kPrograms + 1) * kBindingAlignment);
  auto dispatches = manyPrograms(buffer, 4000);
  dispatches[7].dispatch.program = "zebra";
  dispatches[40].dispatch.program = "ant";
  for (int attempt = 0; attempt < 5; ++attempt) EXPECT_NE(failureOf(dispatches).find("\"zebra\""), std::string::npos);
  expectResults(test::gpu(), 4000);
}

}  // namespace
}  // namespace xrds
