#pragma once

#include "frames/session.h"

namespace xrds {

/// A small frame and a network of a shipped one's shape, both made of numbers that are the same on every machine, and
/// what the network makes of the frame in double precision, from a table that tests/known_answer.cpp writes.
class KnownFrame {
 public:
  KnownFrame();

  const NetworkModel& model() const { return model_; }
  FrameShape shape() const;
  /// Valid as long as this lives.
  FrameInput input() const;
  /// [s h, s w, 3] linear radiance.
  static std::span<const float> answer();

 private:
  NetworkModel model_;
  std::vector<float> colour_;
  std::vector<std::vector<float>> auxiliary_;
};

}  // namespace xrds
