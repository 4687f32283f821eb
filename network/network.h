#pragma once

#include <functional>
#include <optional>
#include <span>

#include "graph/kernel_table.h"
#include "network/config.h"
#include "network/frame_shape.h"
#include "network/precision.h"

namespace xrds {

/// Gives the weights of a parameter, row-major in PyTorch's layout, by its name in the weight file ("up.0.weight") and
/// the shape that the network needs. The floats must outlive the graph.
using WeightLookup = std::function<std::span<const float>(const std::string& name, std::span<const uint32_t> shape)>;

/// GraphOptions::bandRows for a frame in one piece.
inline constexpr uint32_t kWholeFrame = kMaxSide;

/// How a network is written as a graph.
struct GraphOptions {
  Precision precision = Precision::fp32;
  bool autoExposure = true;  // else the exposure is an input of the graph
  /// Low-resolution rows of the bands, of whole windows, in which wide tensors are computed; 0: chosen by the frame's
  /// size, small frames in one piece. Bands take less memory and give the same output bit for bit.
  uint32_t bandRows = 0;
  /// Where bandRows is 0: the low-resolution pixels of a band, of which a dispatch then has work for a whole GPU; 0: as
  /// many as suit the caches of a CPU.
  uint32_t bandPixels = 0;
  /// Layer norms are made by the linear layers behind them, as the lane and the plain kernels can.
  bool normsInLinear = false;
  /// Linear maps in a row with nothing between them are made as one, whose weights are their product: of an RDST a
  /// seventh fewer multiply-adds; so are the last doubling and the output convolution where that is less work.
  bool mapsJoined = false;
  /// Wide convolutions are made by squares of 4 x 4 pixels, in three steps, as CPU devices like.
  bool inSquares = false;
  /// The device on which Swin layers that fit() it are made by one kernel each, in fp16; none: nowhere.
  std::optional<DeviceTraits> layersFusedOn{};
  KernelTable kernels{};  // what tuning found; empty: the fixed choice of the device's family
  uint32_t layers = 0;    // images beside the colour that the base's kernels are applied to: Graph::layers
};

/// The network as its definition is written, in one piece: what papers count, and what references are made of.
inline const GraphOptions kAsWritten{.bandRows = kWholeFrame};

/// The options with what makes the graph fast on a device, and with their own table of kernels: whatever is to be true
/// of the graph that a device runs builds it with these.
GraphOptions fastOn(const DeviceTraits& device, GraphOptions options);

/// The whole forward pass of the config's architecture (network/architecture.h), from linear images to linear images.
/// In fp16 what the weights show to be beyond a half is stored in fp32 (findPromotions).
/// Throws Error if the frame is empty or too large, and what the lookup throws.
Graph buildGraph(const NetworkConfig& config, FrameShape frame, const WeightLookup& weights,
                 const GraphOptions& options);

}  // namespace xrds
