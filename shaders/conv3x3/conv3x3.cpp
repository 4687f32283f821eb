#include "shaders/conv3x3/conv3x3.h"

#include <algorithm>

#include "shaders/common/example.h"
#include "shaders/common/groups.h"
#include "shaders/common/matrix.h"
#include "shaders/common/moments.h"
#include "shaders/common/tile.h"
#include "shaders/common/uniform_store.h"
#include "shaders/common/winograd.h"
#include "shaders/conv3x3/lanes.h"
#include "shaders/conv3x3/sides.h"

namespace xrds {
namespace {

constexpr uint32_t kFour = 4;  // pixels of a row that are rounded together (Conv3x3::inFours)

// A channel of the kernels, part by part, as a channel of the weight; `channels` if it is padding.
uint32_t weightChannel(uint32_t kernelChannel, uint32_t viewChannels, bool shuffled, uint32_t channels) {
  const uint32_t part = kernelChannel / viewChannels, c = kernelChannel % viewChannels;
  return std::min(shuffled ? c * 4 + part : c, channels);
}

double weightAt(const Conv3x3& op, uint32_t output, uint32_t input, uint32_t tap) {
  return op.weight[(size_t{output} * op.inputChannels + input) * 9 + tap];
}

// A workgroup of the tile kernel: columns * rows * strips invocations, each four outputs of a strip of pixels.
struct TileShape {
  uint32_t columns = 0, rows = 0, strips = 0, pixels = 0;  // 0 columns: the device takes the plain kernel
};

// Pixels of an invocation of the tile kernel. Four take two thirds of the registers of eight.
uint32_t usualPixels(const DeviceTraits& device) {
  constexpr uint32_t kOfEight = 160;  // registers
  return device.registers < kOfEight ? 4 : 8;
}

// Fewer rows where a GPU would have too few workgroups.
TileShape tileShape(const Conv3x3& op, const DeviceTraits& device) {
  constexpr uint32_t kLeastRows = 8, kEnoughGroups = 256;
  const uint32_t columns = tileColumns(kernelOutputs(op) / 4), strips = columns >= 8 ? 2 : 4;
  TileShape tile{columns, std::min(kTileInvocations / columns / strips, 32u), strips, usualPixels(device)};
  const uint32_t asked = device.family == KernelFamily::tile ? device.shape.outputs : 0;
  if (asked == 4 || asked == 8) tile.pixels = asked;
  const auto sharedBytes = [&] { return 16 * ((tile.pixels * strips + 2) * (tile.rows + 2) + 36 * columns); };
  if (device.shape.rows > 0) tile.rows = std::min(tile.rows, device.shape.rows);
  while (tile.rows > 1 && sharedBytes() > device.maxSharedBytes) tile.rows /= 2;
  const auto groups = [&] {
    const TensorShape shape = convolutionShape(op);
    return uint64_t{ceilDivide(kernelOutputs(op), 4 * columns)} * ceilDivide(shape.width, tile.pixels * strips) *
           ceilDivide(shape.height, tile.rows);
  };
  while (tile.rows > kLeastRows && groups() < kEnoughGroups) tile.rows /= 2;
  const bool fits = takesTiles(device) && sharedBytes() <= device.maxSharedBytes &&
                    ceilDivide(convolutionShape(op).height, tile.rows) <= kMaxGroupCount;
  return fits ? tile : TileShape{};
}

constexpr uint32_t kMatrixStep = 8 * shader::kConv3x3MatrixTexels;  // inputs

/// How the matrix kernel goes about it, and how many taps a stage of it has.
struct MatrixTile {
  MatrixShape shape;
  uint32_t taps = 0;
};

// All taps at once where the outputs are few: a stage then has as many products as one of more outputs. Not in products
// of 8 x 8 x 8, of which that are so many that drivers take minutes to compile them.
MatrixTile matrixTile(const Conv3x3& op, const DeviceTraits& device) {
  constexpr uint32_t kFewOutputs = 2, kPixelTexels = shader::kConv3x3MatrixTexels + 1;  // in sixteens
  constexpr uint32_t kPixels = (shader::kMatrixRows + 2) * shader::kConv3x3MatrixStride;
  const uint32_t mostOutputs = hasFewRegisters(device) ? 2 : 4;
  for (const uint32_t taps : {9u, 3u}) {
    const MatrixStage stage{kPixels * kPixelTexels, taps * 16 * kPixelTexels, mostOutputs};
    const MatrixTile tile{matrixShape(device, stage, op.input.type, op.weightType, kernelInputs(op), kernelOutputs(op)),
                          taps};
    const MatrixSize& unit = device.matrixSize;
    const bool arePiecesFew = unit.rows * unit.columns * unit.depth >= 16 * 8 * 16;
    if (tile.shape.subgroups > 0 && (taps == 3 || (arePiecesFew && tile.shape.outputs <= kFewOutputs))) return tile;
  }
  return {};
}

// The weights between kernel channels; zero where either is padding.
class KernelWeights {
 public:
  explicit KernelWeights(const Conv3x3& op) : op_(op), outputChannels_(outputShape(op).channels) {}
  float at(uint32_t output, uint32_t input, uint32_t tap) const {
    const uint32_t o = outputOf(output);
    const uint32_t i = weightChannel(input, op_.input.channels, op_.unshuffleInput, op_.inputChannels);
    return o < op_.outputChannels && i < op_.inputChannels ? static_cast<float>(weightAt(op_, o, i, tap)) : 0;
  }
  // Element 0 .. pixels + 1 of Winograd's F(pixels, 3) in place of the three weights of a row.
  float transformedAt(uint32_t output, uint32_t input, uint32_t ky, uint32_t element, uint32_t pixels) const {
    const std::array<double, 3> w{at(output, input, ky * 3), at(output, input, ky * 3 + 1),
                                  at(output, input, ky * 3 + 2)};
    if (pixels == 4) return static_cast<float>(winogradWeight(w, element));
    if (element == 0) return static_cast<float>(w[0]);
    if (element == 3) return static_cast<float>(w[2]);
    return static_cast<float>((w[0] + (element == 1 ? w[1] : -w[1]) + w[2]) / 2);
  }
  float bias(uint32_t output) const {
    const uint32_t o = outputOf(output);
    return o < op_.outputChannels ? op_.bias[o] : 0;
  }

 private:
  uint32_t outputOf(uint32_t output) const {
    return weightChannel(output, outputChannels_, op_.shuffleOutput, op_.outputChannels);
  }
  const Conv3x3& op_;
  uint32_t outputChannels_;
};

std::vector<float> packedForPlain(const Conv3x3& op) {
  const KernelWeights weights(op);
  const uint32_t inputs = kernelInputs(op), outputs = kernelOutputs(op);
  std::vector<float> packed;
  for (uint32_t tap = 0; tap < 9; ++tap)
    for (uint32_t k = 0; k < inputs; ++k)
      for (uint32_t n = 0; n < outputs; ++n) packed.push_back(weights.at(n, k, tap));
  for (uint32_t n = 0; n < outputs; ++n) packed.push_back(weights.bias(n));
  return packed;
}

std::vector<float> packedForMatrices(const Conv3x3& op, const MatrixShape& shape) {
  const KernelWeights weights(op);
  const uint32_t inputs = kernelInputs(op), outputs = kernelOutputs(op), rows = alignUp(outputs, 16 * shape.outputs);
  std::vector<float> packed;
  for (uint32_t first = 0; first < inputs; first += kMatrixStep)
    for (uint32_t tap = 0; tap < 9; ++tap)
      for (uint32_t n = 0; n < rows; ++n)
        for (uint32_t k = first; k < first + kMatrixStep; ++k)
          packed.push_back(n < outputs && k < inputs ? weights.at(n, k, tap) : 0);
  for (uint32_t n = 0; n < rows; ++n) packed.push_back(n < outputs ? weights.bias(n) : 0);
  return packed;
}

std::vector<float> packedForLanes(const Conv3x3& op, LaneTile tile, uint32_t lanes) {
  const KernelWeights weights(op);
  const uint32_t taps = 3 * (tile.pixels + 2);  // [element][ky]
  const uint32_t inputs = kernelInputs(op), outputs = kernelOutputs(op);
  const size_t stepPadding = 4 * (weightTexels(tile, lanes) - taps * tile.outputs);
  std::vector<float> packed;
  for (uint32_t first = 0; first < outputs; first += tile.outputs) {
    const uint32_t end = first + tile.outputs;
    for (uint32_t k = 0; k < inputs; k += 4) {
      for (uint32_t i = 0; i < taps; ++i)
        for (uint32_t c = k; c < k + 4; ++c)
          for (uint32_t n = first; n < end; ++n)
            packed.push_back(weights.transformedAt(n, c, i % 3, i / 3, tile.pixels));
      packed.resize(packed.size() + stepPadding);
    }
    for (uint32_t n = first; n < end; ++n) packed.push_back(weights.bias(n));
  }
  return packed;
}

shader::Conv3x3Params paramsOf(const Conv3x3& op, RowRange rows, const TensorView& residual) {
  const TensorShape shape = convolutionShape(op);
  const uint32_t f = factor(op.shuffleOutput);
  shader::Conv3x3Params params{};
  params.source = sliceOf(op.input);
  params.residual = sliceOf(residual);
  params.target = sliceOf(op.output);
  params.width = shape.width;
  params.height = shape.height;
  params.rowBegin = rows.begin;
  params.rowEnd = rows.end;
  params.inputChannels = op.input.channels;
  params.outputChannels = op.output.channels;
  params.unshuffle = factor(op.unshuffleInput);
  params.shuffle = f;
  params.storeOrigin = storeOrigin(op.output, {rows.begin * f, rows.end * f});
  params.seenWidth = seenColumns(op);
  return params;
}

}  // namespace

TensorShape outputShape(const Conv3x3& op) {
  checkView(op.input, op.input.shape());
  XRDS_CHECK_EQ(op.input.height % factor(op.unshuffleInput), 0u);
  XRDS_CHECK_EQ(op.input.width % factor(op.unshuffleInput), 0u);
  XRDS_CHECK_EQ(op.inputChannels % parts(op.unshuffleInput), 0u);
  XRDS_CHECK_EQ(op.outputChannels % (op.shuffleOutput ? 16 : 1), 0u);
  XRDS_CHECK_LE(op.inputChannels / parts(op.unshuffleInput), op.input.channels);
  XRDS_CHECK_EQ(op.weight.size(), size_t{op.outputChannels} * op.inputChannels * 9);
  XRDS_CHECK_EQ(op.bias.size(), size_t{op.outputChannels});
  const TensorShape shape = convolutionShape(op);
  XRDS_CHECK_LE(op.seenColumns, shape.width);
  const uint32_t f = factor(op.shuffleOutput);
  return {shape.height * f, shape.width * f, ceilDivide(op.outputChannels, 4 * f * f) * 4};
}

Dispatch dispatch(const Conv3x3& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  if (op.residual.exists()) checkView(op.residual, op.output.shape());
  const TensorShape shape = convolutionShape(op);
  const RowRange rows = resolve(op.rows, shape.height);
  const uint32_t rowCount = rows.end - rows.begin, f = factor(op.shuffleOutput);
  const TensorView& residual = op.residual.exists() ? op.residual : op.input;
  const uint32_t activation = static_cast<uint32_t>(op.activation), hasResidual = op.residual.exists();
  Dispatch launch{.bindings = {readTexels(op.input), readWeights(op.weightType), readTexels(residual),
                               writeRows(op.output, {rows.begin * f, rows.end * f})},
                  .pushConstants = pushBytes(paramsOf(op, rows, residual)),
                  .multiplyAdds = uint64_t{rowCount} * shape.width * 9 * op.inputChannels * op.outputChannels};
  if (const LaneTile tile = laneTile(op, device); tile.outputs) {
    const LaneGroup group = laneGroup(op, tile, rowCount, device);
    launch.program = programName("conv3x3", KernelFamily::lane, op.output.type);
    const auto extendName = [&](const char* text) { launch.program.insert(launch.program.rfind('_'), text); };
    if (tile.pixels == 4) extendName("4");  // conv3x3_lane4_f32
    if (tile.inTurns) extendName("_turns");
    launch.specialization = {device.subgroupSize, group.rows,  tile.outputs,
                             activation,          hasResidual, group.across * group.down};
    if (tile.inTurns) launch.specialization.push_back(op.input.channels / 4);
    launch.savedProducts = launch.multiplyAdds - launch.multiplyAdds * (tile.pixels + 2) / (3 * tile.pixels);
    launch.pushConstants = pushBytesWithDigits(paramsOf(op, rows, residual));
    // With 16 lanes it is no faster than weights that are handed out.
    if (!tile.inTurns && device.subgroupSize <= 8 && readsWeightsByAddress(device, op.output.type, op.weightType))
      readWeightsByAddress(launch);
    launch.groupCount = {kernelOutputs(op) / tile.outputs, group.countAcross, group.countDown};
  } else if (const auto [tile, taps] = matrixTile(op, device); tile.subgroups) {
    launch.program = matrixProgramName("conv3x3", device.matrixUnits, op.output.type);
    launch.specialization = matrixConstants(tile, device.matrixSize, activation, hasResidual);
    for (const uint32_t constant : {taps, uint32_t{kernelInputs(op) % kMatrixStep == 0}, uint32_t{op.unshuffleInput}})
      launch.specialization.push_back(constant);
    launch.bindings[0] = readBits(op.input);
    launch.bindings[1] = readPackedHalves();
    countSubgroups(launch, device);
    launch.groupCount = {ceilDivide(kernelOutputs(op), 16 * tile.outputs), ceilDivide(shape.width, 16),
                         ceilDivide(rowCount, shader::kMatrixRows)};
  } else if (const TileShape tile = tileShape(op, device); tile.columns) {
    launch.program = programName("conv3x3", KernelFamily::tile, op.output.type);
    launch.specialization = {tile.columns, tile.rows,    tile.strips, activation, hasResidual,
                             tile.pixels,  tile.columns, tile.rows,   tile.strips};
    launch.groupCount = {ceilDivide(kernelOutputs(op), 4 * tile.columns),
                         ceilDivide(shape.width, tile.pixels * tile.strips), ceilDivide(rowCount, tile.rows)};
  } else {
    launch.program = programName("conv3x3", KernelFamily::plain, op.output.type);
    launch.specialization = {activation, hasResidual};
    const uint64_t strips = uint64_t{rowCount} * ceilDivide(shape.width, shader::kConv3x3Pixels);
    launch.groupCount = foldedGroups(ceilDivide(strips * (kernelOutputs(op) / 4), 64));
  }
  return launch;
}

std::vector<KernelShape> shapesToTry(const Conv3x3&, const DeviceTraits& device) {
  const uint32_t otherPixels = usualPixels(device) == 8 ? 4 : 8;
  if (device.family == KernelFamily::tile) return {{.rows = 8}, {.rows = 4}, {.outputs = otherPixels}};
  if (usesMatrixUnits(device.family)) return {{.outputs = 4}, {.outputs = 2}, {.outputs = 1}};
  if (device.family != KernelFamily::lane) return {};
  return {{8, 4}, {8, 2}, {16, 2}, {32, 2}};
}

std::vector<float> packedWeights(const Conv3x3& op, const DeviceTraits& device) {
  const LaneTile tile = laneTile(op, device);
  if (tile.outputs) return packedForLanes(op, tile, device.subgroupSize);
  const MatrixShape shape = matrixTile(op, device).shape;
  return shape.subgroups ? packedForMatrices(op, shape) : packedForPlain(op);
}

void reference(const Conv3x3& op, HostMemory& memory) {
  const TensorShape shape = convolutionShape(op);
  const uint32_t height = shape.height, width = shape.width, channels = shape.channels, seen = seenColumns(op);
  const RowRange rows = resolve(op.rows, height);
  const auto input = [&](int64_t y, int64_t x, uint32_t c) {
    if (y < 0 || x < 0 || y >= height || x >= seen) return 0.0;
    const auto v = static_cast<uint32_t>(y), u = static_cast<uint32_t>(x);
    return op.unshuffleInput ? memory.at(op.input, 2 * v + c / 2 % 2, 2 * u + c % 2, c / 4)
                             : memory.at(op.input, v, u, c);
  };
  const auto store = [&](uint32_t y, uint32_t x, uint32_t c, double value) {
    if (op.residual.exists()) value += memory.at(op.residual, y, x, c);
    memory.at(op.output, y, x, c) = value;
  };
  const uint32_t stored = op.shuffleOutput ? channels : op.output.channels;  // with those of padding
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < width; ++x)
      for (uint32_t o = 0; o < stored; ++o) {
        double sum = o < channels ? op.bias[o] : 0;
        for (uint32_t i = 0; i < op.inputChannels && o < channels; ++i)
          for (uint32_t tap = 0; tap < 9; ++tap)
            sum += input(int64_t{y} + tap / 3 - 1, int64_t{x} + tap % 3 - 1, i) * weightAt(op, o, i, tap);
        sum = activate(op.activation, sum);
        if (op.shuffleOutput)
          store(2 * y + o / 2 % 2, 2 * x + o % 2, o / 4, sum);
        else
          store(y, x, o, sum);
      }
}

OperatorFacts facts(const Conv3x3& op) {
  return {.name = "conv3x3",
          .inputs = {{op.input, 1}, op.residual},
          .budget = {1e-6, 8e-4},
          .multiplyAdds = computedPixels(op) * 9 * op.inputChannels * op.outputChannels,
          .blocks = {op.inFours ? kFour : 1}};
}

void propagate(const Conv3x3& op, Moments& moments) {
  const uint32_t inputGroup = parts(op.unshuffleInput), outputGroup = parts(op.shuffleOutput);
  for (uint32_t o = 0; o < op.outputChannels; ++o) {
    Moment sum{op.bias[o], 0};
    for (uint32_t i = 0; i < op.inputChannels; ++i) {
      double taps = 0, squares = 0;
      for (const float w : op.weight.subspan((size_t{o} * op.inputChannels + i) * 9, 9)) taps += w, squares += w * w;
      const Moment x = moments.at(op.input, i / inputGroup);
      sum = sum + Moment{taps * x.mean, std::max(taps * taps, squares) * x.variance};
    }
    const uint32_t channel = o / outputGroup;
    const Moment y = moments.finished(sum, op.activation, op.residual, channel);
    Moment& stored = moments.at(op.output, channel);
    if (o % outputGroup == 0 || y.square() > stored.square()) stored = y;
  }
  moments.checkWeights(op.weight, op.inputChannels * 9);
}

void addExamples(ExampleMaker& maker, std::vector<Conv3x3>& examples) {
  const auto make = [&](TensorShape input, TensorShape output, uint32_t inputs, uint32_t outputs) {
    Conv3x3 op{.input = maker.view(input), .output = maker.view(output)};
    op.weight = maker.weights(size_t{inputs} * outputs * 9);
    op.bias = maker.weights(outputs);
    op.inputChannels = inputs;
    op.outputChannels = outputs;
    op.weightType = maker.stored();
    return op;
  };
  Conv3x3 straight = make({16, 16, 16}, {16, 16, 16}, 16, 16), unshuffled = make({32, 32, 8}, {16, 16, 16}, 32, 16),
          shuffled = make({16, 16, 16}, {32, 32, 16}, 16, 64);
  straight.residual = maker.view({16, 16, 16});
  straight.activation = Activation::relu;
  unshuffled.unshuffleInput = unshuffled.inFours = true;
  shuffled.shuffleOutput = shuffled.inFours = true;
  examples = {straight, unshuffled, shuffled};
}

}  // namespace xrds
