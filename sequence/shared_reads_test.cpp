#include "sequence/shared_reads.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>

#include "sequence/joined_threads.h"

namespace xrds {
namespace {

TEST(SharedReads, ReadsEachFrameOnceWhileItIsKept) {
  std::atomic<int> reads{0};
  SharedReads<int> frames(3, [&](int frame) {
    ++reads;
    return 10 * frame;
  });
  for (const int frame : {1, 2, 3, 2, 1, 3}) EXPECT_EQ(*frames.get(frame), 10 * frame);
  EXPECT_EQ(reads, 3);
  EXPECT_EQ(*frames.get(4), 40);  // 2 was asked for the longest time ago
  EXPECT_EQ(*frames.get(1), 10);
  EXPECT_EQ(reads, 4);
  EXPECT_EQ(*frames.get(2), 20);
  EXPECT_EQ(reads, 5);
  frames.keep(1);  // 2
  EXPECT_EQ(*frames.get(2), 20);
  EXPECT_EQ(reads, 5);
  EXPECT_EQ(*frames.get(1), 10);
  EXPECT_EQ(reads, 6);
}

TEST(SharedReads, ThrowsWhatReadingThrew) {
  SharedReads<int> frames(2, [](int frame) -> int {
    if (frame == 1) throw std::runtime_error("bad");
    return frame;
  });
  EXPECT_THROW(frames.get(1), std::runtime_error);
  EXPECT_THROW(frames.get(1), std::runtime_error);
  EXPECT_EQ(*frames.get(2), 2);
}

TEST(SharedReads, ServesManyThreads) {
  std::atomic<int> reads{0}, wrong{0};
  SharedReads<int> frames(8, [&](int frame) {
    ++reads;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    return frame;
  });
  {
    JoinedThreads threads;
    for (int thread = 0; thread < 4; ++thread)
      threads.start([&] {
        for (int frame = 0; frame < 8; ++frame) wrong += *frames.get(frame) != frame;
      });
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(reads, 8);
}

}  // namespace
}  // namespace xrds
