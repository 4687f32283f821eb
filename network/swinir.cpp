// Liang et al. 2021, "SwinIR: Image Restoration Using Swin Transformer", figure 2, classical and lightweight
// super-resolution.
#include <cmath>

#include "network/architecture.h"
#include "network/fields.h"
#include "network/super_resolution.h"

namespace xrds {
namespace {

constexpr const char* kUpsamplers[] = {"pixelshuffle", "pixelshuffledirect"};  // classical, lightweight
constexpr uint32_t kUpscaledChannels = 64;                                     // of the classical one
constexpr uint32_t kAttentionTensors = 4;  // of C channels that a layer holds at once: q, k, v and their result

uint32_t ownHeadChannels(const NetworkConfig& config) { return config.symbol("head_channels"); }

void parse(const Metadata& metadata, NetworkConfig& config) {
  parseSuperResolution(metadata, config);
  parseRange(metadata, config);
  config.groups = number(metadata, "groups", 1, 64);
  config.blocks = number(metadata, "blocks", 1, 64);
  config.window = number(metadata, "window", 2, 16);
  config.padding = Padding::reflection;
  require(config.window % 2 == 0, "gives an odd window");
  config.symbols["head_channels"] = number(metadata, "head_channels", 1, 512);
  require(config.channels % ownHeadChannels(config) == 0, "gives channels that are no multiple of head_channels");
  config.headChannels = alignUp(ownHeadChannels(config), 4);  // as the kernels take them
  config.symbols["mlp_ratio"] = number(metadata, "mlp_ratio", 1, 8);
  config.symbols["upsampler"] = static_cast<uint32_t>(choice(metadata, "upsampler", kUpsamplers));
}

void describe(const NetworkConfig& config, Metadata& metadata) {
  describeSuperResolution(config, metadata);
  describeRange(config, metadata);
  metadata["groups"] = std::to_string(config.groups);
  metadata["blocks"] = std::to_string(config.blocks);
  metadata["window"] = std::to_string(config.window);
  metadata["head_channels"] = std::to_string(ownHeadChannels(config));
  metadata["mlp_ratio"] = std::to_string(config.symbol("mlp_ratio"));
  metadata["upsampler"] = kUpsamplers[config.symbol("upsampler")];
}

/// Deep features: residual groups of Swin layers.
class SwinBody {
 public:
  explicit SwinBody(Layers& layers)
      : layers_(layers),
        c_(layers.config.channels),
        own_(ownHeadChannels(layers.config)),
        padded_(layers.config.headChannels),
        heads_(c_ / own_) {}

  // RSTB: every second layer is shifted; a convolution, plus x.
  TensorView group(const std::string& name, TensorView x) {
    TensorView t = x;
    for (uint32_t b = 0; b < layers_.config.blocks; ++b)
      t = bandedLayer(name + "residual_group.blocks." + std::to_string(b) + ".", t, b % 2 == 1);
    return layers_.conv(name + "conv", t, c_, c_, {.residual = x});
  }

 private:
  // Heads of 30 channels as heads of 32, of which two are zero; q makes up for the root of 32 that its products are
  // divided by.
  void padHeads(const std::string& name) {
    const uint32_t width = heads_ * padded_;
    const auto weight = layers_.weight(name + ".qkv.weight", {3 * c_, c_}),
               bias = layers_.weight(name + ".qkv.bias", {3 * c_});
    const auto proj = layers_.weight(name + ".proj.weight", {c_, c_});
    if (padded_ == own_) return;
    const float gain = std::sqrt(static_cast<float>(padded_) / static_cast<float>(own_));
    std::vector<float> maps(size_t{3} * width * c_), offsets(size_t{3} * width), back(size_t{c_} * width);
    for (uint32_t row = 0; row < 3 * c_; ++row) {
      const uint32_t to = row / own_ * padded_ + row % own_;
      const float scale = row < c_ ? gain : 1;
      for (uint32_t k = 0; k < c_; ++k) maps[size_t{to} * c_ + k] = scale * weight[size_t{row} * c_ + k];
      offsets[to] = scale * bias[row];
    }
    for (uint32_t n = 0; n < c_; ++n)
      for (uint32_t k = 0; k < c_; ++k)
        back[size_t{n} * width + k / own_ * padded_ + k % own_] = proj[size_t{n} * c_ + k];
    layers_.derive(name + ".qkv.weight", std::move(maps));
    layers_.derive(name + ".qkv.bias", std::move(offsets));
    layers_.derive(name + ".proj.weight", std::move(back));
  }

  // STL: u = t + WMSA(LN(t)); u + MLP(LN(u)).
  void layer(const std::string& name, TensorView t, bool shifted, const WindowBand& band, TensorView into) {
    const uint32_t width = heads_ * padded_;
    const TensorView qkv = layers_.normedLinear(name + "norm1", name + "attn.qkv", t, 3 * width);
    const TensorView heads = layers_.attention(name + "attn", slice(qkv, 0, width), slice(qkv, width, width),
                                               slice(qkv, 2 * width, width), shifted, band);
    const TensorView u = layers_.linear(name + "attn.proj", heads, c_, {}, t);
    const TensorView hidden = layers_.normedLinear(name + "norm2", name + "mlp.fc1", u,
                                                   layers_.config.symbol("mlp_ratio") * c_, Activation::gelu);
    layers_.linear(name + "mlp.fc2", hidden, c_, into, u);
  }

  TensorView bandedLayer(const std::string& name, TensorView t, bool shifted) {
    padHeads(name + "attn");
    const TensorView into = layers_.create(name + "mlp.fc2", t, c_);
    for (const WindowBand& band : layers_.bands(t, shifted, kAttentionTensors)) {
      const TensorView from = takeRows(layers_.graph, name + "rows", band, t);
      const TensorView to = rowsToWrite(layers_.graph, name + "rows", band, into);
      layer(name, from, shifted, band, to);
      giveRows(layers_.graph, name + "rows", band, to, into);
    }
    return into;
  }

  Layers& layers_;
  const uint32_t c_, own_, padded_, heads_;
};

void forward(Layers& layers, FrameShape frame) {
  const NetworkConfig& config = layers.config;
  const uint32_t c = config.channels;
  const Prepared prepared = prepareFrame(layers, frame);
  const TensorView first = layers.conv("conv_first", normalizedColour(layers, prepared.x), 3, c, {});
  SwinBody body(layers);
  TensorView t = layers.layerNorm("patch_embed.norm", first);
  for (uint32_t g = 0; g < config.groups; ++g) t = body.group("layers." + std::to_string(g) + ".", t);
  const TensorView deep = layers.conv("conv_after_body", layers.layerNorm("norm", t), c, c, {.residual = first});
  if (config.symbol("upsampler") == 1) {
    denormalize(layers, "upsample.0", c, 3 * config.scale * config.scale);
    return upscaleDirectly(layers, deep, prepared, "upsample.0");
  }
  const TensorView u =
      layers.conv("conv_before_upsample.0", deep, c, kUpscaledChannels, {.activation = Activation::leakyRelu});
  denormalize(layers, "conv_last", kUpscaledChannels, 3);
  upscale(layers, u, prepared, doublingNames(config, "upsample."), "conv_last");
}

constexpr PublishedNetwork kPublished[] = {
    {"swinir",
     "scale=4 channels=180 transfer=none groups=6 blocks=6 window=8 head_channels=30 mlp_ratio=2 "
     "upsampler=pixelshuffle range=1",
     11.85},
    {"swinir_light",
     "scale=4 channels=60 transfer=none groups=4 blocks=6 window=8 head_channels=10 mlp_ratio=2 "
     "upsampler=pixelshuffledirect range=1",
     0.897}};
// Whose heads are padded.
constexpr const char* kSmall =
    "scale=4 channels=12 transfer=log1p groups=1 blocks=2 window=4 head_channels=6 mlp_ratio=2 "
    "upsampler=pixelshuffledirect";

}  // namespace

const Architecture kSwinIr{"swinir", parse, describe, forward, kPublished, kSmall};

}  // namespace xrds
