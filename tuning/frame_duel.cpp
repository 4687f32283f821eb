#include "tuning/frame_duel.h"

#include <chrono>
#include <cmath>
#include <random>

#include "checks/error_budget.h"
#include "tuning/timing.h"
#include "xrds/error.h"

namespace xrds {
namespace {

constexpr int kLeastRounds = 2, kMostRounds = 9;
constexpr double kSeconds = 8;  // after which no further round begins

/// Random pixels: radiance with highlights, and in [0, 1) what is beside it.
class RandomFrame {
 public:
  RandomFrame(const NetworkConfig& config, FrameShape frame) {
    fill(colour_, frame, 3);
    const FrameShape full{config.scale * frame.height, config.scale * frame.width};
    auxiliary_.resize(config.auxInputs.size());
    for (auto& image : auxiliary_) fill(image, full, 1);
    input_ = {{colour_.data(), frame.width, frame.height}};
    for (const auto& image : auxiliary_) input_.auxiliary.push_back({image.data(), full.width, full.height});
  }
  const FrameInput& input() const { return input_; }

 private:
  void fill(std::vector<float>& image, FrameShape shape, float most) {
    image.resize(size_t{3} * shape.height * shape.width);
    for (float& value : image) value = most * static_cast<float>(bits_() >> 8) * 0x1p-24F;
  }
  std::minstd_rand bits_{1};
  std::vector<float> colour_;
  std::vector<std::vector<float>> auxiliary_;
  FrameInput input_;
};

}  // namespace

FrameDuel frameDuel(Gpu& gpu, const NetworkModel& model, FrameShape frame, Precision precision,
                    const KernelTable& table, const std::function<bool()>& mayGoOn) {
  const RandomFrame pixels(model.config(), frame);
  const auto progress = [&](size_t, size_t) { return !mayGoOn || mayGoOn(); };
  std::optional<Session> fixed, tuned;
  openSession(fixed, gpu, model, frame, {.precision = precision});
  openSession(tuned, gpu, model, frame, {.precision = precision, .kernels = table, .lender = &*fixed});
  const size_t count = 3 * fixed->graph().output.pixelCount();
  std::vector<float> expected(count), found(count);
  const auto run = [&](Session& session, std::vector<float>& output) {
    const auto start = std::chrono::steady_clock::now();
    if (!session.run(pixels.input(), output, progress))
      throw Cancelled("The tuning was cancelled: nothing is wrong with the device.");
    return secondsSince(start);
  };
  run(*fixed, expected);  // the first run of each warms up
  run(*tuned, found);
  FrameDuel duel;
  double squares = 0, power = 0;
  for (size_t i = 0; i < count; ++i) {
    squares += (double{found[i]} - expected[i]) * (double{found[i]} - expected[i]);
    power += double{expected[i]} * expected[i];
  }
  duel.difference = std::sqrt(squares / power);
  duel.isSame = duel.difference <= 2 * boundOf(kNetworkBudget, precision);
  std::vector<double> times, fixedTimes;
  const auto start = std::chrono::steady_clock::now();
  for (int round = 0; round < kMostRounds && (round < kLeastRounds || secondsSince(start) < kSeconds); ++round)
    for (const bool first : {round % 2 == 0, round % 2 != 0})
      (first ? times : fixedTimes).push_back(first ? run(*tuned, found) : run(*fixed, expected));
  duel.seconds = median(times);
  duel.fixedSeconds = median(fixedTimes);
  return duel;
}

}  // namespace xrds
