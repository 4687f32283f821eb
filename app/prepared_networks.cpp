#include "app/prepared_networks.h"

#include <algorithm>

namespace xrds {
namespace {

constexpr uint64_t kWhile = 64;         // networks, more than a frame with many layers runs
constexpr uint64_t kShareOfMemory = 4;  // one in so many bytes: upscalers take three quarters at most

}  // namespace

std::unique_ptr<Upscaler> PreparedNetworks::take(const Model& model, uint32_t width, uint32_t height) {
  const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& each) {
    return each.model == &model && each.width == width && each.height == height;
  });
  if (found == kept_.end()) return nullptr;
  std::unique_ptr<Upscaler> network = std::move(found->network);
  kept_.erase(found);
  return network;
}

void PreparedNetworks::put(const Device& device, const Model& model, uint32_t width, uint32_t height,
                           std::unique_ptr<Upscaler> network) {
  ++puts_;
  std::erase_if(kept_, [&](const Kept& each) { return puts_ - each.putAt > kWhile; });
  uint64_t bytes = network->deviceBytes();
  for (const Kept& each : kept_) bytes += each.network->deviceBytes();
  if (bytes > device.description().memoryBytes / kShareOfMemory) return;
  kept_.push_back({&model, width, height, puts_, std::move(network)});
}

}  // namespace xrds
