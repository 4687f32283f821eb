// What a caller hears while programs are made, how he stops it, and where the caches go if they cannot lie where they
// should.
#include <gtest/gtest.h>

#include "tests/engine_programs.h"
#include "tests/harness.h"
#include "xrds/error.h"

#ifndef _WIN32
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "tests/environment_variable.h"
#include "tests/temporary_folder.h"

namespace xrds {
namespace {

namespace fs = std::filesystem;
using Phase = Preparation::Phase;

constexpr uint32_t kPrograms = 24;

/// Devices whose caches, and whose temporary folder, lie in a folder of their own.
class Start : public testing::Test {
 protected:
  Start() {
    fs::create_directories(folder_ / "temporary");
    fs::create_directories(folder_ / "mesa");
    std::ofstream(folder_ / "file") << "no folder";
  }

  Gpu open(const fs::path& cacheFolder, PreparationProgress onPreparation = {}) const {
    DeviceOptions options = test::gpuOptions();
    options.cacheFolder = cacheFolder;
    options.programs = test::engineProgram;
    options.onPreparation = std::move(onPreparation);
    return Gpu(std::move(options));
  }

  const test::TemporaryFolder folder_;
};

// Writes 2 * 0 + add + i to quad i + 1, by a program for each i.
void expectResults(Gpu& gpu, uint32_t add) {
  Buffer buffer(gpu, (kPrograms + 1) * kBindingAlignment);
  test::uploadFloats(buffer, 0, std::vector<float>(4, 0));
  std::vector<PlacedDispatch> dispatches;
  for (uint32_t i = 0; i < kPrograms; ++i)
    dispatches.push_back(test::twicePlus(buffer, 0, (i + 1) * kBindingAlignment, 1, add + i));
  Recording(gpu, dispatches).run();
  for (uint32_t i = 0; i < kPrograms; ++i)
    EXPECT_EQ(test::downloadFloats(buffer, (i + 1) * kBindingAlignment, 1)[0], static_cast<float>(add + i));
}

std::vector<Preparation> ofPhase(const std::vector<Preparation>& told, Phase phase) {
  std::vector<Preparation> found;
  for (const Preparation& each : told)
    if (each.phase == phase) found.push_back(each);
  return found;
}

TEST_F(Start, EveryProgramIsCounted) {
  const test::EnvironmentVariable mesa("MESA_SHADER_CACHE_DIR", folder_ / "mesa");
  std::vector<Preparation> told;
  Gpu gpu = open(folder_.path(), [&](const Preparation& now) { return told.push_back(now), true; });
  expectResults(gpu, 5000);
  for (const Phase phase : {Phase::pipelines, Phase::machineCode}) {
    if (phase == Phase::machineCode && gpu.description().kind != DeviceKind::cpu) continue;
    const auto rows = ofPhase(told, phase);
    ASSERT_FALSE(rows.empty());
    EXPECT_EQ(rows.front().done, 0u);
    EXPECT_EQ(rows.back().done, rows.back().total);
    EXPECT_LE(rows.back().total, size_t{kPrograms});
    for (size_t i = 1; i < rows.size(); ++i) EXPECT_GE(rows[i].done, rows[i - 1].done);
  }
  EXPECT_EQ(ofPhase(told, Phase::pipelines).back().total, size_t{kPrograms});
  told.clear();
  expectResults(gpu, 5000);
  EXPECT_TRUE(told.empty());  // nothing is left to make
}

TEST_F(Start, WhoCancelsCanGoOnLater) {
  const test::EnvironmentVariable mesa("MESA_SHADER_CACHE_DIR", folder_ / "mesa");
  std::optional<Phase> cancelled;
  Gpu gpu = open(folder_.path(), [&](const Preparation& now) { return now.phase != cancelled; });
  const bool compiles = gpu.description().kind == DeviceKind::cpu;
  for (const Phase phase : {Phase::pipelines, Phase::machineCode}) {
    if (phase == Phase::machineCode && !compiles) continue;
    cancelled = phase;
    EXPECT_THROW(expectResults(gpu, 6000), Cancelled);
  }
  cancelled.reset();
  expectResults(gpu, 6000);
}

bool holdsPipelines(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".bin") return true;
  return false;
}

TEST_F(Start, AFolderThatCannotBeWrittenIsNamedAndReplaced) {
  const test::EnvironmentVariable temporary("TMPDIR", folder_ / "temporary");
  const test::EnvironmentVariable mesa("MESA_SHADER_CACHE_DIR", "");
  const fs::path replacement = folder_ / "temporary" / ("xrds-cache-" + std::to_string(geteuid()));
  for (int start = 0; start < 2; ++start) {
    Gpu gpu = open(folder_ / "file" / "cache");
    ASSERT_EQ(gpu.notes().size(), 1u);
    EXPECT_NE(gpu.notes()[0].find("'" + (folder_ / "file" / "cache").string() + "'"), std::string::npos);
    EXPECT_NE(gpu.notes()[0].find("'" + replacement.string() + "'"), std::string::npos);
    EXPECT_EQ(std::string(std::getenv("MESA_SHADER_CACHE_DIR")).rfind(replacement.string(), 0), 0u);
    expectResults(gpu, 7000);
  }
  EXPECT_TRUE(holdsPipelines(replacement));
  EXPECT_EQ(fs::status(replacement).permissions() & fs::perms::all, fs::perms::owner_all);
}

TEST_F(Start, ATemporaryFolderThatOthersCanWriteIsNotTaken) {
  const test::EnvironmentVariable temporary("TMPDIR", folder_ / "temporary");
  const test::EnvironmentVariable mesa("MESA_SHADER_CACHE_DIR", "");
  const fs::path offered = folder_ / "temporary" / ("xrds-cache-" + std::to_string(geteuid()));
  fs::create_directory(offered);
  fs::permissions(offered, fs::perms::all);
  Gpu gpu = open(folder_ / "file" / "cache");
  ASSERT_EQ(gpu.notes().size(), 1u);
  EXPECT_NE(gpu.notes()[0].find("again at every start"), std::string::npos) << gpu.notes()[0];
  expectResults(gpu, 8000);
  EXPECT_TRUE(fs::is_empty(offered));
}

TEST_F(Start, AShaderCacheOfTheUsersThatCannotBeWrittenIsNamed) {
  const test::EnvironmentVariable mesa("MESA_SHADER_CACHE_DIR", folder_ / "file" / "mesa");
  const Gpu gpu = open(folder_.path());
  ASSERT_EQ(gpu.notes().size(), 1u);
  EXPECT_NE(gpu.notes()[0].find("'" + (folder_ / "file" / "mesa").string() + "'"), std::string::npos);
  EXPECT_EQ(std::string(std::getenv("MESA_SHADER_CACHE_DIR")).rfind(folder_.path().string() + "/mesa", 0), 0u);
}

TEST_F(Start, AFolderThatCanBeWrittenIsNotSpokenOf) {
  const test::EnvironmentVariable mesa("MESA_SHADER_CACHE_DIR", folder_ / "mesa");
  EXPECT_TRUE(open(folder_ / "new").notes().empty());
}

}  // namespace
}  // namespace xrds
#endif
