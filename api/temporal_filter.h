#pragma once

#include <memory>

#include "engine/device.h"
#include "xrds/temporal_filter.h"

namespace xrds {

/// TemporalFilter of the public API, which documents what the functions do, on the engine's device.
class FrameMerger {
 public:
  using Frame = TemporalFilter::Frame;

  FrameMerger(Gpu& gpu, uint32_t width, uint32_t height, uint32_t scale);
  ~FrameMerger();
  FrameMerger(const FrameMerger&) = delete;
  FrameMerger& operator=(const FrameMerger&) = delete;

  TemporalFilter::Merged run(const Frame& present, std::span<const Frame> before, std::span<const Frame> after);
  uint64_t deviceBytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace xrds
