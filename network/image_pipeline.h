#pragma once

#include "network/network.h"

namespace xrds {

/// Auxiliary channels, their means (of a model that demodulates), and the colour demodulated by these and transformed.
struct Prepared {
  TensorView aux{}, auxMean{}, x{};
};

/// What a result is made of: the images that the base compares and averages, the colour that the ceiling is of, and the
/// auxiliary images with their noise.
struct Decoded {
  Prepared base;
  TensorView x{}, noisyAux{};
};

/// Adds the inputs of the graph and what the network sees of them: padded (NetworkConfig::padding).
Prepared prepareInputs(const NetworkConfig& config, FrameShape frame, const GraphOptions& options, Graph& graph);

/// Adds the values, without nodes, of the means and the colour encoded with them of `height` x `width` pixels; the
/// colour stays if it is there. `prefix` begins their names and those of the nodes of encodeRows().
void createEncoded(const NetworkConfig& config, const std::string& prefix, uint32_t height, uint32_t width,
                   Graph& graph, Prepared& prepared);

/// Computes rows of the means and of the encoded colour.
void encodeRows(const NetworkConfig& config, const std::string& prefix, Graph& graph, const Prepared& prepared,
                RowRange rows = {});

/// Computes rows of the means alone.
void meanRows(const NetworkConfig& config, const std::string& prefix, Graph& graph, const Prepared& prepared,
              RowRange rows = {});

/// The low-resolution colour [h, w, 4] without most of its noise, transformed, by the network's logits
/// [hp, wp, >= 25 levels].
TensorView prefilteredColour(const NetworkConfig& config, Graph& graph, const Prepared& prepared,
                             const TensorView& logits);

/// Computes rows of the result: the base image of these rows, which is kept no longer, with its share of the
/// full-resolution colour, plus the network's raw output, decoded; and of Graph::layerMeans. `network` need not exist.
void decodeRows(const NetworkConfig& config, Graph& graph, const Decoded& decoded, const TensorView& network,
                RowRange rows);

}  // namespace xrds
