#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>

#include "sequence/bounded_queue.h"
#include "sequence/joined_threads.h"

namespace xrds {

/// What every frame of a line goes through.
enum class Stage : uint8_t { read, compute, write };
inline constexpr std::array<const char*, 3> kStageNames{"reading", "computing", "writing"};

/// What became of a frame: `done`, or `skipped` by its reading, or `failed` in `stage` with `error`.
struct Outcome {
  enum class State : uint8_t { done, skipped, failed };
  size_t index = 0, worker = 0;  // of the frame, and of the thread that computed it
  State state = State::done;
  Stage stage = Stage::write;
  std::exception_ptr error{};
  std::array<double, 3> seconds{};  // of each stage
};

/// Threads of each stage, at least one. No more frames than all threads together and as many again wait in between.
struct LineThreads {
  size_t readers = 1, workers = 1, writers = 1;
};

/// The threads of reading and writing that keep so many workers busy without taking their cores.
LineThreads threadsFor(size_t workers, size_t cores);

/// The work of each stage on the frame of an index. Reading may return nothing: the frame is skipped. Called by several
/// threads at once, `compute` by each worker for itself; what one throws fails that frame alone.
template <class Read, class Made>
struct LineStages {
  std::function<std::optional<Read>(size_t index)> read;
  std::function<Made(Read, size_t worker)> compute;
  std::function<void(Made, size_t index)> write;
};

/// Sends the frames 0 to count - 1 through the stages, several at once, in bounded memory; returns when all have ended.
/// `ended` hears of each, by one thread at a time; once it returns false no further frame is begun, and those that are
/// on their way are finished.
template <class Read, class Made>
void runLine(size_t count, const LineThreads& threads, const LineStages<Read, Made>& stages,
             const std::function<bool(const Outcome&)>& ended) {
  struct ReadFrame {
    Outcome outcome;
    Read value;
  };
  struct MadeFrame {
    Outcome outcome;
    Made value;
  };
  BoundedQueue<ReadFrame> read(threads.workers);
  BoundedQueue<MadeFrame> made(threads.writers);
  std::atomic<size_t> next{0};
  std::atomic<bool> stopped{false};
  std::mutex telling;

  const auto tell = [&](const Outcome& outcome) {
    const std::lock_guard lock(telling);
    if (!ended(outcome)) stopped = true;
  };
  // Runs a stage of a frame and keeps its time; tells of a failure and returns false.
  const auto runs = [&](Stage stage, Outcome& outcome, auto&& action) {
    const auto begin = std::chrono::steady_clock::now();
    try {
      action();
    } catch (...) {
      outcome.state = Outcome::State::failed;
      outcome.error = std::current_exception();
    }
    outcome.stage = stage;
    outcome.seconds[static_cast<size_t>(stage)] =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (outcome.state == Outcome::State::failed) tell(outcome);
    return outcome.state != Outcome::State::failed;
  };
  const auto readAll = [&] {
    for (size_t index = next++; index < count && !stopped; index = next++) {
      Outcome outcome{.index = index};
      std::optional<Read> value;
      if (!runs(Stage::read, outcome, [&] { value = stages.read(index); })) continue;
      if (value) {
        read.put({outcome, std::move(*value)});
      } else {
        outcome.state = Outcome::State::skipped;
        tell(outcome);
      }
    }
  };
  const auto computeAll = [&](size_t worker) {
    while (auto frame = read.take()) {
      frame->outcome.worker = worker;
      std::optional<Made> value;
      if (runs(Stage::compute, frame->outcome, [&] { value = stages.compute(std::move(frame->value), worker); }))
        made.put({frame->outcome, std::move(*value)});
    }
  };
  const auto writeAll = [&] {
    while (auto frame = made.take())
      if (runs(Stage::write, frame->outcome, [&] { stages.write(std::move(frame->value), frame->outcome.index); }))
        tell(frame->outcome);
  };

  JoinedThreads readers, workers, writers;
  for (size_t i = 0; i < threads.readers; ++i) readers.start(readAll);
  for (size_t i = 0; i < threads.workers; ++i) workers.start(computeAll, i);
  for (size_t i = 0; i < threads.writers; ++i) writers.start(writeAll);
  readers.join();
  read.close();
  workers.join();
  made.close();
}

}  // namespace xrds
