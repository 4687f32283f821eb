#include "engine/parallel.h"

#include <algorithm>
#include <exception>
#include <thread>
#include <vector>

namespace xrds {

void inParallel(uint64_t count, uint64_t least, const std::function<void(uint64_t, uint64_t)>& work) {
  if (count == 0) return;
  constexpr uint64_t kMostThreads = 8;
  const uint64_t cores = std::clamp<uint64_t>(std::thread::hardware_concurrency(), 1, kMostThreads);
  const uint64_t parts = std::clamp<uint64_t>(count / std::max<uint64_t>(least, 1), 1, cores);
  const auto bound = [&](uint64_t part) { return count * part / parts; };
  std::vector<std::exception_ptr> failures(parts);
  const auto run = [&](uint64_t part) {
    try {
      work(bound(part), bound(part + 1));
    } catch (...) {
      failures[part] = std::current_exception();
    }
  };
  std::vector<std::thread> threads;
  uint64_t started = 1;
  try {
    threads.reserve(parts - 1);
    for (; started < parts; ++started) threads.emplace_back(run, started);
  } catch (const std::exception&) {  // no more threads are to be had, or no memory for them
  }
  run(0);
  for (uint64_t part = started; part < parts; ++part) run(part);
  for (std::thread& thread : threads) thread.join();
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

}  // namespace xrds
