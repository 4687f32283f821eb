#include "engine/pipelines/preparation.h"

#include <chrono>
#include <condition_variable>
#include <mutex>

#include "xrds/error.h"

namespace xrds {
namespace {

struct Threads {
  std::vector<std::thread> running;
  ~Threads() {
    for (std::thread& thread : running) thread.join();
  }
};

}  // namespace

void PreparationReport::tell() {
  if (!cancelled_ && progress_ && !progress_({phase_, done_, total_})) cancelled_ = true;
}

void PreparationReport::await(size_t threadCount, const std::function<void(size_t)>& work) {
  constexpr std::chrono::milliseconds kInterval(100);
  std::mutex access;
  std::condition_variable returned;
  size_t left = threadCount;
  {
    Threads threads;
    const auto run = [&](size_t thread) {
      work(thread);
      const std::lock_guard lock(access);
      if (--left == 0) returned.notify_all();
    };
    tell();
    for (size_t i = progress_ ? 0 : 1; i < threadCount; ++i) threads.running.emplace_back(run, i);
    if (!progress_) run(0);
    std::unique_lock lock(access);
    while (!returned.wait_for(lock, kInterval, [&] { return left == 0; })) {
      lock.unlock();
      tell();
      lock.lock();
    }
  }
  tell();
  if (cancelled_) throw Cancelled("The preparation was cancelled: nothing is wrong with the device.");
}

}  // namespace xrds
