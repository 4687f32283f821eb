#include "shaders/winograd_input/winograd_input.h"

#include <algorithm>

#include "shaders/common/example.h"
#include "shaders/common/moments.h"
#include "shaders/common/square_lanes.h"

namespace xrds {
namespace {

constexpr uint32_t kSide = shader::kWinogradSide, kElements = shader::kWinogradElements;
constexpr uint32_t kPlanes = shader::kWinogradPlanes;
constexpr uint32_t kGroupWidth = 16, kGroupQuads = 4;  // of the plain kernel

uint32_t heightOf(const WinogradInput& op) { return (op.upsampled ? 2 : 1) * op.input.height; }
uint32_t widthOf(const WinogradInput& op) { return (op.upsampled ? 2 : 1) * op.input.width; }
uint32_t seenColumns(const WinogradInput& op) { return op.seenColumns > 0 ? op.seenColumns : widthOf(op); }

}  // namespace

TensorShape outputShape(const WinogradInput& op) {
  checkView(op.input, op.input.shape());
  XRDS_CHECK_EQ(widthOf(op) % kSide, 0u);
  XRDS_CHECK_LE(op.seenColumns, widthOf(op));
  XRDS_CHECK(!op.upsampled || op.seenColumns % 2 == 0);
  return {ceilDivide(heightOf(op), kSide), widthOf(op) / kSide, kPlanes * op.input.channels};
}

Dispatch dispatch(const WinogradInput& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  const uint32_t quads = op.input.channels / 4;
  const auto lanes = squareLanes(op.output.width, quads, device);
  Dispatch launch{
      .program = programName("winograd_input", lanes ? KernelFamily::lane : KernelFamily::plain, op.output.type),
      .bindings = {readTexels(op.input), writeRows(op.output, rows)}};
  const shader::WinogradInputParams params{.source = sliceOf(op.input),
                                           .target = sliceOf(op.output),
                                           .width = widthOf(op),
                                           .height = heightOf(op),
                                           .seenWidth = seenColumns(op),
                                           .squares = op.output.width,
                                           .rowBegin = rows.begin,
                                           .rowEnd = rows.end,
                                           .quads = quads,
                                           .storeOrigin = storeOrigin(op.output, rows)};
  const uint32_t rowCount = rows.end - rows.begin;
  if (lanes) {
    launch.specialization = {device.subgroupSize, lanes->subgroups, op.upsampled};
    launch.pushConstants = pushBytesWithDigits(params);
    launch.groupCount = {lanes->workgroups, rowCount, 1};
  } else {
    launch.specialization = {op.upsampled};
    launch.pushConstants = pushBytes(params);
    launch.groupCount = {ceilDivide(quads, kGroupQuads), ceilDivide(params.squares, kGroupWidth), rowCount};
  }
  return launch;
}

std::vector<float> packedWeights(const WinogradInput&, const DeviceTraits&) { return {}; }

void reference(const WinogradInput& op, HostMemory& memory) {
  const auto [height, width, planes] = outputShape(op);
  const uint32_t channels = op.input.channels;
  const RowRange rows = resolve(op.rows, height);
  const auto pixel = [&](int64_t y, int64_t x, uint32_t c) {
    if (y < 0 || x < 0 || y >= heightOf(op) || x >= seenColumns(op)) return 0.0;
    const uint32_t repeats = op.upsampled ? 2 : 1;
    return memory.at(op.input, static_cast<uint32_t>(y) / repeats, static_cast<uint32_t>(x) / repeats, c);
  };
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < width; ++x)
      for (uint32_t c = 0; c < channels; ++c) {
        std::array<double, kPlanes> d;
        for (uint32_t e = 0; e < kPlanes; ++e)
          d[e] = pixel(int64_t{kSide} * y + e / kElements - 1, int64_t{kSide} * x + e % kElements - 1, c);
        const std::array<double, kPlanes> made = winogradInputs(d);
        for (uint32_t e = 0; e < kPlanes; ++e) memory.at(op.output, y, x, e * channels + c) = made[e];
      }
}

OperatorFacts facts(const WinogradInput& op) { return {"winograd_input", {{op.input, 1}}, {1e-6, 8e-4}}; }

// Neighbouring pixels count as equal.
void propagate(const WinogradInput& op, Moments& moments) {
  for (uint32_t e = 0; e < kPlanes; ++e) {
    double sum = 0, squares = 0;
    for (uint32_t i = 0; i < kPlanes; ++i) {
      std::array<double, kPlanes> one{};
      one[i] = 1;
      const double share = winogradInputs(one)[e];
      sum += share, squares += share * share;
    }
    for (uint32_t c = 0; c < op.input.channels; ++c) {
      const Moment x = moments.at(op.input, c);
      moments.at(op.output, e * op.input.channels + c) = {sum * x.mean, std::max(sum * sum, squares) * x.variance};
    }
  }
}

void addExamples(ExampleMaker& maker, std::vector<WinogradInput>& examples) {
  if (maker.device().family != KernelFamily::lane) return;  // which the others leave out
  examples.push_back({.input = maker.view({18, 16, 16}), .output = maker.view({5, 4, 576}, DataType::f32)});
  examples.push_back(
      {.input = maker.view({10, 8, 16}), .output = maker.view({5, 4, 576}, DataType::f32), .upsampled = true});
}

}  // namespace xrds
