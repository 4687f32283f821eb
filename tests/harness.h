#pragma once

#include <functional>
#include <map>
#include <type_traits>

#include "engine/device.h"
#include "engine/tensor.h"
#include "shaders/common/tolerance.h"
#include "shaders/common/uniform_store.h"

namespace xrds::test {

/// The device of the tests: opened once, with validation unless XRDS_TEST_NO_VALIDATION is set, chosen by
/// XRDS_TEST_DEVICE. Every message of the validation layer fails the test that runs. Throws Error without a device.
Gpu& gpu();

/// The options with which gpu() is opened, for tests that open a device of their own.
DeviceOptions gpuOptions();

/// Its traits with that kernel family; `matrix` and `fused` in software where the device has no matrix units.
DeviceTraits traitsOf(KernelFamily family);

/// Messages collected since the last call; a test that provokes some takes them, so that they do not fail it.
std::vector<std::string> takeMessages();

using xrds::Tolerance;
using xrds::toleranceOf;

/// What values hold before the dispatch, by value: all elements of the stored tensor. Those left out are random.
using Contents = std::map<ValueId, std::vector<float>>;

/// `count` numbers from a uniform distribution in [-1, 1), the same on every machine.
std::vector<float> randomNumbers(size_t count, uint32_t seed);

/// Radiances over six decades around `level`, every fifth of them negative or zero.
std::vector<float> radiances(size_t count, float level);

/// The RMS of the difference over that of what is expected. Fails the test if there are not as many.
double relativeRms(std::span<const float> found, std::span<const float> expected);

/// `count` integers from -4 to 4, the same on every machine.
std::vector<float> smallIntegers(size_t count, uint32_t seed);

/// A dispatch and what it shall compute, without the operator's type.
struct KernelCase {
  Dispatch dispatch;
  std::vector<float> weights;  // as packedWeights() gives them
  TensorView output;
  RowRange rows;  // of the output
  std::function<void(HostMemory&)> reference;
};

void expectMatchesReference(const KernelCase& kernel, Tolerance tolerance, const Contents& contents);

/// The operator must outlive it.
template <class Op>
KernelCase kernelCaseOf(const Op& op, const DeviceTraits& traits) {
  KernelCase kernel{.dispatch = dispatch(op, traits), .output = op.output};
  if constexpr (requires { packedWeights(op, traits); }) kernel.weights = packedWeights(op, traits);
  if constexpr (requires { op.rows; }) kernel.rows = op.rows;
  if constexpr (requires { op.shuffleOutput; })
    if (op.shuffleOutput) kernel.rows = {2 * op.rows.begin, 2 * op.rows.end};
  kernel.reference = [&op](HostMemory& memory) { reference(op, memory); };
  return kernel;
}

/// Runs the operator on the device and by its reference() on the same values and compares the output. What is read
/// holds random numbers or `contents`; all else holds NaN. Nothing but the output's rows and channels may change.
template <class Op>
void expectMatchesReference(const Op& op, const DeviceTraits& traits, Tolerance tolerance,
                            const Contents& contents = {}) {
  expectMatchesReference(kernelCaseOf(op, traits), tolerance, contents);
}

/// The same of the form of its lane kernel that reads weights by address. A device that would not take it compiles it
/// for seconds and does so only if it `isShort`. Nothing, if buffers have no addresses or the operator takes no lane
/// kernel.
template <class Op>
void expectMatchesReferenceByAddress(const Op& op, bool isShort) {
  DeviceTraits traits = traitsOf(KernelFamily::lane);
  if (!traits.bufferAddresses || (traits.laneCode != LaneCode::scalars && !isShort)) return;
  traits.laneCode = LaneCode::scalars;
  KernelCase kernel = kernelCaseOf(op, traits);
  if (kernel.dispatch.program.find("_lane") == std::string::npos) return;
  if (!kernel.dispatch.weightsByAddress) readWeightsByAddress(kernel.dispatch);
  expectMatchesReference(kernel, toleranceOf(DataType::f32), {});
}

/// With the traits of the device and the tolerance of the output's type.
template <class Op>
void expectMatchesReference(const Op& op, const Contents& contents = {}) {
  expectMatchesReference(op, gpu().traits(), toleranceOf(op.output.type), contents);
}

/// A whole tensor as a view: channelStride 0 means `channels`, a larger one makes it a slice.
inline TensorView view(ValueId value, DataType type, uint32_t height, uint32_t width, uint32_t channels,
                       uint32_t channelOffset = 0, uint32_t channelStride = 0) {
  return {value, type, height, width, channels, channelOffset, channelStride ? channelStride : channels};
}

}  // namespace xrds::test
