#include "network/low_resolution_branch.h"

#include <algorithm>

namespace xrds {
namespace {

/// The functions read like the paper's section 3. Those that take a band work on its rows as an image of their own.
class LowResolutionBranch {
 public:
  explicit LowResolutionBranch(Layers& layers) : layers_(layers), config_(layers.config) {}

  TensorView build(TensorView x, const std::vector<TensorView>& d) {
    const uint32_t c = config_.channels;
    TensorView f0 = layers_.conv("lr_conv", x, 3, c, {}), f = f0;
    for (uint32_t g = 0; g + 1 < config_.groups; ++g) f = group(g, f, d.empty() ? TensorView{} : d[g], {});
    const TensorView fused = layers_.create("fused", x, d.empty() ? c : 2 * c);
    const uint32_t last = config_.groups - 1;
    group(last, f, d.empty() ? TensorView{} : d[last], slice(fused, 0, c));
    if (!d.empty()) copyRows(layers_.graph, "fused.aux", d.back(), slice(fused, c, c));
    const TensorView u = layers_.conv("fuse", fused, c);
    // F_0 is made again where memory counts: of all the network's work that is a few thousandths.
    if (layers_.bands(x, false, kSelfAttentionTensors).size() > 1) f0 = layers_.conv("lr_conv", x, 3, c, {});
    return layers_.conv("body_conv", u, c, c, {.residual = f0});
  }

 private:
  // Tensors of C channels that a chain holds at once: LN(t) and q, k, v of a Swin layer; LN(f2), f2 and four of MLP_4.
  static constexpr uint32_t kSelfAttentionTensors = 4, kCrossModuleTensors = 6;

  // x + WMSA(LN(x)).
  TensorView selfAttention(const std::string& norm, const std::string& name, TensorView x, bool shifted,
                           const WindowBand& band) {
    const uint32_t c = x.channels;
    const TensorView qkv = layers_.normedLinear(norm, name + ".qkv", x, 3 * c);
    const TensorView heads =
        layers_.attention(name, slice(qkv, 0, c), slice(qkv, c, c), slice(qkv, 2 * c, c), shifted, band);
    return layers_.linear(name + ".proj", heads, c, {}, x);
  }

  // x + MLP_ratio(LN(x)).
  TensorView mlp(const std::string& norm, const std::string& name, TensorView x, uint32_t ratio, TensorView into) {
    const TensorView hidden = layers_.normedLinear(norm, name + ".fc1", x, ratio * x.channels, Activation::gelu);
    return layers_.linear(name + ".fc2", hidden, x.channels, into, x);
  }

  // XM: f1 = f + WMSA(LN(f)); f2 = f1 + WMCA(LN(f1), LN(e)); f2 + MLP_4(LN(f2)).
  void crossModule(const std::string& name, TensorView f, TensorView e, TensorView into, const WindowBand& band) {
    const uint32_t c = config_.channels;
    f = selfAttention(name + "norm1", name + "self_attn", f, false, band);
    if (e.exists()) {
      const TensorView q = layers_.normedLinear(name + "norm2", name + "cross_attn.q", f, c);
      const TensorView kv = layers_.normedLinear(name + "norm_aux", name + "cross_attn.kv", e, 2 * c);
      const TensorView heads = layers_.attention(name + "cross_attn", q, slice(kv, 0, c), slice(kv, c, c), false, band);
      f = layers_.linear(name + "cross_attn.proj", heads, c, {}, f);
    }
    mlp(name + "norm3", name + "mlp", f, 4, into);
  }

  // Rows of a convolution to C channels, as an image of their own.
  TensorView convRows(const std::string& name, TensorView x, RowRange rows) {
    const uint32_t c = config_.channels;
    const TensorView y = layers_.graph.createRows(name, layers_.stored(name), {x.height, x.width, c}, rows);
    return rowsOf(layers_.conv(name, x, c, c, {.into = y, .rows = rows}), rows);
  }

  // X: what the features of the colour and the auxiliary images make together, by XM or by a 1x1 convolution of [f, e].
  TensorView joined(const std::string& name, TensorView f, TensorView d, TensorView into) {
    const uint32_t c = config_.channels;
    if (config_.cross == CrossKind::attention) {
      if (!into.exists()) into = layers_.create(name + "xm", f, c);
      for (const WindowBand& band : layers_.bands(f, false, kCrossModuleTensors)) {
        const TensorView e = d.exists() ? convRows(name + "aux_conv", d, band.rows) : TensorView{};
        crossModule(name + "xm.", convRows(name + "lr_conv", f, band.rows), e, rowsOf(into, band.rows), band);
      }
      return into;
    }
    if (!d.exists()) return layers_.conv(name + "lr_conv", f, c, c, {.into = into});
    const TensorView both = layers_.create(name + "both", f, 2 * c);
    layers_.conv(name + "lr_conv", f, c, c, {.into = slice(both, 0, c)});
    layers_.conv(name + "aux_conv", d, c, c, {.into = slice(both, c, c)});
    return layers_.conv1x1(name + "concat", both, c, into);
  }

  // STL: u = t + WMSA(LN(t)); u + MLP_2(LN(u)), and behind it the 1x1 convolution `grow` to C channels if that is
  // named.
  void swinLayer(const std::string& name, const std::string& grow, TensorView t, bool shifted, const WindowBand& band,
                 TensorView into) {
    const TensorView u = selfAttention(name + "norm1", name + "attn", t, shifted, band);
    if (grow.empty()) {
      mlp(name + "norm2", name + "mlp", u, 2, into);
      return;
    }
    const TensorView hidden =
        layers_.normedLinear(name + "norm2", name + "mlp.fc1", u, 2 * u.channels, Activation::gelu);
    layers_.conv1x1OfSum(name + "mlp.fc2", grow, hidden, u, into.channels, into);
  }

  // The layer from t to `into`, in one kernel or band by band.
  void bandedSwinLayer(const std::string& name, const std::string& grow, TensorView t, bool shifted, TensorView into) {
    if (layers_.fusedSwinLayer(name, grow, t, shifted, into)) return;
    const uint32_t tensors = kSelfAttentionTensors * t.channels / config_.channels;
    for (const WindowBand& band : layers_.bands(t, shifted, tensors)) {
      const TensorView from = takeRows(layers_.graph, name + "rows", band, t);
      const TensorView to = rowsToWrite(layers_.graph, name + "rows", band, into);
      swinLayer(name, grow, from, shifted, band, to);
      giveRows(layers_.graph, name + "rows", band, to, into);
    }
  }

  // RDST: three Swin layers over the growing concatenation `dense` = [x, y_1, y_2], of which x is there already.
  TensorView denseBlock(const std::string& name, TensorView dense, uint32_t block, TensorView into) {
    const uint32_t c = config_.channels;
    const TensorView y = layers_.create(name + "grow.2", dense, c);
    for (uint32_t k = 0; k < 3; ++k) {
      const std::string number = std::to_string(k);
      bandedSwinLayer(name + "layers." + number + ".", name + "grow." + number, slice(dense, 0, (k + 1) * c),
                      (3 * block + k) % 2 == 1, k < 2 ? slice(dense, (k + 1) * c, c) : y);
    }
    return layers_.conv(name + "conv", y, c, c, {.into = into, .residual = slice(dense, 0, c)});
  }

  // RSTB: three Swin layers and a convolution, plus x.
  TensorView swinBlock(const std::string& name, TensorView x, uint32_t block, TensorView into) {
    TensorView t = x;
    for (uint32_t k = 0; k < 3; ++k) {
      const std::string layer = name + "layers." + std::to_string(k) + ".";
      const TensorView next = layers_.create(layer + "mlp.fc2", x, x.channels);
      bandedSwinLayer(layer, "", t, (3 * block + k) % 2 == 1, next);
      t = next;
    }
    return layers_.conv(name + "conv", t, x.channels, x.channels, {.into = into, .residual = x});
  }

  TensorView block(const std::string& name, TensorView dense, uint32_t block, TensorView into) {
    if (config_.block == BlockKind::rstb) return swinBlock(name, dense, block, into);
    if (config_.block == BlockKind::rdb) return layers_.denseConvolutions(name, dense, into);
    return denseBlock(name, dense, block, into);
  }

  // XDG: F_g = conv3x3(G_B) + X. A block's input is the start of its concatenation `dense`, or all of it.
  TensorView group(uint32_t g, TensorView f, TensorView d, TensorView into) {
    const uint32_t c = config_.channels;
    const uint32_t parts = config_.block == BlockKind::rdst ? 3 : config_.block == BlockKind::rdb ? 4 : 1;
    const std::string name = "groups." + std::to_string(g) + ".";
    const auto blockName = [&](uint32_t b) { return name + "blocks." + std::to_string(b) + "."; };
    TensorView dense = layers_.create(blockName(0) + "dense", f, parts * c);
    // X outlives the first of several blocks: holding that block's concatenation so long would cost more than a copy.
    const bool copied = parts > 1 && config_.blocks > 1;
    const TensorView x = joined(name, f, d, copied ? TensorView{} : slice(dense, 0, c));
    if (copied) copyRows(layers_.graph, blockName(0) + "input", x, slice(dense, 0, c));
    TensorView y;
    for (uint32_t b = 0; b < config_.blocks; ++b) {
      const bool last = b + 1 == config_.blocks;
      const TensorView next = last ? TensorView{} : layers_.create(blockName(b + 1) + "dense", f, parts * c);
      y = block(blockName(b), dense, b, last ? TensorView{} : slice(next, 0, c));
      dense = next;
    }
    return layers_.conv(name + "conv", y, c, c, {.into = into, .residual = x});
  }

  Layers& layers_;
  const NetworkConfig& config_;
};

}  // namespace

TensorView lowResolutionBranch(Layers& layers, TensorView x, const std::vector<TensorView>& d) {
  return LowResolutionBranch(layers).build(x, d);
}

}  // namespace xrds
