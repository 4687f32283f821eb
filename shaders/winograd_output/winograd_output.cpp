#include "shaders/winograd_output/winograd_output.h"

#include <algorithm>

#include "shaders/common/example.h"
#include "shaders/common/moments.h"
#include "shaders/common/square_lanes.h"

namespace xrds {
namespace {

constexpr uint32_t kSide = shader::kWinogradSide, kPlanes = shader::kWinogradPlanes;
constexpr uint32_t kGroupWidth = 16, kGroupQuads = 4;  // of the plain kernel

uint32_t factor(const WinogradOutput& op) { return op.shuffleOutput ? 2 : 1; }
uint32_t pool(const WinogradOutput& op) { return op.pooled ? 2 : 1; }

// Of the convolution.
uint32_t heightOf(const WinogradOutput& op) { return op.output.height * pool(op) / factor(op); }
uint32_t widthOf(const WinogradOutput& op) { return op.output.width * pool(op) / factor(op); }
RowRange rowsOf(const WinogradOutput& op) {
  return resolve({op.rows.begin * pool(op), op.rows.end * pool(op)}, heightOf(op));
}
RowRange storedRows(const WinogradOutput& op, RowRange rows) {
  return {rows.begin * factor(op) / pool(op), rows.end * factor(op) / pool(op)};
}

// Channels of a plane.
uint32_t channelsOf(const WinogradOutput& op) { return op.input.channels / kPlanes; }

/// Where a channel of the planes is stored.
struct Stored {
  uint32_t channel = 0, x = 0, y = 0;  // of the pixel's four
};
Stored storedAt(const WinogradOutput& op, uint32_t channel) {
  const uint32_t channels = op.output.channels, part = channel / channels;
  return {channel % channels, part % 2, part / 2};
}

float biasAt(const WinogradOutput& op, uint32_t channel) {
  const auto [c, x, y] = storedAt(op, channel);
  const uint32_t output = op.shuffleOutput ? 4 * (op.firstOutput + c) + 2 * y + x : op.firstOutput + c;
  return output < op.bias.size() ? op.bias[output] : 0;
}

shader::WinogradOutputParams paramsOf(const WinogradOutput& op, RowRange rows, const TensorView& residual) {
  return {.source = sliceOf(op.input),
          .residual = sliceOf(residual),
          .target = sliceOf(op.output),
          .width = widthOf(op),
          .rowBegin = rows.begin,
          .rowEnd = rows.end,
          .squares = op.input.width,
          .quads = channelsOf(op) / 4,
          .targetQuads = op.output.channels / 4,
          .shuffle = factor(op),
          .storeOrigin = storeOrigin(op.output, storedRows(op, rows))};
}

}  // namespace

TensorShape outputShape(const WinogradOutput& op) {
  XRDS_CHECK_EQ(op.output.height % factor(op), 0u);
  XRDS_CHECK_EQ(op.output.width * pool(op) % (kSide * factor(op)), 0u);
  XRDS_CHECK(!op.pooled || (!op.shuffleOutput && !op.residual.exists()));
  checkView(op.input, {ceilDivide(heightOf(op), kSide), widthOf(op) / kSide,
                       kPlanes * op.output.channels * factor(op) * factor(op)});
  return op.output.shape();
}

Dispatch dispatch(const WinogradOutput& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  if (op.residual.exists()) checkView(op.residual, op.output.shape());
  const RowRange rows = rowsOf(op);
  XRDS_CHECK_EQ(rows.begin % kSide, 0u);
  XRDS_CHECK(rows.end % kSide == 0 || rows.end == heightOf(op));
  const TensorView& residual = op.residual.exists() ? op.residual : op.input;  // bound, not read
  const shader::WinogradOutputParams params = paramsOf(op, rows, residual);
  const auto lanes = squareLanes(params.squares, params.quads, device);
  Dispatch launch{
      .program = programName("winograd_output", lanes ? KernelFamily::lane : KernelFamily::plain, op.output.type),
      .specialization = {static_cast<uint32_t>(op.activation), op.residual.exists(), op.pooled},
      .bindings = {readTexels(op.input), readWeights(DataType::f32), readTexels(residual),
                   writeRows(op.output, storedRows(op, rows))}};
  const uint32_t squareRows = ceilDivide(rows.end - rows.begin, kSide);
  if (lanes) {
    launch.specialization.push_back(device.subgroupSize);
    launch.specialization.push_back(lanes->subgroups);
    launch.pushConstants = pushBytesWithDigits(params);
    launch.groupCount = {lanes->workgroups, squareRows, 1};
  } else {
    launch.pushConstants = pushBytes(params);
    launch.groupCount = {ceilDivide(params.quads, kGroupQuads), ceilDivide(params.squares, kGroupWidth), squareRows};
  }
  return launch;
}

std::vector<float> packedWeights(const WinogradOutput& op, const DeviceTraits&) {
  std::vector<float> packed;
  for (uint32_t c = 0; c < channelsOf(op); ++c) packed.push_back(biasAt(op, c));
  return packed;
}

void reference(const WinogradOutput& op, HostMemory& memory) {
  const uint32_t channels = channelsOf(op), f = factor(op);
  const RowRange rows = rowsOf(op);
  for (uint32_t squareRow = rows.begin / kSide; squareRow < ceilDivide(rows.end, kSide); ++squareRow)
    for (uint32_t column = 0; column < op.input.width; ++column)
      for (uint32_t c = 0; c < channels; ++c) {
        std::array<double, kPlanes> products;
        for (uint32_t e = 0; e < kPlanes; ++e) products[e] = memory.at(op.input, squareRow, column, e * channels + c);
        const auto made = winogradSquare(products);
        const auto [channel, partX, partY] = storedAt(op, c);
        for (uint32_t i = 0; i < made.size() && kSide * squareRow + i / kSide < rows.end; ++i) {
          const uint32_t row = kSide * squareRow + i / kSide, pixel = kSide * column + i % kSide;
          const uint32_t y = row * f / pool(op) + partY, x = pixel * f / pool(op) + partX;
          double value = activate(op.activation, made[i] + biasAt(op, c));
          if (op.residual.exists()) value += memory.at(op.residual, y, x, channel);
          double& stored = memory.at(op.output, y, x, channel);
          const bool isFirst = row % pool(op) == 0 && pixel % pool(op) == 0;
          stored = isFirst ? value : std::max(stored, value);
        }
      }
}

OperatorFacts facts(const WinogradOutput& op) {
  return {.name = "winograd_output",
          .inputs = {op.input, op.residual},
          .budget = {1e-6, 8e-4},
          .blocks = {kSide / pool(op)}};
}

// The largest of the pixels of a square.
void propagate(const WinogradOutput& op, Moments& moments) {
  const uint32_t channels = channelsOf(op);
  std::array<std::array<double, 16>, kPlanes> shares;  // of a product, in the pixels
  for (uint32_t e = 0; e < kPlanes; ++e) {
    std::array<double, kPlanes> one{};
    one[e] = 1;
    shares[e] = winogradSquare(one);
  }
  for (uint32_t c = 0; c < channels; ++c) {
    Moment largest;
    for (uint32_t pixel = 0; pixel < 16; ++pixel) {
      Moment sum{biasAt(op, c), 0};
      for (uint32_t e = 0; e < kPlanes; ++e) {
        const Moment m = moments.at(op.input, e * channels + c);
        sum = sum + Moment{shares[e][pixel] * m.mean, shares[e][pixel] * shares[e][pixel] * m.variance};
      }
      if (sum.square() > largest.square()) largest = sum;
    }
    const uint32_t channel = storedAt(op, c).channel;
    const Moment y = moments.finished(largest, op.activation, op.residual, channel);
    Moment& stored = moments.at(op.output, channel);
    if (c < op.output.channels || y.square() > stored.square()) stored = y;
  }
}

void addExamples(ExampleMaker& maker, std::vector<WinogradOutput>& examples) {
  if (maker.device().family != KernelFamily::lane) return;  // which the others leave out
  WinogradOutput op{.input = maker.view({5, 4, 576}, DataType::f32), .output = maker.view({18, 16, 16})};
  op.residual = maker.view({18, 16, 16});
  op.bias = maker.weights(16);
  op.activation = Activation::relu;
  WinogradOutput shuffled{.input = maker.view({5, 4, 2304}, DataType::f32), .output = maker.view({36, 32, 16})};
  shuffled.bias = maker.weights(64);
  shuffled.shuffleOutput = true;
  WinogradOutput pooled{.input = op.input, .output = maker.view({9, 8, 16}), .bias = op.bias};
  pooled.pooled = true;
  examples = {op, shuffled, pooled};
}

}  // namespace xrds
