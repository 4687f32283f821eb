#include "shaders/window_attention/window_attention.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "shaders/common/example.h"
#include "shaders/common/matrix.h"
#include "shaders/common/moments.h"
#include "shaders/common/tile.h"
#include "shaders/common/uniform_store.h"
#include "shaders/common/windows.h"

namespace xrds {
namespace {

uint32_t headCount(const WindowAttention& op) { return op.queries.channels / op.headChannels; }

/// How the lane kernel shares a window and head among the lanes of subgroups.
struct LaneShares {
  uint32_t queries;  // of each lane
  uint32_t keys;     // of each step
  uint32_t blocks;   // subgroups for all queries
  uint32_t keySteps;
};

LaneShares laneShares(const WindowAttention& op, const DeviceTraits& device) {
  constexpr uint32_t kStepProducts = 1024;  // of more, the code does not fit the instruction cache of a CPU
  const uint32_t tokens = op.window * op.window, lanes = device.subgroupSize, asked = device.shape.rows;
  LaneShares shares{.queries = asked > 0 ? std::min(std::bit_floor(asked), 8u) : 8, .keys = std::min(4u, lanes / 2)};
  while (op.headChannels / 4 % (lanes / 2 / shares.keys) != 0) shares.keys *= 2;
  while (shares.queries > 1 && shares.queries * shares.keys > 4 &&
         (lanes * shares.queries > tokens || 2 * op.headChannels * shares.keys * shares.queries > kStepProducts))
    shares.queries /= 2;
  shares.blocks = ceilDivide(tokens, lanes * shares.queries);
  shares.keySteps = ceilDivide(tokens, shares.keys);
  return shares;
}

constexpr uint32_t kLaneSubgroups = 4;  // of a workgroup of the lane kernel

uint32_t laneGroupColumns(const WindowAttention& op, const LaneShares& shares) {
  return ceilDivide(uint64_t{op.queries.width / op.window} * headCount(op) * shares.blocks, kLaneSubgroups);
}

bool laneFits(const WindowAttention& op, const DeviceTraits& device) {
  return device.family == KernelFamily::lane && device.shaderInt64 && device.subgroupSize >= 4 &&
         op.headChannels <= 128 && laneGroupColumns(op, laneShares(op, device)) <= kMaxGroupCount;
}

/// Keys that the tile kernel has in shared memory at a time: few, which leaves room for many workgroups side by side,
/// or as many as fit beside the biases; 0: the device takes the plain kernel.
uint32_t tileKeys(const WindowAttention& op, const DeviceTraits& device) {
  constexpr uint32_t kMaxHeadChannels = 64;  // of more, query and result do not stay in registers
  constexpr uint32_t kStep = shader::kAttentionTileKeys, kMostSteps = 2;
  const uint32_t tokens = op.window * op.window, relative = 2 * op.window - 1;
  const uint32_t biasBytes = alignUp(relative * relative, 4) * 4, keyBytes = 2 * op.headChannels * 4 + 8;
  if (!takesTiles(device) || op.headChannels > kMaxHeadChannels || biasBytes > device.maxSharedBytes) return 0;
  const uint32_t roomFor = (device.maxSharedBytes - biasBytes) / keyBytes / kStep;
  return std::min({ceilDivide(tokens, kStep), roomFor, kMostSteps}) * kStep;
}

constexpr uint32_t kMatrixSubgroups = 4;  // of a workgroup of the matrix kernel, sixteen queries each

/// Invocations of a workgroup of the matrix kernel; 0: it does not do that.
uint32_t matrixInvocations(const WindowAttention& op, const DeviceTraits& device) {
  constexpr uint32_t kLeastLanes = 16, kMostLanes = 64, kMostHeadChannels = 64, kTexelBytes = 16, kRelative = 15;
  if (!usesMatrixUnits(device.family) || device.matrixUnits == MatrixUnits::none ||
      op.window != shader::kAttentionMatrixWindow || op.headChannels % 16 != 0 || op.headChannels > kMostHeadChannels)
    return 0;
  for (const TensorView& view : {op.queries, op.keys, op.values, op.output})
    if (view.type != DataType::f16) return 0;
  const uint32_t lanes = matrixLanes(device), invocations = kMatrixSubgroups * lanes;
  const uint32_t pool = ATTENTION_VALUES_AT(op.headChannels) + op.headChannels * shader::kAttentionValueStride;
  const uint32_t words = alignUp(kRelative * kRelative, 4) + op.window * op.window + 2 * invocations;
  const bool fits = lanes >= kLeastLanes && lanes <= kMostLanes && invocations <= device.maxGroupInvocations &&
                    pool * kTexelBytes + 4 * words <= device.maxSharedBytes;
  return fits ? invocations : 0;
}

Windows windowsOf(const WindowAttention& op) { return {op.window, op.shift}; }

double bias(const WindowAttention& op, uint32_t query, uint32_t key, uint32_t head) {
  return op.biasTable[windowsOf(op).relativePosition(query, key) * headCount(op) + head];
}

std::vector<float> laneBias(const WindowAttention& op, const LaneShares& shares, uint32_t lanes) {
  constexpr double kLog2E = 1.4426950408889634;
  const Windows windows = windowsOf(op);
  const uint32_t tokens = op.window * op.window, classes = windows.classCount();
  const uint32_t paddedQueries = shares.blocks * lanes * shares.queries;
  std::vector<float> packed;
  packed.reserve(size_t{classes} * headCount(op) * shares.keySteps * paddedQueries * shares.keys);
  for (uint32_t windowClass = 0; windowClass < classes; ++windowClass)
    for (uint32_t head = 0; head < headCount(op); ++head)
      for (uint32_t step = 0; step < shares.keySteps; ++step)
        for (uint32_t padded = 0; padded < paddedQueries; ++padded)
          for (uint32_t key = step * shares.keys; key < (step + 1) * shares.keys; ++key) {
            const uint32_t query = std::min(padded, tokens - 1);
            const bool seen = key < tokens && !windows.isParted(query, key, windowClass);
            packed.push_back(seen ? static_cast<float>(bias(op, query, key, head) * kLog2E) : -1e30f);
          }
  return packed;
}

}  // namespace

TensorShape outputShape(const WindowAttention& op) {
  const TensorShape shape = op.queries.shape();
  for (const TensorView& view : {op.queries, op.keys, op.values}) checkView(view, shape);
  XRDS_CHECK_LE(2u, op.window);
  XRDS_CHECK_LE(op.window, 16u);
  XRDS_CHECK(op.shift == 0 || 2 * op.shift == op.window);
  XRDS_CHECK_LT(0u, shape.height);
  XRDS_CHECK_LT(0u, shape.width);
  XRDS_CHECK_EQ(shape.height % op.window, 0u);
  XRDS_CHECK_EQ(shape.width % op.window, 0u);
  XRDS_CHECK_LT(0u, op.headChannels);
  XRDS_CHECK_EQ(op.headChannels % 4, 0u);
  XRDS_CHECK_EQ(shape.channels % op.headChannels, 0u);
  const size_t relativePositions = size_t{2 * op.window - 1} * (2 * op.window - 1);
  XRDS_CHECK_EQ(op.biasTable.size(), relativePositions * headCount(op));
  return shape;
}

Dispatch dispatch(const WindowAttention& op, const DeviceTraits& device) {
  const TensorShape shape = outputShape(op);
  checkView(op.output, shape);
  const RowRange rows = resolve(op.rows, shape.height);
  const Windows::Rows windowRows = windowsOf(op).rowsThatMeet(rows, shape.height);
  const uint32_t windowColumns = shape.width / op.window;
  shader::WindowAttentionParams params{.queries = sliceOf(op.queries),
                                       .keys = sliceOf(op.keys),
                                       .values = sliceOf(op.values),
                                       .target = sliceOf(op.output),
                                       .width = shape.width,
                                       .height = shape.height,
                                       .rowBegin = rows.begin,
                                       .rowEnd = rows.end,
                                       .shift = op.shift,
                                       .firstWindowRow = windowRows.first,
                                       .headCount = headCount(op),
                                       .storeOrigin = storeOrigin(op.output, rows)};
  Dispatch result{.bindings = {readTexels(op.queries), readTexels(op.keys), readTexels(op.values),
                               readWeights(DataType::f32), writeRows(op.output, rows)},
                  .pushConstants = pushBytes(params)};
  result.multiplyAdds =
      2ull * windowRows.count * windowColumns * shape.channels * op.window * op.window * op.window * op.window;
  if (laneFits(op, device)) {
    const LaneShares shares = laneShares(op, device);
    result.program = programName("window_attention", KernelFamily::lane, op.output.type);
    const bool oneTensor = op.keys.value == op.values.value && op.keys.type == op.values.type;
    const bool queriesApart = op.queries.value != op.keys.value;
    const uint32_t rowCount = rows.end - rows.begin;
    const bool allRows =
        rowCount == shape.height || ((rows.begin + op.window - op.shift) % op.window == 0 && rowCount % op.window == 0);
    result.specialization = {device.subgroupSize, op.window, op.headChannels, shares.queries,
                             shares.keys,         oneTensor, queriesApart,    allRows};
    result.pushConstants = pushBytesWithDigits(params);
    result.groupCount = {laneGroupColumns(op, shares), windowRows.count, 1};
  } else if (const uint32_t invocations = matrixInvocations(op, device)) {
    result.program = matrixProgramName("window_attention", device.matrixUnits, op.output.type);
    result.specialization =
        matrixConstants({kMatrixSubgroups, op.headChannels, 0, 0, invocations}, device.matrixSize, op.shift > 0, 0);
    result.bindings[0] = readBits(op.queries);
    result.bindings[1] = readBits(op.keys);
    result.bindings[2] = readBits(op.values);
    countSubgroups(result, device);
    result.groupCount = {windowColumns, windowRows.count, headCount(op)};
  } else if (const uint32_t keys = tileKeys(op, device)) {
    result.program = programName("window_attention", KernelFamily::tile, op.output.type);
    result.specialization = {op.window * op.window, op.window, op.headChannels, keys, op.shift > 0};
    result.groupCount = {windowColumns, windowRows.count, headCount(op)};
  } else {
    result.program = programName("window_attention", KernelFamily::plain, op.output.type);
    result.specialization = {op.window, op.headChannels};
    result.groupCount = {ceilDivide(shape.width * op.window, 64), windowRows.count, headCount(op)};
  }
  return result;
}

std::vector<KernelShape> shapesToTry(const WindowAttention&, const DeviceTraits& device) {
  if (device.family != KernelFamily::lane) return {};
  return {{.rows = 4}, {.rows = 2}, {.rows = 1}};
}

std::vector<float> packedWeights(const WindowAttention& op, const DeviceTraits& device) {
  outputShape(op);
  if (laneFits(op, device)) return laneBias(op, laneShares(op, device), device.subgroupSize);
  std::vector<float> packed(op.biasTable.begin(), op.biasTable.end());
  packed.resize((packed.size() + 3) / 4 * 4);
  return packed;
}

void reference(const WindowAttention& op, HostMemory& memory) {
  const TensorShape shape = outputShape(op);
  const uint32_t height = shape.height, width = shape.width, channels = shape.channels;
  const RowRange rows = resolve(op.rows, height);
  const uint32_t w = op.window, d = op.headChannels;
  const Windows windows = windowsOf(op);
  std::vector<double> weights(w * w);
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < width; ++x)
      for (uint32_t head = 0; head < channels / d; ++head) {
        const uint32_t sy = (y + height - op.shift) % height, sx = (x + width - op.shift) % width;  // shifted image
        const auto keyPosition = [&](uint32_t key) { return std::pair{sy / w * w + key / w, sx / w * w + key % w}; };
        const auto keyPixel = [&](uint32_t key) {
          const auto [ky, kx] = keyPosition(key);
          return std::pair{(ky + op.shift) % height, (kx + op.shift) % width};
        };
        double highest = -INFINITY, sum = 0;
        for (uint32_t key = 0; key < w * w; ++key) {
          const auto [ky, kx] = keyPosition(key);
          const auto [py, px] = keyPixel(key);
          double product = 0;
          for (uint32_t c = head * d; c < (head + 1) * d; ++c)
            product += memory.at(op.queries, y, x, c) * memory.at(op.keys, py, px, c);
          const bool seen = windows.region(ky, height) == windows.region(sy, height) &&
                            windows.region(kx, width) == windows.region(sx, width);
          weights[key] = seen ? product / std::sqrt(d) + bias(op, sy % w * w + sx % w, key, head) : -INFINITY;
          highest = std::max(highest, weights[key]);
        }
        for (double& weight : weights) sum += weight = std::exp(weight - highest);
        for (uint32_t c = head * d; c < (head + 1) * d; ++c) {
          double result = 0;
          for (uint32_t key = 0; key < w * w; ++key) {
            const auto [py, px] = keyPixel(key);
            result += weights[key] / sum * memory.at(op.values, py, px, c);
          }
          memory.at(op.output, y, x, c) = result;
        }
      }
}

OperatorFacts facts(const WindowAttention& op) {
  return {"window_attention",
          {op.queries, op.keys, op.values},
          {1e-6, 5e-4},
          0,
          2 * computedPixels(op) * op.window * op.window * op.output.channels,
          {op.window, op.shift}};
}

void propagate(const WindowAttention& op, Moments& moments) {
  constexpr double kMostNoise = 2e-2;  // of a logit, from rounding query and key: the relative error of its exp
  for (uint32_t first = 0; first < op.queries.channels; first += op.headChannels) {
    double squares = 0;
    for (uint32_t c = first; c < first + op.headChannels; ++c)
      squares += moments.at(op.queries, c).square() * moments.at(op.keys, c).square();
    if (kHalfRounding * std::sqrt(2 * squares / op.headChannels) < kMostNoise) continue;
    for (const TensorView& view : {op.queries, op.keys}) moments.storeInF32(view, "large logits of attention");
  }
  // These may be slices of one tensor, of which checkRanges() sees the largest alone.
  for (const TensorView& view : {op.queries, op.keys, op.values}) moments.checkSmall(view);
  moments.copy(op.values, op.output);
}

void addExamples(ExampleMaker& maker, std::vector<WindowAttention>& examples) {
  const auto make = [&](uint32_t shift) {
    WindowAttention op{.queries = maker.view({16, 16, 32}),
                       .keys = maker.view({16, 16, 32}),
                       .values = maker.view({16, 16, 32}),
                       .output = maker.view({16, 16, 32})};
    op.headChannels = 16;
    op.biasTable = maker.weights(size_t{15} * 15 * 2);
    op.shift = shift;
    return op;
  };
  examples = {make(0), make(4)};
}

}  // namespace xrds
