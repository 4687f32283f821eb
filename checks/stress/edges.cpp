#include "checks/stress/edges.h"

#include <cmath>

#include "network/architecture.h"

namespace xrds {
namespace {

void scaleRows(StoredTensor& tensor, uint64_t begin, uint64_t end, float factor) {
  const uint64_t row = tensor.values.size() / tensor.shape[0];
  for (uint64_t i = begin * row; i < end * row; ++i) tensor.values[i] *= factor;
}

void scaleAll(StoredTensor& tensor, float factor) { scaleRows(tensor, 0, tensor.shape[0], factor); }

bool endsWith(const std::string& name, const std::string& layer) {
  return name.ends_with(layer + ".weight") || name.ends_with(layer + ".bias");
}

TensorFile unchanged(TensorFile file) { return file; }

// Logits of attention times `factor` squared.
TensorFile scaleLogits(TensorFile file, float factor) {
  for (auto& [name, tensor] : file.tensors) {
    const uint64_t outputs = tensor.shape[0];
    if (endsWith(name, ".qkv")) scaleRows(tensor, 0, outputs / 3 * 2, factor);
    if (endsWith(name, "cross_attn.q")) scaleAll(tensor, factor);
    if (endsWith(name, "cross_attn.kv")) scaleRows(tensor, 0, outputs / 2, factor);
  }
  return file;
}

// The features of which the layer norms take the variance.
TensorFile scaleFeatures(TensorFile file, float factor) {
  for (auto& [name, tensor] : file.tensors)
    if (name.starts_with("lr_conv.") || name.starts_with("aux_conv.")) scaleAll(tensor, factor);
  return file;
}

// Values of attention and the inner features of auxiliary blocks times `factor`, and the layers behind over `factor`.
TensorFile scaleInside(TensorFile file, float factor) {
  for (auto& [name, tensor] : file.tensors) {
    const uint64_t outputs = tensor.shape[0];
    if (endsWith(name, ".qkv")) scaleRows(tensor, outputs / 3 * 2, outputs, factor);
    if (endsWith(name, "cross_attn.kv")) scaleRows(tensor, outputs / 2, outputs, factor);
    if (name.starts_with("aux_blocks.") && endsWith(name, ".conv1")) scaleAll(tensor, factor);
    const bool behind =
        (name.starts_with("aux_blocks.") && name.ends_with(".conv2.weight")) || name.ends_with("attn.proj.weight");
    if (behind) scaleAll(tensor, 1 / factor);
  }
  return file;
}

// The raw output: beyond what the inverse transform holds.
TensorFile scaleOutput(TensorFile file, float factor) {
  for (auto& [name, tensor] : file.tensors)
    if (name.starts_with("out.")) scaleAll(tensor, factor);
  return file;
}

}  // namespace

const std::vector<WeightEdge>& weightEdges() {
  static const std::vector<WeightEdge> kEdges = {
      {"as they are", true, true, Parts::exactTiles, unchanged},
      {"logits x 64", false, false, Parts::boundedTiles, [](TensorFile f) { return scaleLogits(std::move(f), 8); }},
      {"logits x 1e6", false, false, Parts::skip, [](TensorFile f) { return scaleLogits(std::move(f), 1024); }},
      {"features x 2^-12", true, false, Parts::exactTiles,
       [](TensorFile f) { return scaleFeatures(std::move(f), 0x1p-12f); }},
      {"features x 2^10", false, false, Parts::boundedTiles,
       [](TensorFile f) { return scaleFeatures(std::move(f), 0x1p10f); }},
      {"inside x 2^20", true, true, Parts::boundedTiles,
       [](TensorFile f) { return scaleInside(std::move(f), 0x1p20f); }},
      {"inside x 2^-24", true, false, Parts::skip, [](TensorFile f) { return scaleInside(std::move(f), 0x1p-24f); }},
      {"output x 2^40", false, false, Parts::exactTiles,
       [](TensorFile f) { return scaleOutput(std::move(f), 0x1p40f); }},
      {"output x 2^120", false, true, Parts::skip, [](TensorFile f) { return scaleOutput(std::move(f), 0x1p120f); }},
  };
  return kEdges;
}

std::vector<StressNetwork> stressNetworks() {
  NetworkConfig full{.scale = 2,
                     .channels = 16,
                     .auxChannels = 8,
                     .groups = 2,
                     .blocks = 2,
                     .window = 4,
                     .headChannels = 8,
                     .kernels = 5,
                     .auxSkip = true,
                     .auxKernels = 5};
  NetworkConfig dense{.scale = 4,
                      .channels = 8,
                      .auxChannels = 4,
                      .groups = 1,
                      .blocks = 2,
                      .window = 4,
                      .headChannels = 4,
                      .block = BlockKind::rdb,
                      .cross = CrossKind::concat,
                      .auxKernels = 3,
                      .outputSide = 1};
  NetworkConfig plain{.scale = 1,
                      .channels = 8,
                      .auxChannels = 8,
                      .groups = 2,
                      .blocks = 1,
                      .window = 4,
                      .headChannels = 8,
                      .base = BaseImage::none,
                      .block = BlockKind::rstb,
                      .auxSkip = true};
  NetworkConfig bare{.scale = 8,
                     .channels = 16,
                     .auxInputs = {},
                     .groups = 1,
                     .blocks = 1,
                     .window = 4,
                     .headChannels = 16,
                     .base = BaseImage::bicubic};
  NetworkConfig linear = plain;
  linear.transfer = Transfer::none;
  // With windows and heads that are fused where a device fuses layers, and an output that is folded.
  NetworkConfig folded{.scale = 2,
                       .channels = 16,
                       .auxInputs = {},
                       .groups = 1,
                       .blocks = 1,
                       .headChannels = 16,
                       .base = BaseImage::bicubic,
                       .block = BlockKind::rstb,
                       .cross = CrossKind::concat};
  // Both colours filtered, the low-resolution one before the base image is made, the full-resolution one into it; and
  // light.
  NetworkConfig merged{.scale = 2,
                       .channels = 8,
                       .auxChannels = 4,
                       .auxInputs = {"albedo", "colour", "glossy", "normal", "diffuse"},
                       .groups = 1,
                       .blocks = 1,
                       .window = 4,
                       .headChannels = 8,
                       .block = BlockKind::rstb,
                       .kernels = 5,
                       .auxKernels = 3,
                       .colourKernels = 5,
                       .prefilter = 3,
                       .outputSide = 1};
  std::vector<StressNetwork> all{{"full", full, true},    {"dense", dense},   {"plain", plain},
                                 {"bare", bare},          {"linear", linear}, {"folded", folded, true},
                                 {"merged", merged, true}};
  for (const Architecture* architecture : kArchitectures)
    if (architecture->small)
      all.push_back({architecture->name, parseConfig(metadataOf(*architecture, architecture->small)), true});
  return all;
}

NetworkConfig stressConfig(const std::string& name) {
  for (StressNetwork& network : stressNetworks())
    if (network.name == name) return std::move(network.config);
  XRDS_CHECK(false);
  return {};
}

}  // namespace xrds
