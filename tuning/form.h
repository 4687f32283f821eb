#pragma once

#include <map>
#include <string>
#include <vector>

#include "network/network_model.h"
#include "tuning/tuning_record.h"

namespace xrds {

/// A way to write a model's graph on a device, with the operator shapes in it.
struct Form {
  KernelTable table;  // of the form alone: no kernels
  Graph graph;
  std::map<std::string, std::vector<uint32_t>> shapes;  // nodes by operatorKey(), without copies

  /// The node on which the shape is tried: one of the most pixels.
  const Node& nodeOf(const std::string& shape) const;
  /// Multiply-adds of the shape's nodes.
  uint64_t workOf(const std::string& shape) const;
  /// What a frame spends in the shape's nodes where nodeOf() takes `microseconds`.
  double frameTime(const std::string& shape, double microseconds) const;
};

Form formOf(const NetworkModel& model, FrameShape frame, Precision precision, const DeviceTraits& device,
            const KernelTable& table);

/// What came out for one operator shape of a form.
struct TunedShape {
  std::string shape;
  uint32_t nodes = 0;
  Winner winner;
  size_t tried = 0;
  std::vector<std::string> wrong;        // "linear_tile_f32: its error is ..."
  double seconds = 0, fixedSeconds = 0;  // of a frame in it
};

/// Those of which the winner is known, the slowest first.
std::vector<TunedShape> tunedShapes(const Form& form, const TuningRecord& record, uint32_t size);

}  // namespace xrds
