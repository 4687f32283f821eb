#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/dispatch.h"

namespace xrds {

/// What the random numbers of a value lie between.
struct NumberRange {
  float least = 0.1F, most = 1.1F;  // positive, as exposures, albedos and radiance are
};

/// A value of an example.
struct ExampleValue {
  TensorShape shape;
  DataType type;
  NumberRange range;
};

/// What an operator makes its examples of, on which a device is examined: values, and small weights that are the same
/// on every machine.
class ExampleMaker {
 public:
  /// `stored`: what the values of a network are stored in.
  ExampleMaker(DataType stored, DeviceTraits device) : stored_(stored), device_(device) {}

  DataType stored() const { return stored_; }
  const DeviceTraits& device() const { return device_; }
  /// A value of its own, and the view of all of it.
  TensorView view(TensorShape shape) { return view(shape, stored_); }
  TensorView view(TensorShape shape, DataType type, NumberRange range = {});
  /// The exposure's, [1, 1, 4], the same for all examples: e and 1 / e.
  TensorView exposure();
  const TensorView& madeExposure() const { return exposure_; }  // none if it was not asked for
  /// As large as those of trained layers. They live as long as a copy of keptWeights() does.
  std::span<const float> weights(size_t count);

  const std::vector<ExampleValue>& values() const { return values_; }
  const std::vector<std::shared_ptr<const std::vector<float>>>& keptWeights() const { return weights_; }

 private:
  DataType stored_;
  DeviceTraits device_;
  TensorView exposure_;
  std::vector<ExampleValue> values_;
  std::vector<std::shared_ptr<const std::vector<float>>> weights_;
};

}  // namespace xrds
