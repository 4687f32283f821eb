#pragma once

#include <map>
#include <span>

#include "graph/graph.h"

namespace xrds {

/// Names what an operator is to its kernels, whatever the size of its image: channels, storage, and what decides its
/// programs. "linear 64 > 192 (f32 f32 f32 f32 f32) 0 0 0 0". Pure.
std::string operatorKey(const Operator& op);

/// Which kernels make the operators of a frame, as a plain value: what tuning found, where that is not the fixed choice
/// of the device's family.
struct KernelTable {
  std::map<std::string, KernelChoice> kernels{};  // by operatorKey()
  std::optional<bool> normsInLinear{};            // as in GraphOptions; none: as the device's family has it
  std::optional<bool> layersFused{};              // Swin layers by one kernel each, where they fit

  bool isFixed() const { return kernels.empty() && !normsInLinear && !layersFused; }
  bool operator==(const KernelTable&) const = default;
};

/// Gives the nodes the kernels that the table has for them.
void chooseKernels(Graph& graph, const KernelTable& table);

/// A kernel that may make an operator, and how that launches.
struct KernelCandidate {
  KernelChoice kernel;
  Dispatch dispatch;
};

/// The kernels of these families that make the operator on the device: one of each family in the shape of its own rule,
/// and with `shapes` those that the operator's room finds worth a try as well, and other sizes of subgroups. Each
/// launches something else; the first is that of the device's own family. Pure.
std::vector<KernelCandidate> candidatesOf(const Operator& op, const DeviceTraits& device,
                                          std::span<const KernelFamily> families, bool shapes);

}  // namespace xrds
