#pragma once

#include <functional>
#include <map>
#include <string>

#include "graph/bands.h"
#include "graph/convolution.h"
#include "network/joined_weights.h"
#include "network/network.h"

namespace xrds {

/// Of Layers::denseConvolutions(). The layers of a block `name` are name + grow + "0" + grown, ... and name + fuse.
struct DenseOptions {
  std::string grow = "grow.", grown, fuse = "fuse";
  uint32_t count = 3, growth = 0;  // of the y, and the channels of each; 0: those of x
  bool inFours = false;            // as in ConvOptions, of the growing convolutions
};

/// Writes the layers of a network into a graph: each function adds a node and returns the view that it writes.
/// `into` names the rows and channels to write, so that a concatenation is never copied; else a value is added.
class Layers {
 public:
  Layers(const NetworkConfig& network, const WeightLookup& weights, Graph& target, const GraphOptions& options)
      : config(network), graph(target), graphOptions(options), weights_(weights) {}

  struct ConvOptions {
    TensorView into{}, residual{};
    Activation activation = Activation::none;
    bool unshuffle = false, shuffle = false;
    RowRange rows{};           // of the convolution
    uint32_t seenColumns = 0;  // see Conv3x3
    bool inFours = false;      // see Conv3x3; wider kernels, for which exactHalo() is larger
    bool rowsInFours = false;  // the rows begin at multiples of 4 in bands of any size
    SquareEnds ends{};         // where takesEnds(); conv() then returns `pooled`, if that is there
  };
  /// Whether the convolution of an image of this shape, all channels counted, may have ConvOptions::ends.
  bool takesEnds(const std::string& name, TensorShape x, uint32_t outputs, const ConvOptions& options) const;
  TensorView conv(const std::string& name, TensorView x, uint32_t inputs, uint32_t outputs, ConvOptions options);
  TensorView conv(const std::string& name, TensorView x, uint32_t outputs) {
    return conv(name, x, x.channels, outputs, {});
  }
  TensorView linear(const std::string& name, TensorView x, uint32_t outputs, TensorView into = {},
                    TensorView residual = {}, Activation activation = Activation::none);
  /// The 1x1 convolution `name` of t + the linear layer `first` of x, as two linear layers if joinsMaps().
  TensorView conv1x1OfSum(const std::string& first, const std::string& name, TensorView x, TensorView t,
                          uint32_t outputs, TensorView into);
  TensorView conv1x1(const std::string& name, TensorView x, uint32_t outputs, TensorView into,
                     TensorView residual = {});
  /// Of the rows of x and of the channels of `appended` behind its own.
  TensorView conv1x1Rows(const std::string& name, TensorView x, TensorView appended, uint32_t outputs, TensorView into,
                         RowRange rows);
  /// The 1x1 convolution `name` of the doubling pixel_shuffle(conv3x3(x)) and of `appended`, joined; rows of the
  /// output. rowsInFours: as in ConvOptions, of the convolution's.
  void outputOfDoubling(const std::string& doubling, const std::string& name, TensorView x, TensorView appended,
                        uint32_t outputs, TensorView into, RowRange rows, bool rowsInFours);
  /// The 3x3 convolution `name` of the doubling to that many channels, joined, as the patches that Fold adds up; rows
  /// of x.
  void patchesOfDoubling(const std::string& doubling, const std::string& name, TensorView x, uint32_t channels,
                         uint32_t outputs, TensorView into, RowRange rows, bool rowsInFours);
  /// RDB: convolutions over the growing concatenation `dense` = [x, y_1, y_2, ...], of which x is there already, and a
  /// 1x1 convolution of all of it, plus x.
  TensorView denseConvolutions(const std::string& name, TensorView dense, TensorView into,
                               const DenseOptions& options = {});
  /// A linear layer of LN(x).
  TensorView normedLinear(const std::string& norm, const std::string& name, TensorView x, uint32_t outputs,
                          Activation activation = Activation::none);
  TensorView layerNorm(const std::string& name, TensorView x);
  /// Attention of the band's rows, of which the views are images of their own.
  TensorView attention(const std::string& name, TensorView q, TensorView k, TensorView v, bool shifted,
                       const WindowBand& band);

  /// The Swin layer in one kernel, with the convolution `grow` behind it if that is named; false: the device does not
  /// make it so, or something in it is stored in fp32.
  bool fusedSwinLayer(const std::string& name, const std::string& grow, TensorView t, bool shifted, TensorView into);

  /// Whether maps in a row are made as one.
  bool joinsMaps() const { return graphOptions.mapsJoined; }
  /// The type of the value or of the layer's weights.
  DataType stored(const std::string& value) const { return graph.typeOf(value, false, precision()); }
  DataType storedWeights(const std::string& layer) const { return graph.typeOf(layer, true, precision()); }
  TensorView create(const std::string& name, const TensorView& like, uint32_t channels) {
    return graph.create(name, stored(name), {like.height, like.width, channels});
  }

  /// The parameter of that shape, or what derive() put in its place.
  std::span<const float> weight(const std::string& name, std::initializer_list<uint32_t> shape) {
    const auto derived = derived_.find(name);
    return derived != derived_.end() ? derived->second : weights_(name, std::span(shape.begin(), shape.size()));
  }
  /// Layers made from here on take these values for the parameter; their number may be another.
  void derive(const std::string& name, std::vector<float> values) { derived_[name] = graph.keep(std::move(values)); }

  /// The steps over the high-resolution image.
  Sweep sweep(uint32_t height, uint32_t width) const;
  /// Rows between two stages of a sweep at high resolution: enough for a convolution at any of its resolutions, and
  /// whole strips of the kernels.
  uint32_t sweepDistance() const { return std::max(8u, config.scale); }
  /// Rows that a stage of a sweep of doublings is behind those before `first`. Stage j makes the j-th doubling, the
  /// last stage the output. Where doublings are made in squares, the distance is one of rowsInFours() if it can be.
  uint32_t doublingDistance(uint32_t stage, uint32_t first) const;
  /// Whether the rows of a stage of a sweep, each of so many high-resolution rows, begin at multiples of 4.
  static bool rowsInFours(uint32_t distance, uint32_t rowHeight);
  /// Bands for a chain of operators that holds at most `tensors` times the bytes of the branch's features for a row.
  std::vector<WindowBand> bands(const TensorView& image, bool shifted, uint32_t tensors) const;

  const NetworkConfig& config;
  Graph& graph;
  const GraphOptions& graphOptions;

 private:
  // Whether a frame with so much colour is made in one piece where no rows of a band are asked for.
  bool isSmall(uint32_t height, uint32_t width) const;
  uint64_t bandRows(const TensorView& image, uint32_t tensors) const;
  DataType precision() const { return graphOptions.precision == Precision::fp16 ? DataType::f16 : DataType::f32; }
  // Of that layer: the steps of a sweep share them.
  ConvWeights madeOnce(const std::string& name, const std::function<JoinedWeights()>& make);
  Conv3x3 joinedConvolution(const std::string& doubling, TensorView x, ConvWeights joined);
  ConvWeights doublingWeights(const std::string& doubling, uint32_t inputs, uint32_t channels);
  // Of that layer, with neither an output nor weights.
  Conv3x3 convolutionOf(const std::string& name, const TensorView& x, const ConvOptions& options) const;
  // Rows that are all of the image, or where inFours begin at multiples of 4, may be made in squares.
  void addConvolution(const std::string& name, const Conv3x3& op, bool rowsInFours, const SquareEnds& ends = {});
  bool isInSquares(const Conv3x3& op, bool rowsInFours) const;
  TensorView addLinear(const std::string& name, uint32_t outputs, Linear op);
  std::map<std::string, ConvWeights> made_;
  std::map<std::string, std::span<const float>> derived_;
  const WeightLookup& weights_;
};

}  // namespace xrds
