#include "shaders/linear/linear.h"

#include <algorithm>
#include <cmath>

#include "shaders/common/example.h"
#include "shaders/common/groups.h"
#include "shaders/common/lane_products.h"
#include "shaders/common/matrix.h"
#include "shaders/common/moments.h"
#include "shaders/common/tile.h"
#include "shaders/common/uniform_store.h"

namespace xrds {
namespace {

// Multiply-adds of a lane that the compiled body of the lane kernel may hold: beyond it the code leaves the
// instruction cache and takes seconds to compile. A body of kGoodBody is large enough if kGoodTile outputs share a
// fetched input.
constexpr uint32_t kMaxBody = 7200, kGoodBody = 2048;
constexpr uint32_t kMaxTile = 64, kGoodTile = 48, kMaxTurnsTile = 128;
constexpr uint32_t kMaxRows = 32;  // subgroups in a workgroup of the lane kernel

uint32_t outputChannels(const Linear& op) { return ceilDivide(op.bias.size(), 4) * 4; }

bool normalizes(const Linear& op) { return !op.norm.weight.empty(); }

// Of the weights as the model has them: those of the first map, or of the tokens.
size_t ownInputs(const Linear& op) { return op.first.bias.empty() ? inputChannels(op) : op.first.bias.size(); }

// The tiles of the lane kernel are multiples of this; those of 8 are stored twice as wide.
uint32_t tileStep(uint32_t outputs) { return outputs % 8 == 0 ? 8 : 4; }

// Whether the lane kernel reads its weights by address, eight outputs after the other in a loop. Longer code than that
// of kMaxLoop multiply-adds takes minutes to compile.
bool readsWeightsByAddress(const Linear& op, const DeviceTraits& device) {
  constexpr uint32_t kMaxLoop = 4096;
  return inputChannels(op) * 8 <= kMaxLoop && readsWeightsByAddress(device, op.output.type, op.weightType);
}

// Subgroups of a workgroup of the lane kernel, which share the weights that they stage, for so many in all. Those
// behind the last token repeat it. With a residual, which the sum may overwrite, they would add it twice: then there
// are none.
uint32_t laneRows(const Linear& op, uint64_t subgroups) {
  constexpr uint32_t kFewRows = 4, kLargeFrame = 256;
  if (!op.residual.exists()) return subgroups < kLargeFrame ? kFewRows : kMaxRows;
  return subgroupShare(subgroups, kMaxRows);
}

// Whether the subgroups of a workgroup of the lane kernel may take turns.
bool mayTakeTurns(const Linear& op, const DeviceTraits& device) {
  return gainsByTurns(device, kMaxRows, inputChannels(op)) && !readsWeightsByAddress(op, device);
}

// Outputs of a workgroup of the lane kernel: the largest divisor of N that fits and is a multiple of tileStep(N); 0:
// there is none.
uint32_t laneTile(const Linear& op, const DeviceTraits& device) {
  const uint32_t inputs = inputChannels(op), outputs = outputChannels(op), step = tileStep(outputs);
  const uint32_t subgroups = ceilDivide(op.output.pixelCount(), device.subgroupSize);
  if (device.family != KernelFamily::lane || !device.shaderInt64 ||
      device.subgroupSize * kMaxRows > device.maxGroupInvocations ||
      ceilDivide(subgroups, laneRows(op, subgroups)) > kMaxGroupCount)
    return 0;
  const bool byAddress = readsWeightsByAddress(op, device);
  const auto fits = [&](uint32_t tile) {
    return byAddress || (inputs * tile <= kMaxBody && (inputs + 1) * tile * 4 <= device.maxSharedBytes);
  };
  const auto largest = [&](uint32_t limit) -> uint32_t {
    for (uint32_t tile = std::min(limit, outputs) / step * step; tile > 0; tile -= step)
      if (outputs % tile == 0 && fits(tile)) return tile;
    return 0;
  };
  if (const uint32_t asked = device.shape.outputs;
      asked % step == 0 && asked > 0 && outputs % asked == 0 && fits(asked))
    return asked;
  if (byAddress) return outputs;
  if (mayTakeTurns(op, device)) return largest(kMaxTurnsTile);  // as many outputs as can share a fetched input
  const uint32_t tile = largest(std::clamp(kGoodBody / inputs, kGoodTile, kMaxTile));
  return tile < kGoodTile / 2 ? largest(kMaxTile) : tile;  // 56 outputs: not 8
}

// Whether they do: as they may, with code of kLongBody multiply-adds.
bool takesTurns(const Linear& op, const DeviceTraits& device) {
  constexpr uint32_t kLongBody = 1536;
  const uint32_t tile = laneTile(op, device);
  if (tile <= 8) return false;  // one turn
  if (device.shape.rows > 0) return device.shape.rows == kInTurns;
  return inputChannels(op) * tile >= kLongBody && mayTakeTurns(op, device);
}

// A workgroup of the tile kernel: columns * rows invocations, each four outputs of `tokens` tokens.
struct TileShape {
  uint32_t columns = 0, rows = 0, tokens = 0;  // 0: the device takes the plain kernel
};

// As many tokens as keep the products of a fetch many, unless that leaves a GPU without enough workgroups, or spills.
TileShape tileShape(const Linear& op, const DeviceTraits& device) {
  constexpr uint32_t kMostTokens = 256, kEnoughGroups = 256, kOfEightTokens = 128;  // registers
  const uint32_t outputQuads = outputChannels(op) / 4, columns = tileColumns(outputQuads);
  TileShape tile{columns, kTileInvocations / columns, device.registers < kOfEightTokens ? 4u : 8};
  if (device.shape.rows > 0) tile.tokens = std::min(device.shape.rows, 8u);
  const auto sharedBytes = [&] { return 4 * shader::kLinearTileInputs * (tile.rows * tile.tokens + 4 * columns); };
  const auto groupRows = [&] { return ceilDivide(op.output.pixelCount(), uint64_t{tile.rows} * tile.tokens); };
  while (tile.tokens > 1 && (tile.rows * tile.tokens > kMostTokens || sharedBytes() > device.maxSharedBytes ||
                             (device.shape.rows == 0 && tile.tokens > 2 &&
                              groupRows() * ceilDivide(outputQuads, columns) < kEnoughGroups)))
    tile.tokens /= 2;
  const bool fits = takesTiles(device) && sharedBytes() <= device.maxSharedBytes;
  return fits ? tile : TileShape{};
}

constexpr uint32_t kMatrixStep = 8 * shader::kLinearMatrixTexels;  // inputs

// None for what the matrix kernel does not do.
MatrixShape matrixShapeOf(const Linear& op, const DeviceTraits& device) {
  constexpr uint32_t kRowTexels = shader::kLinearMatrixTexels + 1;
  if (normalizes(op)) return {};
  const DataType appended = op.appended.exists() ? op.appended.type : op.input.type;
  const DataType inputType = appended == op.input.type ? appended : DataType::f32;
  return matrixShape(device, {16 * shader::kMatrixRows * kRowTexels, 16 * kRowTexels}, inputType, op.weightType,
                     inputChannels(op), outputChannels(op));
}

// What the kernels bind: the input in place of a view that is not there.
const TensorView& residualOf(const Linear& op) { return op.residual.exists() ? op.residual : op.input; }
const TensorView& appendedOf(const Linear& op) { return op.appended.exists() ? op.appended : op.input; }

shader::LinearParams paramsOf(const Linear& op, RowRange rows) {
  return {.source = sliceOf(op.input),
          .appended = sliceOf(appendedOf(op)),
          .residual = sliceOf(residualOf(op)),
          .target = sliceOf(op.output),
          .sourceChannels = op.input.channels,
          .inputChannels = inputChannels(op),
          .outputChannels = outputChannels(op),
          .tokenBegin = rows.begin * op.input.width,
          .tokenEnd = rows.end * op.input.width,
          .storeOrigin = storeOrigin(op.output, rows),
          .epsilon = op.norm.epsilon};
}

}  // namespace

TensorShape outputShape(const Linear& op) {
  checkView(op.input, op.input.shape());
  if (op.appended.exists()) checkView(op.appended, {op.input.height, op.input.width, op.appended.channels});
  XRDS_CHECK_EQ(op.weight.size(), op.bias.size() * ownInputs(op));
  XRDS_CHECK_EQ(op.first.weight.size(), op.first.bias.size() * inputChannels(op));
  XRDS_CHECK(op.first.bias.empty() || !normalizes(op));
  XRDS_CHECK_EQ(op.norm.weight.size(), op.norm.bias.size());
  if (normalizes(op)) XRDS_CHECK_EQ(op.norm.weight.size(), size_t{inputChannels(op)});
  return {op.input.height, op.input.width, outputChannels(op)};
}

Dispatch dispatch(const Linear& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  if (op.residual.exists()) checkView(op.residual, op.output.shape());
  const RowRange rows = resolve(op.rows, op.output.height);
  const shader::LinearParams params = paramsOf(op, rows);
  const uint64_t tokens = params.tokenEnd - params.tokenBegin;
  const uint32_t activation = static_cast<uint32_t>(op.activation), hasResidual = op.residual.exists();
  const uint32_t normalized = normalizes(op), hasAppended = op.appended.exists();
  Dispatch launch{.bindings = {readTexels(op.input), readWeights(op.weightType), readTexels(residualOf(op)),
                               writeRows(op.output, rows), readTexels(appendedOf(op))},
                  .pushConstants = pushBytes(params),
                  .multiplyAdds = tokens * params.inputChannels * op.bias.size()};
  if (const uint32_t tile = laneTile(op, device)) {
    const uint32_t subgroups = ceilDivide(tokens, device.subgroupSize), rows = laneRows(op, subgroups);
    launch.program = programName("linear", KernelFamily::lane, op.output.type);
    const uint32_t inEights = (params.target.offset | params.target.stride | params.storeOrigin | tile / 4) % 2 == 0;
    launch.specialization = {
        device.subgroupSize,   params.inputChannels,  tile, activation, hasResidual, rows, inEights, normalized,
        op.input.channels / 4, takesTurns(op, device)};
    launch.pushConstants = pushBytesWithDigits(params);
    if (readsWeightsByAddress(op, device)) readWeightsByAddress(launch);
    launch.groupCount = {params.outputChannels / tile, ceilDivide(subgroups, rows), 1};
  } else if (const MatrixShape shape = matrixShapeOf(op, device); shape.subgroups) {
    launch.program = matrixProgramName("linear", device.matrixUnits, op.output.type);
    launch.specialization = matrixConstants(shape, device.matrixSize, activation, hasResidual);
    launch.specialization.push_back(hasAppended);
    launch.specialization.push_back(params.inputChannels % kMatrixStep == 0);
    launch.bindings[0] = readBits(op.input);
    launch.bindings[1] = readPackedHalves();
    launch.bindings[4] = readBits(appendedOf(op));
    countSubgroups(launch, device);
    launch.groupCount =
        tileGroups(ceilDivide(params.outputChannels, 16 * shape.outputs), ceilDivide(tokens, 16 * shader::kMatrixRows));
  } else if (const TileShape tile = tileShape(op, device); tile.columns && !normalized) {
    launch.program = programName("linear", KernelFamily::tile, op.output.type);
    launch.specialization = {tile.columns, tile.rows,   tile.tokens,  activation,
                             hasResidual,  hasAppended, tile.columns, tile.rows};
    launch.groupCount = tileGroups(ceilDivide(params.outputChannels, 4 * tile.columns),
                                   ceilDivide(tokens, uint64_t{tile.rows} * tile.tokens));
  } else {
    launch.program = programName("linear", KernelFamily::plain, op.output.type);
    launch.specialization = {activation, hasResidual, normalized, hasAppended};
    const uint64_t items = uint64_t{ceilDivide(tokens, shader::kLinearTokens)} * (params.outputChannels / 4);
    launch.groupCount = foldedGroups(ceilDivide(items, 64));
  }
  return launch;
}

std::vector<KernelShape> shapesToTry(const Linear& op, const DeviceTraits& device) {
  if (device.family == KernelFamily::tile) return {{.rows = 8}, {.rows = 4}, {.rows = 2}};
  if (usesMatrixUnits(device.family)) return {{.outputs = 4}, {.outputs = 2}, {.outputs = 1}};
  if (device.family != KernelFamily::lane) return {};
  // The next smaller and larger tiles: half the registers, or half the fetches. Of each, and of its own, both orders.
  const uint32_t outputs = outputChannels(op), own = laneTile(op, device), step = tileStep(outputs);
  std::vector<KernelShape> shapes;
  const auto add = [&](uint32_t tile) {
    for (const uint32_t rows : {kAtOnce, kInTurns}) shapes.push_back({.outputs = tile, .rows = rows});
  };
  if (own > 0) add(own);
  for (uint32_t tile = own; tile > step; tile -= step)
    if (outputs % (tile - step) == 0) {
      add(tile - step);
      break;
    }
  for (uint32_t tile = own + step; own > 0 && tile <= std::min(outputs, kMaxTile); tile += step)
    if (outputs % tile == 0) {
      add(tile);
      break;
    }
  return shapes;
}

std::vector<float> joinedWeight(const Linear& op) {
  std::vector<float> joined(op.weight.begin(), op.weight.end());
  const size_t inputs = inputChannels(op), middle = ownInputs(op);
  for (size_t i = 0; normalizes(op) && i < joined.size(); ++i) joined[i] *= op.norm.weight[i % inputs];
  if (op.first.bias.empty()) return joined;
  joined.clear();
  std::vector<double> row(inputs);
  for (size_t n = 0; n < op.bias.size(); ++n) {
    std::fill(row.begin(), row.end(), 0);
    for (size_t m = 0; m < middle; ++m)
      for (size_t k = 0; k < inputs; ++k) row[k] += double{op.weight[n * middle + m]} * op.first.weight[m * inputs + k];
    joined.insert(joined.end(), row.begin(), row.end());
  }
  return joined;
}

std::vector<float> joinedBias(const Linear& op) {
  const std::span<const float> before = normalizes(op) ? op.norm.bias : op.first.bias;
  std::vector<float> joined;
  for (size_t n = 0; n < op.bias.size(); ++n) {
    double sum = op.bias[n];
    for (size_t m = 0; m < before.size(); ++m) sum += double{op.weight[n * before.size() + m]} * before[m];
    joined.push_back(static_cast<float>(sum));
  }
  return joined;
}

std::vector<float> packedWeights(const Linear& op, const DeviceTraits& device) {
  const uint32_t inputs = inputChannels(op), outputs = outputChannels(op), laneOutputs = laneTile(op, device);
  const std::vector<float> weight = joinedWeight(op), bias = joinedBias(op);
  // Outputs above N have weights of 0.
  const auto weightAt = [&](size_t n, size_t k) { return n < bias.size() ? weight[n * inputs + k] : 0; };
  const auto biasAt = [&](size_t n) { return n < bias.size() ? bias[n] : 0; };
  std::vector<float> packed;
  if (const MatrixShape shape = matrixShapeOf(op, device); !laneOutputs && shape.subgroups) {
    const uint32_t rows = alignUp(outputs, 16 * shape.outputs), columns = alignUp(inputs, kMatrixStep);
    for (uint32_t n = 0; n < rows; ++n)
      for (uint32_t k = 0; k < columns; ++k) packed.push_back(k < inputs ? weightAt(n, k) : 0);
    for (uint32_t n = 0; n < rows; ++n) packed.push_back(biasAt(n));
    return packed;
  }
  const uint32_t rows = inputs + 1;
  packed.resize(size_t{rows} * outputs);
  for (uint32_t k = 0; k < rows; ++k)
    for (uint32_t n = 0; n < outputs; ++n)
      packed[laneOutputs > 0 ? laneWeightAt(n, k, rows, laneOutputs) : size_t{k} * outputs + n] =
          k < inputs ? weightAt(n, k) : biasAt(n);
  return packed;
}

namespace {

// The token as the weights see it.
std::vector<double> tokenAt(const Linear& op, HostMemory& memory, uint32_t y, uint32_t x) {
  const uint32_t channels = inputChannels(op), own = op.input.channels;
  std::vector<double> token(channels);
  for (uint32_t k = 0; k < channels; ++k)
    token[k] = k < own ? memory.at(op.input, y, x, k) : memory.at(op.appended, y, x, k - own);
  if (!op.first.bias.empty()) {
    std::vector<double> mapped(op.first.bias.begin(), op.first.bias.end());
    for (size_t i = 0; i < op.first.weight.size(); ++i)
      mapped[i / channels] += op.first.weight[i] * token[i % channels];
    return mapped;
  }
  if (!normalizes(op)) return token;
  double mean = 0, variance = 0;
  for (const double v : token) mean += v / channels;
  for (const double v : token) variance += (v - mean) * (v - mean) / channels;
  for (uint32_t k = 0; k < channels; ++k)
    token[k] = (token[k] - mean) / std::sqrt(variance + op.norm.epsilon) * op.norm.weight[k] + op.norm.bias[k];
  return token;
}

}  // namespace

void reference(const Linear& op, HostMemory& memory) {
  const auto [height, width, outputs] = outputShape(op);
  const RowRange rows = resolve(op.rows, height);
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < width; ++x) {
      const std::vector<double> token = tokenAt(op, memory, y, x);
      for (uint32_t n = 0; n < outputs; ++n) {
        const bool exists = n < op.bias.size();
        double sum = exists ? op.bias[n] : 0;
        for (size_t k = 0; exists && k < token.size(); ++k) sum += token[k] * op.weight[n * token.size() + k];
        sum = activate(op.activation, sum);
        if (op.residual.exists()) sum += memory.at(op.residual, y, x, n);
        memory.at(op.output, y, x, n) = sum;
      }
    }
}

OperatorFacts facts(const Linear& op) {
  return {"linear",
          {op.input, op.appended, op.residual},
          {1e-6, 8e-4},
          computedPixels(op) * inputChannels(op) * op.bias.size()};
}

void propagate(const Linear& op, Moments& moments) {
  const uint32_t own = op.input.channels, inputs = inputChannels(op);
  XRDS_CHECK_EQ(op.norm.weight.size(), 0u);  // graphs are looked at with norms of their own
  const std::vector<float> weight = joinedWeight(op), bias = joinedBias(op);
  for (uint32_t o = 0; o < bias.size(); ++o) {
    Moment sum{bias[o], 0};
    for (uint32_t i = 0; i < inputs; ++i) {
      const double w = weight[size_t{o} * inputs + i];
      const Moment x = i < own ? moments.at(op.input, i) : moments.at(op.appended, i - own);
      sum = sum + Moment{w * x.mean, w * w * x.variance};
    }
    moments.at(op.output, o) = moments.finished(sum, op.activation, op.residual, o);
  }
  moments.checkWeights(weight, inputs);
  const std::span<const float> gain = moments.gain(op.input);
  if (gain.empty()) return;
  std::vector<float> normed = weight;  // as a layer that makes the norm stores them
  for (size_t i = 0; i < normed.size(); ++i) normed[i] *= gain[i % inputs];
  moments.checkWeights(normed, inputs);
}

void addExamples(ExampleMaker& maker, std::vector<Linear>& examples) {
  const auto make = [&](uint32_t inputs) {
    Linear op{.input = maker.view({16, 16, 16}), .output = maker.view({16, 16, 32})};
    op.weight = maker.weights(size_t{32} * inputs);
    op.bias = maker.weights(32);
    op.weightType = maker.stored();
    return op;
  };
  Linear plain = make(16), appended = make(24);
  plain.residual = maker.view({16, 16, 32});
  plain.activation = Activation::gelu;
  appended.appended = maker.view({16, 16, 8});
  examples = {plain, appended};
}

}  // namespace xrds
