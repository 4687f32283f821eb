#include "shaders/common/example.h"

#include <random>

namespace xrds {

TensorView ExampleMaker::view(TensorShape shape, DataType type, NumberRange range) {
  values_.push_back({shape, type, range});
  const auto id = static_cast<ValueId>(values_.size() - 1);
  return {id, type, shape.height, shape.width, shape.channels, 0, shape.channels};
}

TensorView ExampleMaker::exposure() {
  if (!exposure_.exists()) exposure_ = view({1, 1, 4}, DataType::f32);
  return exposure_;
}

std::span<const float> ExampleMaker::weights(size_t count) {
  std::mt19937 bits(static_cast<uint32_t>(weights_.size()));
  std::vector<float> made(count);
  for (float& weight : made) weight = static_cast<float>(bits() >> 8) * 0x1p-25F - 0.1F;
  weights_.push_back(std::make_shared<const std::vector<float>>(std::move(made)));
  return *weights_.back();
}

}  // namespace xrds
