#pragma once

#include <string_view>

#include "graph/graph.h"
#include "network/precision.h"

namespace xrds {

/// The largest RMS error, relative to double precision, that is allowed in each precision.
struct ErrorBudget {
  double fp32 = 0, fp16 = 0;
  constexpr double of(Precision precision) const { return precision == Precision::fp32 ? fp32 : fp16; }
};

/// Of the image, in the transformed domain.
inline constexpr ErrorBudget kNetworkBudget{1e-4, 5e-3};
/// Of a value inside the network, after all operators before it.
inline constexpr ErrorBudget kChainBudget{1e-4, 2e-2};

/// Of one operator alone, on the inputs that the device gave it.
struct LedgerEntry {
  std::string_view op;  // as in the names of programs
  ErrorBudget budget;
};
inline constexpr LedgerEntry kErrorLedger[] = {
    // Always stored in fp32.
    {"bicubic", {1e-6, 1e-6}},
    {"decode_radiance", {1e-6, 1e-6}},
    {"encode_radiance", {5e-7, 5e-7}},
    {"exposure", {1e-6, 1e-6}},
    {"joint_bilateral", {1e-6, 1e-6}},
    {"radiance_ceiling", {1e-6, 1e-6}},
    // Rounded to 11 bits in fp16, which alone is 2.8e-4; the weights of the last two are too.
    {"box_mean", {5e-7, 4e-4}},
    {"filter_auxiliary", {5e-7, 4e-4}},
    {"fold", {5e-7, 4e-4}},
    {"layer_norm", {1e-6, 4e-4}},
    {"pack_auxiliary", {1e-7, 4e-4}},
    {"window_attention", {1e-6, 5e-4}},
    {"conv3x3", {1e-6, 8e-4}},
    {"linear", {1e-6, 8e-4}},
    // Four maps and an attention in one, whose features between them are halves; there is none in fp32.
    {"swin_layer", {1e-6, 1e-3}},
};

/// The operator's name and its entry. Throws std::logic_error if the ledger has none.
const LedgerEntry& ledgerEntry(const Operator& op);

}  // namespace xrds
