#pragma once

#include <cstddef>
#include <functional>
#include <future>
#include <list>
#include <memory>
#include <mutex>
#include <utility>

namespace xrds {

/// Frames of a sequence that several others need: each is read once as long as it is among those that were asked for
/// last, `kept` of them, by whichever thread asks first, while others wait. For several threads at once.
template <class Value>
class SharedReads {
 public:
  using Shared = std::shared_ptr<const Value>;

  SharedReads(size_t kept, std::function<Value(int frame)> read) : kept_(kept), read_(std::move(read)) {}

  /// How many are kept from now on.
  void keep(size_t kept) {
    const std::lock_guard lock(mutex_);
    kept_ = kept;
    while (recent_.size() > kept_) recent_.pop_back();
  }

  /// Throws what reading it threw, again and again while it is kept.
  Shared get(int frame) {
    std::promise<Shared> mine;
    std::shared_future<Shared> value;
    bool isMine = false;
    {
      const std::lock_guard lock(mutex_);
      auto found = recent_.begin();
      while (found != recent_.end() && found->first != frame) ++found;
      isMine = found == recent_.end();
      if (isMine) {
        recent_.emplace_front(frame, mine.get_future().share());
        if (recent_.size() > kept_) recent_.pop_back();
      } else {
        recent_.splice(recent_.begin(), recent_, found);
      }
      value = recent_.front().second;
    }
    if (isMine) try {
        mine.set_value(std::make_shared<const Value>(read_(frame)));
      } catch (...) {
        mine.set_exception(std::current_exception());
      }
    return value.get();
  }

 private:
  size_t kept_;
  const std::function<Value(int)> read_;
  std::mutex mutex_;
  std::list<std::pair<int, std::shared_future<Shared>>> recent_;  // the last asked for first
};

}  // namespace xrds
