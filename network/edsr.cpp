// Lim et al. 2017, "Enhanced Deep Residual Networks for Single Image Super-Resolution", figure 3.
#include "network/architecture.h"
#include "network/fields.h"
#include "network/super_resolution.h"

namespace xrds {
namespace {

void parse(const Metadata& metadata, NetworkConfig& config) {
  parseSuperResolution(metadata, config);
  parseRange(metadata, config);
  config.blocks = number(metadata, "blocks", 1, 64);
  config.symbols["residual_divisor"] = number(metadata, "residual_divisor", 1, 100);
}

void describe(const NetworkConfig& config, Metadata& metadata) {
  describeSuperResolution(config, metadata);
  describeRange(config, metadata);
  metadata["blocks"] = std::to_string(config.blocks);
  metadata["residual_divisor"] = std::to_string(config.symbol("residual_divisor"));
}

// x + conv3x3(relu(conv3x3(x))) / divisor: the residual scaling is multiplied into the second convolution.
TensorView residualBlock(Layers& layers, const std::string& name, TensorView x) {
  const uint32_t c = x.channels;
  const auto divisor = static_cast<float>(layers.config.symbol("residual_divisor"));
  for (const auto& [part, values] : {std::pair{".weight", layers.weight(name + "2.weight", {c, c, 3, 3})},
                                     std::pair{".bias", layers.weight(name + "2.bias", {c})}}) {
    std::vector<float> scaled(values.begin(), values.end());
    for (float& value : scaled) value /= divisor;
    layers.derive(name + "2" + part, std::move(scaled));
  }
  const TensorView t = layers.conv(name + "0", x, c, c, {.activation = Activation::relu, .inFours = true});
  return layers.conv(name + "2", t, c, c, {.residual = x, .inFours = true});
}

void forward(Layers& layers, FrameShape frame) {
  const NetworkConfig& config = layers.config;
  const uint32_t c = config.channels;
  const Prepared prepared = prepareFrame(layers, frame);
  const TensorView head = layers.conv("head.0", normalizedColour(layers, prepared.x), 3, c, {});
  TensorView f = head;
  for (uint32_t b = 0; b < config.blocks; ++b) f = residualBlock(layers, "body." + std::to_string(b) + ".body.", f);
  upscaleFromTrunk(layers, "body." + std::to_string(config.blocks), f, head, prepared);
}

constexpr PublishedNetwork kPublished[] = {
    {"edsr", "scale=4 channels=256 transfer=none blocks=32 residual_divisor=10 range=255", 43.09, 2895},
    {"edsr_baseline", "scale=4 channels=64 transfer=none blocks=16 residual_divisor=1 range=255", 1.518, 114}};
constexpr const char* kSmall = "scale=4 channels=16 transfer=log1p blocks=2 residual_divisor=10 range=255";

}  // namespace

const Architecture kEdsr{"edsr", parse, describe, forward, kPublished, kSmall};

}  // namespace xrds
