#include "network/network_model.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <set>

#include "xrds/error.h"

namespace xrds {
namespace {

constexpr FrameShape kSmallestFrame{1, 1};

std::string shapeText(std::span<const uint64_t> shape) {
  std::string text;
  for (const uint64_t side : shape) text += (text.empty() ? "" : " x ") + std::to_string(side);
  return text.empty() ? "scalar" : text;
}

// One weight of an initialization that keeps the variance of activations; norms start near the identity.
void randomize(const std::string& name, StoredTensor& tensor, std::minstd_rand& random) {
  std::normal_distribution<float> normal;
  const bool norm = name.find("norm") != std::string::npos;
  const bool matrix = tensor.shape.size() > 1 && name.find("table") == std::string::npos;
  const uint64_t fanIn = matrix ? tensor.values.size() / tensor.shape[0] : 1;
  const bool scale = norm && name.ends_with(".weight");
  const float spread = matrix ? 0.7f / std::sqrt(static_cast<float>(fanIn)) : 0.1f;
  for (float& value : tensor.values) value = (scale ? 1.f : 0.f) + spread * normal(random);
}

}  // namespace

NetworkModel NetworkModel::read(const std::filesystem::path& path) {
  return fromTensors(readTensors(path), "'" + path.string() + "'");
}

NetworkModel NetworkModel::fromTensors(TensorFile file, const std::string& name) {
  NetworkModel model;
  try {
    model.config_ = parseConfig(file.metadata);
  } catch (const Error& error) {
    throw Error(name + ": " + error.what());
  }
  model.file_ = std::make_shared<const TensorFile>(std::move(file));
  std::set<std::string> used;
  const WeightLookup lookup = model.lookup();
  const WeightLookup checked = [&](const std::string& key, std::span<const uint32_t> shape) {
    const auto found = model.file_->tensors.find(key);
    if (found == model.file_->tensors.end()) throw Error(name + " misses the tensor '" + key + "'.");
    const StoredTensor& tensor = found->second;
    if (!std::equal(shape.begin(), shape.end(), tensor.shape.begin(), tensor.shape.end()))
      throw Error(name + ": tensor '" + key + "' is " + shapeText(tensor.shape) + ", expected " +
                  shapeText(std::vector<uint64_t>(shape.begin(), shape.end())) + ".");
    for (const float value : tensor.values)
      if (!std::isfinite(value)) throw Error(name + ": tensor '" + key + "' holds a value that is not finite.");
    used.insert(key);
    return lookup(key, shape);
  };
  buildGraph(model.config_, kSmallestFrame, checked, {});
  for (const auto& [key, tensor] : model.file_->tensors)
    if (!used.contains(key))
      throw Error(name + " holds the tensor '" + key + "', which its architecture does not have.");
  return model;
}

NetworkModel NetworkModel::random(const NetworkConfig& config, uint32_t seed) {
  std::minstd_rand generator(seed);
  TensorFile file =
      makeTensors(config, [&](const std::string& name, StoredTensor& tensor) { randomize(name, tensor, generator); });
  file.metadata["data"] = "random parameters, seed " + std::to_string(seed);
  return fromTensors(std::move(file), "random model");
}

NetworkModel NetworkModel::behindDenoiser() const {
  NetworkModel model = *this;
  model.config_.behindDenoiser = true;
  return model;
}

uint64_t NetworkModel::parameterCount() const {
  uint64_t count = 0;
  for (const auto& [name, tensor] : file_->tensors) count += tensor.values.size();
  return count;
}

WeightLookup NetworkModel::lookup() const {
  return [file = file_](const std::string& name, std::span<const uint32_t>) -> std::span<const float> {
    return file->tensors.at(name).values;
  };
}

TensorFile makeTensors(const NetworkConfig& config,
                       const std::function<void(const std::string& name, StoredTensor& tensor)>& fill) {
  TensorFile file;
  file.metadata = describe(config);
  const WeightLookup create = [&](const std::string& name, std::span<const uint32_t> shape) -> std::span<const float> {
    StoredTensor& tensor = file.tensors[name];
    tensor.shape.assign(shape.begin(), shape.end());
    tensor.values.resize(std::accumulate(shape.begin(), shape.end(), size_t{1}, std::multiplies<>()));
    fill(name, tensor);
    return tensor.values;
  };
  buildGraph(config, kSmallestFrame, create, {});
  return file;
}

}  // namespace xrds
