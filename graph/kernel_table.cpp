#include "graph/kernel_table.h"

#include <algorithm>

namespace xrds {
namespace {

const char* textOf(DataType type) { return type == DataType::f32 ? "f32" : "f16"; }

bool launchSame(const Dispatch& a, const Dispatch& b) {
  return a.program == b.program && a.specialization == b.specialization && a.groupCount == b.groupCount &&
         a.subgroupSize == b.subgroupSize;
}

}  // namespace

std::string operatorKey(const Operator& op) {
  const OperatorFacts facts = std::visit([](const auto& each) { return xrds::facts(each); }, op);
  const TensorView output = std::visit([](const auto& each) { return each.output; }, op);
  // A layer that only one kernel makes is written for that one's family.
  const KernelFamily family = std::holds_alternative<SwinLayer>(op) ? KernelFamily::fused : KernelFamily::plain;
  const MatrixUnits units = family == KernelFamily::fused ? MatrixUnits::software : MatrixUnits::none;
  const DeviceTraits device{.family = family, .matrixUnits = units, .maxSharedBytes = 1U << 20};
  const Dispatch launch = std::visit([&](const auto& each) { return dispatch(each, device); }, op);
  std::string key(facts.name);
  for (const OperatorInput& input : facts.inputs)
    if (input.view.exists()) {
      key += " " + std::to_string(input.view.channels);
      const uint32_t finer = ceilDivide(input.view.height, output.height);
      const uint32_t coarser = ceilDivide(output.height, input.view.height);
      if (finer > 1 && output.height > 1) key += "/" + std::to_string(finer);
      if (coarser > 1 && input.view.height > 1) key += "x" + std::to_string(coarser);
    }
  key += " > " + std::to_string(output.channels) + " (";
  for (const Binding& binding : launch.bindings)
    key += (key.back() == '(' ? "" : " ") + std::string(textOf(binding.type));
  key += ")";
  for (const uint32_t constant : launch.specialization) key += " " + std::to_string(constant);
  return key + " " + std::to_string(facts.blocks.side) + " " + std::to_string(facts.blocks.shift);
}

void chooseKernels(Graph& graph, const KernelTable& table) {
  if (table.kernels.empty()) return;
  for (Node& node : graph.nodes)
    if (const auto found = table.kernels.find(operatorKey(node.op)); found != table.kernels.end())
      node.kernel = found->second;
}

std::vector<KernelCandidate> candidatesOf(const Operator& op, const DeviceTraits& device,
                                          std::span<const KernelFamily> families, bool shapes) {
  std::vector<KernelCandidate> candidates;
  const auto add = [&](const KernelChoice& kernel) {
    const DeviceTraits traits = traitsOf(kernel, device);
    KernelCandidate candidate{kernel, std::visit([&](const auto& each) { return launchOf(each, traits); }, op)};
    const auto same = [&](const auto& known) { return launchSame(known.dispatch, candidate.dispatch); };
    if (std::none_of(candidates.begin(), candidates.end(), same)) candidates.push_back(std::move(candidate));
  };
  // Matrix kernels share out their work by the size, the others leave it to the driver.
  const auto addSizes = [&](const KernelChoice& kernel) {
    for (const uint32_t size : subgroupSizes(device)) {
      KernelChoice sized = kernel;
      sized.shape.subgroup = size;
      if (const auto* layer = std::get_if<SwinLayer>(&op); !layer || fits(*layer, traitsOf(sized, device))) add(sized);
    }
  };
  if (std::holds_alternative<SwinLayer>(op)) {  // there is no other
    add({KernelFamily::fused});
    if (shapes) addSizes({KernelFamily::fused});
    return candidates;
  }
  add({device.family});
  for (const KernelFamily family : families) add({family});
  if (!shapes) return candidates;
  for (const KernelFamily family : families) {
    const DeviceTraits traits = traitsOf({family}, device);
    if (family != KernelFamily::lane) addSizes({family});
    std::visit(
        [&](const auto& each) {
          if constexpr (requires { shapesToTry(each, traits); })
            for (const KernelShape& shape : shapesToTry(each, traits)) {
              add({family, shape});
              if (usesMatrixUnits(family)) addSizes({family, shape});
            }
        },
        op);
  }
  return candidates;
}

}  // namespace xrds
