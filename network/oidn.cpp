// The U-Nets of Open Image Denoise (github.com/RenderKit/oidn). With x_0 the image and L = 4, all convolutions 3 x 3
// with a ReLU behind: x_{k+1} = max_pool(encoder_k(x_k)); y_L = encoder_L(x_L); y_k = decoder_k([upsample(y_{k+1}),
// x_k]).
#include "network/oidn.h"

#include <algorithm>

#include "network/architecture.h"
#include "network/fields.h"
#include "xrds/auxiliary_input.h"

namespace xrds {
namespace {

constexpr const char* kSizes[] = {"base", "small", "large"};
constexpr const char* kInputs[] = {"hdr", "ldr", "albedo", "normal"};  // what x_0 begins with
constexpr uint32_t kLevels = 4, kAlignment = 1u << kLevels;
constexpr uint32_t kGrid = 2 * kAlignment;  // where tiles begin, so that pairs of pixels are the same on every level

constexpr uint32_t kPicture = 3;  // channels of the last convolution

struct Conv {
  const char* name;
  uint32_t channels;
};

/// The convolutions of each level of one size.
struct Layout {
  std::vector<Conv> encoders[kLevels + 1], decoders[kLevels];
};

Layout baseLayout() {
  return {{{{"enc_conv0", 32}, {"enc_conv1", 32}},
           {{"enc_conv2", 48}},
           {{"enc_conv3", 64}},
           {{"enc_conv4", 80}},
           {{"enc_conv5a", 96}, {"enc_conv5b", 96}}},
          {{{"dec_conv1a", 64}, {"dec_conv1b", 32}, {"dec_conv0", 3}},
           {{"dec_conv2a", 64}, {"dec_conv2b", 64}},
           {{"dec_conv3a", 96}, {"dec_conv3b", 96}},
           {{"dec_conv4a", 112}, {"dec_conv4b", 112}}}};
}

Layout smallLayout() {
  return {{{{"enc_conv0", 32}, {"enc_conv1", 32}},
           {{"enc_conv2", 32}},
           {{"enc_conv3", 32}},
           {{"enc_conv4", 32}},
           {{"enc_conv5a", 32}, {"enc_conv5b", 32}}},
          {{{"dec_conv1a", 32}, {"dec_conv1b", 32}, {"dec_conv0", 3}},
           {{"dec_conv2a", 64}, {"dec_conv2b", 32}},
           {{"dec_conv3a", 64}, {"dec_conv3b", 64}},
           {{"dec_conv4a", 64}, {"dec_conv4b", 64}}}};
}

Layout largeLayout() {
  return {{{{"enc_conv1a", 64}, {"enc_conv1b", 64}},
           {{"enc_conv2a", 96}, {"enc_conv2b", 96}},
           {{"enc_conv3a", 128}, {"enc_conv3b", 128}},
           {{"enc_conv4a", 192}, {"enc_conv4b", 192}},
           {{"enc_conv5a", 256}, {"enc_conv5b", 256}}},
          {{{"dec_conv1a", 64}, {"dec_conv1b", 64}, {"dec_conv1c", 3}},
           {{"dec_conv2a", 96}, {"dec_conv2b", 96}},
           {{"dec_conv3a", 128}, {"dec_conv3b", 128}},
           {{"dec_conv4a", 192}, {"dec_conv4b", 192}}}};
}

Layout layoutOf(const NetworkConfig& config) {
  const uint32_t size = config.symbol("size"), divisor = config.symbol("width_divisor");
  Layout layout = size == 0 ? baseLayout() : size == 1 ? smallLayout() : largeLayout();
  const auto narrow = [&](std::vector<Conv>& convs) {
    for (Conv& conv : convs)
      if (conv.channels != kPicture) conv.channels /= divisor;
  };
  std::for_each(std::begin(layout.encoders), std::end(layout.encoders), narrow);
  std::for_each(std::begin(layout.decoders), std::end(layout.decoders), narrow);
  return layout;
}

FrameCurve curveOf(const NetworkConfig& config) {
  const uint32_t input = config.symbol("input");
  return input == 0 ? FrameCurve::hdr : input == 3 ? FrameCurve::normal : FrameCurve::ldr;
}

void parse(const Metadata& metadata, NetworkConfig& config) {
  config.scale = number(metadata, "scale", 1, 1);
  config.symbols["size"] = static_cast<uint32_t>(choice(metadata, "size", kSizes));
  config.symbols["input"] = static_cast<uint32_t>(choice(metadata, "input", kInputs));
  // Of all widths, for tests: 4 of the base, 8 of the others leave multiples of four.
  const uint32_t divisor = config.symbols["width_divisor"] = std::max(numberOr(metadata, "width_divisor", 1, 8), 1u);
  require(divisor == 1 || divisor == (config.symbol("size") == 0 ? 4u : 8u),
          "gives width_divisor " + std::to_string(divisor) + ", expected 1, or 4 of base and 8 of small and large");
  config.auxInputs = splitList(field(metadata, "aux_inputs"));
  const std::vector<std::string> guides{std::string(kAlbedo.name), std::string(kNormal.name)};
  require(
      config.auxInputs.size() <= guides.size() &&
          std::equal(config.auxInputs.begin(), config.auxInputs.end(), guides.begin()),
      "names the auxiliary inputs '" + field(metadata, "aux_inputs") + "', expected none, albedo, or albedo,normal");
  require(config.symbol("input") < 2 || config.auxInputs.empty(), "filters albedo or normal, which takes no others");
  config.channels = config.symbol("size") == 2 ? 64 : 32;
  config.auxChannels = 0;
  config.blocks = 1;
  config.groups = 1;
  config.window = kGrid;
  config.transfer = Transfer::none;
  config.base = BaseImage::none;
}

void describe(const NetworkConfig& config, Metadata& metadata) {
  metadata["scale"] = "1";
  metadata["size"] = kSizes[config.symbol("size")];
  if (const uint32_t divisor = config.symbol("width_divisor"); divisor > 1)
    metadata["width_divisor"] = std::to_string(divisor);
  metadata["input"] = kInputs[config.symbol("input")];
  metadata["aux_inputs"] = joinedList(config.auxInputs);
}

/// The forward pass. What has the full resolution is made in sweeps, the levels below it as wholes.
class UNet {
 public:
  UNet(Layers& layers, FrameShape frame)
      : layers_(layers),
        graph_(layers.graph),
        layout_(layoutOf(layers.config)),
        curve_(curveOf(layers.config)),
        seenWidth_(alignUp(frame.width, kAlignment)),
        shape_{alignUp(frame.height, kAlignment), alignUp(frame.width, kGrid), imageChannels()},
        sweep_(layers.sweep(shape_.height, shape_.width)) {
    graph_.colour = graph_.create("colour", DataType::f32, {frame.height, frame.width, 4});
    if (guideChannels() > 0)
      graph_.auxiliary =
          graph_.create("auxiliary", DataType::f32, {frame.height, frame.width, alignUp(guideChannels(), 4)});
    graph_.exposure = graph_.create("exposure", DataType::f32, {1, 1, 4});
    graph_.output = graph_.create("output", DataType::f32, {frame.height, frame.width, 4});
  }

  void build() {
    for (uint32_t k = 1; k <= kLevels; ++k) joined_.push_back(createJoined(k));
    encodeImage();
    for (uint32_t k = 1; k < kLevels; ++k) {
      const TensorView into = poolsItself(k) ? skipped(k + 1) : TensorView{};
      const TensorView x = chain(layout_.encoders[k], skipped(k), skippedChannels(k), k, {.pooled = into});
      if (!into.exists()) pool(x, k + 1);
    }
    TensorView y = chain(layout_.encoders[kLevels], skipped(kLevels), skippedChannels(kLevels), kLevels, {});
    for (uint32_t k = kLevels - 1; k > 0; --k) {
      const TensorView& joined = joined_[k - 1];
      if (!upsamplesItself(k)) upsample(y, joined, k);
      y = chain(layout_.decoders[k], joined, upsampledChannels(k) + skippedChannels(k), k,
                {.upsampled = upsamplesItself(k) ? y : TensorView{}});
    }
    decodeImage(y);
  }

 private:
  uint32_t guideChannels() const { return layers_.config.auxWidth(); }
  uint32_t imageChannels() const { return alignUp(3 + guideChannels(), 4); }
  // Channels of x_k, and of y_{k+1} before it in the input of decoder_k.
  uint32_t skippedChannels(uint32_t k) const {
    return k == 0 ? imageChannels() : layout_.encoders[k - 1].back().channels;
  }
  uint32_t upsampledChannels(uint32_t k) const {
    return k == kLevels       ? 0
           : k + 1 == kLevels ? layout_.encoders[kLevels].back().channels
                              : layout_.decoders[k + 1].back().channels;
  }
  TensorShape shapeOf(uint32_t k, uint32_t channels) const { return {shape_.height >> k, shape_.width >> k, channels}; }
  TensorView createJoined(uint32_t k) {
    const std::string name = "level" + std::to_string(k);
    return graph_.create(name, layers_.stored(name), shapeOf(k, joinedChannels(k)));
  }
  // What is read at half the resolution is not stored.
  uint32_t joinedChannels(uint32_t k) const {
    return skippedChannels(k) + (upsamplesItself(k) ? 0 : upsampledChannels(k));
  }
  TensorView skipped(uint32_t k) const {
    const uint32_t channels = skippedChannels(k);
    return slice(joined_[k - 1], joined_[k - 1].channels - channels, channels);
  }
  static bool mayRoundInFours(uint32_t level) { return kGrid >> level >= 4; }

  Layers::ConvOptions optionsOf(uint32_t level) const {
    return {.activation = Activation::relu, .seenColumns = seenWidth_ >> level, .inFours = mayRoundInFours(level)};
  }
  // Of the convolution of a stage of a sweep.
  Layers::ConvOptions sweepOptions(uint32_t stage, RowRange made) const {
    Layers::ConvOptions options = optionsOf(0);
    options.rows = made;
    options.rowsInFours = layers_.rowsInFours(stage * layers_.sweepDistance(), 1);
    return options;
  }
  // Whether the convolution of level k, of so many channels, reads and stores at half the resolution where asked to.
  bool takesEnds(const Conv& conv, uint32_t k, uint32_t inputs, uint32_t stage) const {
    return layers_.takesEnds(conv.name, shapeOf(k, inputs), conv.channels,
                             k == 0 ? sweepOptions(stage, {0, shape_.height}) : optionsOf(k));
  }
  bool upsamplesItself(uint32_t k) const {
    return k < kLevels && takesEnds(layout_.decoders[k].front(), k, upsampledChannels(k) + skippedChannels(k), 1);
  }
  bool poolsItself(uint32_t k) const {
    const std::vector<Conv>& convs = layout_.encoders[k];
    const uint32_t inputs = convs.size() > 1 ? convs[convs.size() - 2].channels : skippedChannels(k);
    return takesEnds(convs.back(), k, inputs, static_cast<uint32_t>(convs.size()));
  }

  TensorView chain(const std::vector<Conv>& convs, TensorView x, uint32_t inputs, uint32_t level,
                   const SquareEnds& ends) {
    for (const Conv& conv : convs) {
      Layers::ConvOptions options = optionsOf(level);
      if (&conv == &convs.front()) options.ends.upsampled = ends.upsampled;
      if (&conv == &convs.back()) options.ends.pooled = ends.pooled;
      x = layers_.conv(conv.name, x, inputs, conv.channels, options);
      inputs = conv.channels;
    }
    return x;
  }
  void pool(const TensorView& x, uint32_t k, RowRange rows = {}) {
    graph_.nodes.push_back({"pool" + std::to_string(k), MaxPool{x, skipped(k), rows}});
  }
  void upsample(const TensorView& y, const TensorView& joined, uint32_t k, RowRange rows = {}) {
    graph_.nodes.push_back({"upsample" + std::to_string(k), UpsampleNearest{y, slice(joined, 0, y.channels), rows}});
  }
  void encodeRows(const TensorView& into, RowRange rows) {
    graph_.nodes.push_back({"encode_frame", EncodeFrame{.input = graph_.colour,
                                                        .guides = graph_.auxiliary,
                                                        .exposure = graph_.exposure,
                                                        .output = into,
                                                        .curve = curve_,
                                                        .rows = rows}});
  }

  RowRange rows(uint32_t step, uint32_t stage) const { return sweep_.rows(step, stage * layers_.sweepDistance()); }
  RollingTensor rolling(const std::string& name, uint32_t channels) const {
    return {name, layers_.stored(name), {shape_.height, shape_.width, channels}};
  }
  // Where a stage writes its rows; the next one reads the row above its own.
  TensorView advance(RollingTensor& tensor, uint32_t step, uint32_t stage) {
    const uint32_t next = rows(step, stage + 1).begin;
    return tensor.advance(graph_, rows(step, stage), next - std::min(next, 1u));
  }
  // Stage 0 gives the input, stage i the i-th convolution, the one behind them what `finish` makes of the last, where
  // that is stored.
  void sweepOver(const std::vector<Conv>& convs, RollingTensor input, uint32_t inputs, const SquareEnds& ends,
                 const std::function<void(const TensorView&, RowRange)>& begin,
                 const std::function<void(const TensorView&, RowRange)>& finish) {
    const auto count = static_cast<uint32_t>(convs.size());
    const uint32_t last = ends.pooled.exists() ? count : count + 1;
    std::vector<RollingTensor> tensors{std::move(input)};
    for (const Conv& conv : convs) tensors.push_back(rolling(conv.name, alignUp(conv.channels, 4)));
    for (uint32_t step = 0; step < sweep_.stepCount(last * layers_.sweepDistance()); ++step)
      for (uint32_t stage = 0; stage <= last; ++stage) {
        const RowRange made = rows(step, stage);
        if (made.begin == made.end) continue;
        if (stage == 0) {
          begin(advance(tensors[0], step, 0), made);
        } else if (stage > count) {
          finish(tensors.back().view(), made);
        } else {
          Layers::ConvOptions options = sweepOptions(stage, made);
          if (stage == 1) options.ends.upsampled = ends.upsampled;
          if (stage == last)
            options.ends.pooled = ends.pooled;
          else
            options.into = advance(tensors[stage], step, stage);
          layers_.conv(convs[stage - 1].name, tensors[stage - 1].view(),
                       stage == 1 ? inputs : convs[stage - 2].channels, convs[stage - 1].channels, options);
        }
      }
  }

  // x_1 of x_0.
  void encodeImage() {
    sweepOver(
        layout_.encoders[0], rolling("image", imageChannels()), 3 + guideChannels(),
        {.pooled = poolsItself(0) ? skipped(1) : TensorView{}},
        [&](const TensorView& into, RowRange rows) { encodeRows(into, rows); },
        [&](const TensorView& x, RowRange rows) {
          pool(x, 1, {rows.begin / 2, rows.end / 2});
        });
  }
  // The picture, decoder_0 of y_1 and x_0, which is made anew.
  void decodeImage(const TensorView& y) {
    sweepOver(
        layout_.decoders[0], rolling("level0", joinedChannels(0)), y.channels + 3 + guideChannels(),
        {.upsampled = upsamplesItself(0) ? y : TensorView{}},
        [&](const TensorView& into, RowRange rows) {
          if (!upsamplesItself(0)) upsample(y, into, 0, rows);
          encodeRows(slice(into, into.channels - imageChannels(), imageChannels()), rows);
        },
        [&](const TensorView& x, RowRange rows) {
          if (sweep_.stepCount(0) == 1) graph_.network = x;
          rows.end = std::min(rows.end, graph_.output.height);
          if (rows.begin < rows.end)
            graph_.nodes.push_back(
                {"decode_frame",
                 DecodeFrame{
                     .input = x, .exposure = graph_.exposure, .output = graph_.output, .curve = curve_, .rows = rows}});
        });
  }

  Layers& layers_;
  Graph& graph_;
  const Layout layout_;
  const FrameCurve curve_;
  const uint32_t seenWidth_;  // of x_0 in the original: of what is behind nothing is seen
  const TensorShape shape_;   // of x_0
  const Sweep sweep_;
  std::vector<TensorView> joined_;  // [upsample(y_{k+1}), x_k] of level k = 1 .. L
};

void forward(Layers& layers, FrameShape frame) { UNet(layers, frame).build(); }

constexpr PublishedNetwork kPublished[] = {{"oidn", "scale=1 size=base input=hdr aux_inputs=albedo,normal"}};
constexpr const char* kSmall = "scale=1 size=small input=hdr width_divisor=8 aux_inputs=albedo,normal";

}  // namespace

const Architecture kOidn{"oidn", parse, describe, forward, kPublished, kSmall};

bool takesBinnedExposure(const NetworkConfig& config) { return denoisedImage(config) == "hdr"; }

std::string denoisedImage(const NetworkConfig& config) {
  return config.architecture == kOidn.name ? kInputs[config.symbol("input")] : "";
}

}  // namespace xrds
