// tune: what it refuses, what it keeps, and that a picture of winners is right.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "tests/cli/frames.h"
#include "tests/cli/process.h"

namespace xrds::test {
namespace {

namespace fs = std::filesystem;

// A network of few operator shapes, each of which costs seconds.
const std::string kModel = XRDS_GOLDEN_FOLDER "/edsr_s4.model.safetensors";

class CliTune : public testing::Test {
 protected:
  // Caches of its own, but programs that are compiled once for all tests of the command.
  StartOptions start(const std::string& family = "") const {
    return {.environment = {{"XDG_CACHE_HOME", (folder_ / "cache").string()},
                            {"MESA_SHADER_CACHE_DIR", XRDS_TEST_CACHE "/xrds"},
                            {"XRDS_KERNEL_FAMILY", family}}};
  }
  Ended run(const std::vector<std::string>& arguments, const std::string& family = "") const {
    return runXrds(arguments, start(family));
  }
  // What tuning keeps: the text of its record, nothing before there is one.
  std::string record() const {
    std::error_code none;
    for (fs::recursive_directory_iterator entry(folder_ / "cache", none), end; !none && entry != end;
         entry.increment(none))
      if (entry->path().filename().string().starts_with("tuning-") && entry->path().extension() == ".bin") {
        std::ifstream in(entry->path(), std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
      }
    return "";
  }
  // A line for each kernel that was tried, its time with it.
  std::set<std::string> findings() const {
    std::set<std::string> found;
    std::istringstream lines(record());
    for (std::string line; std::getline(lines, line);)
      if (line.starts_with("finding\t")) found.insert(line);
    return found;
  }
  const TemporaryFolder folder_;
};

TEST_F(CliTune, RefusesWhatItCannotTune) {
  EXPECT_EQ(run({"tune", "--size", "big"}).exitCode, 2);
  EXPECT_EQ(run({"tune", "--precision", "fp8"}).exitCode, 2);
  EXPECT_EQ(run({"tune", "no-such-model"}).exitCode, 4);
  EXPECT_EQ(run({"tune", "--json", "x.txt"}).exitCode, 2);
  EXPECT_EQ(run({"upscale", "a.exr", "-o", "b.exr", "--tune", "perhaps"}).exitCode, 2);
  const Ended asked = run({"tune", "xrds-x4-nano", "--size", "128x128"}, "plain");
  EXPECT_EQ(asked.exitCode, 5);
  EXPECT_TRUE(contains(asked.error, "nothing to tune")) << asked.error;
}

TEST_F(CliTune, SaysHowItIsUsed) {
  const Ended help = run({"tune", "--help"});
  EXPECT_EQ(help.exitCode, 0);
  for (const char* part : {"MODEL", "--size", "--precision", "--anew", "--json", "--device", "--quiet", "xrds tune"})
    EXPECT_TRUE(contains(help.output, part)) << part;
}

TEST_F(CliTune, KeepsWhatItFoundWhichDoctorAndUpscaleUse) {
  const std::string json = (folder_ / "tune.json").string();
  const std::vector<std::string> command{"tune", kModel, "--size", "128x128", "--precision", "fp32", "--json", json};
  const Ended first = run(command);
  ASSERT_EQ(first.exitCode, 0) << first.error;
  EXPECT_TRUE(contains(first.output, "operator shapes")) << first.output;
  const auto read = [&] {
    std::ifstream in(json);
    return nlohmann::json::parse(in).at("tuned").at(0);
  };
  EXPECT_GT(read().at("kernelsTried").get<int>(), 0);
  EXPECT_GT(read().at("operators").size(), 5u);
  const Ended again = run(command);
  EXPECT_EQ(again.exitCode, 0);
  EXPECT_TRUE(contains(again.output, "All was known")) << again.output;
  EXPECT_EQ(read().at("kernelsTried").get<int>(), 0);

  const Ended doctor = run({"doctor", "--runs", "2"});
  EXPECT_TRUE(contains(doctor.output, "for " + kModel + ", fp32, 128 x 128")) << doctor.output;

  const std::string colour = (folder_ / "colour.exr").string(), aux = (folder_ / "aux.exr").string();
  const std::string tuned = (folder_ / "tuned.exr").string(), plain = (folder_ / "plain.exr").string();
  writeHalfEvenFrame(colour, aux, 45);
  const auto upscaled = [&](const std::string& out, const std::string& family) {
    return run({"upscale", colour, "-o", out, "--model", kModel, "--tune", "auto"}, family);
  };
  ASSERT_EQ(upscaled(tuned, "").exitCode, 0);
  ASSERT_EQ(upscaled(plain, "plain").exitCode, 0);
  EXPECT_EQ(run({"compare", tuned, plain, "--min-psnr", "90"}).exitCode, 0) << "the winners give another picture";
}

TEST_F(CliTune, WarnsOnceOfARecordThatItCannotWrite) {
  StartOptions full = start();
  full.largestFileBytes = 1000;
  const Ended ended = runXrds({"tune", kModel, "--size", "64x64"}, full);
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  const size_t first = ended.error.find("xrds: warning: what tuning found is not kept: '");
  ASSERT_NE(first, std::string::npos) << ended.error;
  EXPECT_EQ(ended.error.find("not kept", first + 40), std::string::npos) << ended.error;

  const std::string colour = (folder_ / "colour.exr").string(), aux = (folder_ / "aux.exr").string();
  writeHalfEvenFrame(colour, aux, 16);
  const Ended upscaled = runXrds(
      {"upscale", colour, "-o", (folder_ / "out.exr").string(), "--model", kModel, "--tune", "now", "--quiet"}, full);
  EXPECT_TRUE(contains(upscaled.error, "xrds: warning: what tuning found is not kept: '")) << upscaled.error;
}

TEST_F(CliTune, AClosedTerminalEndsItAsControlCDoes) {
  const Ended ended = killXrds(
      {"tune", kModel, "--size", "64x64", "--precision", "fp16"}, [&] { return !record().empty(); }, start(), SIGHUP);
  EXPECT_EQ(ended.exitCode, 130);
  EXPECT_FALSE(contains(record(), "trying"));
}

TEST_F(CliTune, AKilledTuningGoesOnWhereItStopped) {
  const std::string json = (folder_ / "tune.json").string();
  const std::vector<std::string> command{"tune", kModel, "--size", "64x64", "--precision", "fp16", "--json", json};
  const Ended killed = killXrds(
      command, [&] { return record().size() > 1000; }, start());
  ASSERT_EQ(killed.exitCode, 1009);
  const std::set<std::string> known = findings();
  EXPECT_FALSE(known.empty());
  const auto report = [&] {
    std::ifstream in(json);
    return nlohmann::json::parse(in).at("tuned").at(0);
  };
  ASSERT_EQ(run(command).exitCode, 0);
  const std::set<std::string> resumed = findings();
  EXPECT_TRUE(std::includes(resumed.begin(), resumed.end(), known.begin(), known.end()))
      << "what was known was tried again";
  EXPECT_GT(resumed.size(), known.size());
  EXPECT_EQ(report().at("kernelsTried").get<size_t>(), resumed.size() - known.size());
  EXPECT_LE(report().at("struckOff").size(), 1u) << "at most the kernel that ran when the process was killed";

  std::vector<std::string> anew = command;
  anew.emplace_back("--anew");
  ASSERT_EQ(run(anew).exitCode, 0);
  const std::set<std::string> all = findings();
  EXPECT_EQ(report().at("kernelsTried").get<size_t>(), all.size());
  EXPECT_FALSE(std::includes(all.begin(), all.end(), known.begin(), known.end())) << "nothing was tried anew";
  EXPECT_EQ(report().at("struckOff").size(), 0u);
}

}  // namespace
}  // namespace xrds::test
