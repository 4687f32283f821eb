// Tuning a small network, of which every kernel is compiled once for all tests.
#include "tuning/tuner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "engine/environment.h"
#include "engine/handles.h"
#include "shaders/programs.h"
#include "tests/environment_variable.h"
#include "tests/harness.h"
#include "tests/temporary_folder.h"
#include "tuning/frame_duel.h"
#include "xrds/error.h"

namespace xrds {
namespace {

namespace fs = std::filesystem;

constexpr FrameShape kFrame{16, 16};
constexpr FrameShape kMeasured{48, 48};  // where the difference between kernels shows

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

NetworkModel smallModel() {
  NetworkConfig config{.scale = 2, .channels = 16, .groups = 1, .blocks = 1, .headChannels = 16};
  config.auxInputs.clear();
  config.base = BaseImage::bicubic;
  config.block = BlockKind::rstb;
  return NetworkModel::random(config, 7);
}

class Tuner : public testing::Test {
 protected:
  void SetUp() override { open(); }

  void open(ProgramSource programs = embeddedProgram) {
    gpu_.reset();
    DeviceOptions options = test::gpuOptions();
    options.validation = false;
    options.onMessage = nullptr;
    options.cacheFolder = folder_.path();
    options.programs = std::move(programs);
    gpu_.emplace(std::move(options));
  }
  TuningRecord record() const { return tuningFileOf(*gpu_).read(); }
  TuningResult tuned(const TuningOptions& options = {}, FrameShape frame = kFrame) {
    return tune(*gpu_, model_, frame, options);
  }

  // One a width of vectors, which Mesa's keys leave out.
  const test::EnvironmentVariable shaders_{
      "MESA_SHADER_CACHE_DIR",
      (fs::path(testing::TempDir()) / ("xrds_tuner_shaders" + environmentVariable("LP_NATIVE_VECTOR_WIDTH"))).string()};
  const test::TemporaryFolder folder_;
  std::optional<Gpu> gpu_;
  const NetworkModel model_ = smallModel();
};

// The incumbent is the plain family, which has all operators; what wins is found by measuring alone.
TEST_F(Tuner, FindsTheLaneKernelsByItself) {
  if (gpu_->description().kind != DeviceKind::cpu) GTEST_SKIP() << "not a CPU device";
  DeviceTraits traits = gpu_->traits();
  traits.family = KernelFamily::plain;
  gpu_->setTraits(traits);
  const TuningResult result = tuned({}, kMeasured);
  double inLane = 0, all = 0;  // of the operators that have lane kernels of their own
  std::string others;
  for (const TunedShape& shape : result.shapes) {
    const bool isNetworks = shape.shape.starts_with("conv3x3") || shape.shape.starts_with("linear") ||
                            shape.shape.starts_with("window_attention");
    if (isNetworks) all += shape.fixedSeconds;
    if (isNetworks && shape.winner.kernel.family == KernelFamily::lane) inLane += shape.fixedSeconds;
    if (isNetworks && shape.winner.kernel.family != KernelFamily::lane)
      others += "\n" + shape.shape + ": " + shape.winner.program.name + " " +
                std::to_string(shape.winner.microseconds) + " of " + std::to_string(shape.winner.fixedMicroseconds);
    EXPECT_TRUE(shape.wrong.empty()) << shape.shape << " " << shape.wrong.front();
    EXPECT_TRUE(shape.winner.isFixed || shape.winner.microseconds < shape.winner.fixedMicroseconds) << shape.shape;
  }
  EXPECT_GT(inLane, 0.9 * all) << others;
  EXPECT_TRUE(result.frame.taken);
  EXPECT_LT(result.frame.seconds, result.frame.fixedSeconds);
  EXPECT_EQ(tunedKernels(*gpu_, model_, kMeasured, Precision::fp32), result.table);

  const FrameDuel duel = frameDuel(*gpu_, model_, kMeasured, Precision::fp32, result.table);
  EXPECT_TRUE(duel.isSame) << duel.difference;
  EXPECT_EQ(tuned({}, kMeasured).measured, 0u) << "all is known";
  EXPECT_EQ(tunedKernels(*gpu_, model_, {4 * kMeasured.height, 4 * kMeasured.width}, Precision::fp32), std::nullopt);
  EXPECT_EQ(tunedKernels(*gpu_, model_, kMeasured, Precision::fp16), std::nullopt);
}

TEST_F(Tuner, GoesOnWhereItWasInterrupted) {
  size_t calls = 0;
  EXPECT_THROW(tuned({.progress = [&](const TuningStep&) { return ++calls < 4; }}), Cancelled);
  EXPECT_FALSE(record().trying) << "it was compiled before";
  calls = 0;
  EXPECT_THROW(tuned({.progress = [&](const TuningStep&) { return ++calls < 40; }}), Cancelled);
  EXPECT_EQ(gpu_->handles().patienceSeconds, kUsualPatienceSeconds) << "frames may take longer than a kernel";
  const size_t known = record().findings.size();
  EXPECT_GT(known, 0u);
  EXPECT_FALSE(record().trying);
  EXPECT_TRUE(record().struckOff.empty());
  EXPECT_EQ(tunedKernels(*gpu_, model_, kFrame, Precision::fp32), std::nullopt);
  const TuningResult result = tuned();
  EXPECT_GT(result.measured, 0u);
  EXPECT_EQ(record().findings.size(), known + result.measured);
}

TEST_F(Tuner, AKernelThatLosesTheDeviceIsStruckOff) {
  size_t tries = 0;
  const TuningOptions options{.beforeRun = [&](const Dispatch& dispatch) {
    if (!contains(dispatch.program, "linear_tile")) return;
    ++tries;
    throw DeviceLost("the test loses the device");
  }};
  EXPECT_THROW(tuned(options), DeviceLost);
  ASSERT_EQ(record().struckOff.count("linear_tile_f32"), 1u);
  EXPECT_TRUE(contains(record().struckOff.at("linear_tile_f32").second, "the test loses the device"));
  open();
  const TuningResult result = tuned(options);
  EXPECT_EQ(tries, 1u) << "it is not tried again";
  EXPECT_EQ(result.struckOff.count("linear_tile_f32"), 1u);
  for (const TunedShape& shape : result.shapes) EXPECT_FALSE(contains(shape.winner.program.name, "linear_tile"));
}

// The device makes subgroups of one size, which no kernel of these families can tell.
TEST_F(Tuner, SizesOfSubgroupsAreProvenAndTimed) {
  DeviceTraits traits = gpu_->traits();
  traits.family = KernelFamily::plain;
  traits.leastSubgroup = traits.subgroupSize / 2;
  traits.mostSubgroup = traits.subgroupSize;
  traits.maxGroupSubgroups = traits.maxGroupInvocations;
  gpu_->setTraits(traits);
  bool hasFailed = false;
  const auto failsOnce = [&](const Dispatch& dispatch) {
    if (dispatch.subgroupSize == 0 || hasFailed) return;
    hasFailed = true;
    throw Error("the test's driver has no such subgroups");
  };
  tuned({.beforeRun = failsOnce});
  size_t right = 0, failed = 0;
  for (const auto& [key, found] : record().findings) {
    if (key.second.shape.subgroup == 0) continue;
    EXPECT_EQ(key.second.shape.subgroup, traits.leastSubgroup);
    EXPECT_NE(key.second.family, KernelFamily::lane);
    EXPECT_EQ(found.right, found.microseconds > 0);
    ++(found.right ? right : failed);
  }
  EXPECT_GT(right, 0u);
  EXPECT_EQ(failed, 1u);
}

// As if the process had been killed while it ran.
TEST_F(Tuner, AKernelThatEndedTheProcessIsStruckOff) {
  TuningRecord before;
  before.trying = stampOf(*gpu_, "conv3x3_tile_f32");
  ASSERT_TRUE(tuningFileOf(*gpu_).write(before));
  bool tried = false;
  const TuningResult result = tuned(
      {.beforeRun = [&](const Dispatch& dispatch) { tried = tried || contains(dispatch.program, "conv3x3_tile"); }});
  EXPECT_FALSE(tried);
  EXPECT_EQ(result.struckOff.count("conv3x3_tile_f32"), 1u);
}

TEST_F(Tuner, AFixedChoiceThatWasTriedWhenAProcessEndedIsTriedAgain) {
  const bool isLane = gpu_->traits().family == KernelFamily::lane;
  const std::string fixed = programName("fold", isLane ? KernelFamily::lane : KernelFamily::plain, DataType::f32);
  TuningRecord before;
  before.trying = stampOf(*gpu_, fixed);
  before.isFixedTried = true;
  ASSERT_TRUE(tuningFileOf(*gpu_).write(before));
  bool tried = false;
  const TuningResult result =
      tuned({.beforeRun = [&](const Dispatch& dispatch) { tried = tried || dispatch.program == fixed; }});
  EXPECT_TRUE(tried);
  EXPECT_TRUE(result.struckOff.empty());
  EXPECT_TRUE(record().suspects.empty()) << "it has done its work";
}

// Another kernel of the operator stands in for a driver that compiles wrongly.
TEST_F(Tuner, AWrongKernelIsNamedAndNotTaken) {
  const bool isCpu = gpu_->description().kind == DeviceKind::cpu;
  const std::string tried = isCpu ? "window_attention_lane_f32" : "window_attention_tile_f32";
  open([tried](std::string_view name) { return embeddedProgram(name == tried ? "window_attention_plain_f32" : name); });
  DeviceTraits traits = gpu_->traits();
  traits.family = KernelFamily::plain;
  gpu_->setTraits(traits);
  const TuningResult result = tuned();
  bool named = false;
  for (const TunedShape& shape : result.shapes) {
    EXPECT_NE(shape.winner.program.name, tried);
    for (const std::string& wrong : shape.wrong) named = named || contains(wrong, tried + ": ");
  }
  EXPECT_TRUE(named);
}

TEST_F(Tuner, UsesWhatItCannotKeep) {
  fs::create_directories(tuningFileOf(*gpu_).path());  // a folder in the place of the file
  const TuningResult result = tuned();
  EXPECT_FALSE(result.isKept);
  EXPECT_EQ(tunedKernels(*gpu_, model_, kFrame, Precision::fp32), result.table);
  fs::remove(tuningFileOf(*gpu_).path());
  EXPECT_TRUE(tuned().isKept);
}

TEST_F(Tuner, OneProcessAtATime) {
  const TuningOptions options{.progress = [&](const TuningStep&) {
    EXPECT_THROW(tuned(), Error);
    return false;
  }};
  EXPECT_THROW(tuned(options), Cancelled);
}

}  // namespace
}  // namespace xrds
