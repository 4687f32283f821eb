#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

namespace xrds {

/// A queue between threads that holds at most so many: who puts more waits. All members may be called by any thread.
template <class T>
class BoundedQueue {
 public:
  explicit BoundedQueue(size_t most) : most_(most) {}

  /// Waits for a place. Does nothing once the queue is closed.
  void put(T value) {
    std::unique_lock lock(access_);
    changed_.wait(lock, [&] { return closed_ || values_.size() < most_; });
    if (closed_) return;
    values_.push_back(std::move(value));
    changed_.notify_all();
  }

  /// Waits for a value; nothing once the queue is closed and empty.
  std::optional<T> take() {
    std::unique_lock lock(access_);
    changed_.wait(lock, [&] { return closed_ || !values_.empty(); });
    if (values_.empty()) return {};
    std::optional<T> value(std::move(values_.front()));
    values_.pop_front();
    changed_.notify_all();
    return value;
  }

  /// Nothing more will be put; what is there can still be taken.
  void close() {
    const std::lock_guard lock(access_);
    closed_ = true;
    changed_.notify_all();
  }

 private:
  std::mutex access_;
  std::condition_variable changed_;
  std::deque<T> values_;
  const size_t most_;
  bool closed_ = false;
};

}  // namespace xrds
