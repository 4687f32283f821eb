#include "sequence/assembly_line.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <set>
#include <stdexcept>

namespace xrds {
namespace {

using Stages = LineStages<int, long>;

TEST(AssemblyLine, EveryFrameGoesThroughAllStages) {
  std::mutex access;
  std::set<long> written;
  std::vector<Outcome> outcomes;
  const Stages stages{.read = [](size_t index) { return std::optional(static_cast<int>(index)); },
                      .compute = [](int value, size_t) { return 10L * value; },
                      .write =
                          [&](long value, size_t index) {
                            const std::lock_guard lock(access);
                            EXPECT_EQ(value, static_cast<long>(10 * index));
                            written.insert(value);
                          }};
  runLine<int, long>(50, {.readers = 2, .workers = 3, .writers = 2}, stages, [&](const Outcome& outcome) {
    outcomes.push_back(outcome);
    return true;
  });
  EXPECT_EQ(written.size(), 50U);
  ASSERT_EQ(outcomes.size(), 50U);
  for (const Outcome& outcome : outcomes) {
    EXPECT_EQ(outcome.state, Outcome::State::done);
    EXPECT_LT(outcome.worker, 3U);
  }
}

TEST(AssemblyLine, AFailureOrASkipIsOfThatFrameAlone) {
  std::vector<Outcome> outcomes(40);
  std::atomic<int> written = 0;
  const auto failsAt = [](size_t index, size_t rest) {
    if (index % 4 == rest) throw std::runtime_error("frame " + std::to_string(index));
  };
  const Stages stages{.read =
                          [&](size_t index) {
                            failsAt(index, 0);
                            return index == 21 ? std::nullopt : std::optional(static_cast<int>(index));
                          },
                      .compute =
                          [&](int value, size_t) {
                            failsAt(static_cast<size_t>(value), 2);
                            return long{value};
                          },
                      .write =
                          [&](long, size_t index) {
                            failsAt(index, 3);
                            ++written;
                          }};
  runLine<int, long>(40, {}, stages, [&](const Outcome& outcome) {
    outcomes[outcome.index] = outcome;
    return true;
  });
  EXPECT_EQ(written, 9);
  for (size_t i = 0; i < outcomes.size(); ++i) {
    const bool fails = i % 4 != 1;
    EXPECT_EQ(outcomes[i].state, fails     ? Outcome::State::failed
                                 : i == 21 ? Outcome::State::skipped
                                           : Outcome::State::done);
    if (!fails) continue;
    EXPECT_EQ(outcomes[i].stage, i % 4 == 0 ? Stage::read : i % 4 == 2 ? Stage::compute : Stage::write);
    EXPECT_THROW(std::rethrow_exception(outcomes[i].error), std::runtime_error);
  }
}

TEST(AssemblyLine, FewFramesAreInMemoryWhileWritingIsSlow) {
  std::atomic<int> alive = 0, most = 0;
  const Stages stages{.read =
                          [&](size_t index) {
                            most = std::max<int>(most, ++alive);
                            return std::optional(static_cast<int>(index));
                          },
                      .compute = [](int value, size_t) { return long{value}; },
                      .write =
                          [&](long, size_t) {
                            std::this_thread::sleep_for(std::chrono::milliseconds(2));
                            --alive;
                          }};
  runLine<int, long>(60, {.readers = 2, .workers = 1, .writers = 1}, stages, [](const Outcome&) { return true; });
  EXPECT_EQ(alive, 0);
  EXPECT_LE(most, 8);  // 4 threads, and 2 + 2 between them
}

// Frame 2 is read while 1 is computed and 0 written: each of the three waits for the other two.
TEST(AssemblyLine, StagesOfDifferentFramesRunAtOnce) {
  std::mutex access;
  std::condition_variable arrived;
  int there = 0;
  const auto meetsOthers = [&] {
    std::unique_lock lock(access);
    ++there;
    arrived.notify_all();
    return arrived.wait_for(lock, std::chrono::seconds(30), [&] { return there == 3; });
  };
  std::atomic<int> met = 0;
  const auto meet = [&](bool wanted) { met += wanted && meetsOthers() ? 1 : 0; };
  const Stages stages{.read = [&](size_t frame) { return meet(frame == 2), std::optional(static_cast<int>(frame)); },
                      .compute = [&](int frame, size_t) { return meet(frame == 1), 1L; },
                      .write = [&](long, size_t frame) { meet(frame == 0); }};
  runLine<int, long>(4, {}, stages, [](const Outcome&) { return true; });
  EXPECT_EQ(met, 3);
}

TEST(AssemblyLine, StopsWhenItIsTold) {
  std::atomic<int> begun = 0, ended = 0;
  const Stages stages{.read = [&](size_t) { return ++begun, std::optional(1); },
                      .compute = [](int, size_t) { return 1L; },
                      .write = [](long, size_t) {}};
  runLine<int, long>(1000, {}, stages, [&](const Outcome&) { return ++ended < 5; });
  EXPECT_EQ(begun, ended);
  EXPECT_LT(ended, 20);
}

TEST(AssemblyLine, ReadersAndWritersLeaveCoresToTheWorkers) {
  EXPECT_EQ(threadsFor(1, 2).readers, 1U);
  EXPECT_EQ(threadsFor(3, 64).readers, 4U);
  EXPECT_EQ(threadsFor(3, 64).workers, 3U);
  EXPECT_EQ(threadsFor(0, 0).writers, 1U);
}

}  // namespace
}  // namespace xrds
