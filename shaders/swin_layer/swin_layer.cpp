#include "shaders/swin_layer/swin_layer.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "engine/half.h"
#include "shaders/common/activation.h"
#include "shaders/common/example.h"
#include "shaders/common/matrix.h"
#include "shaders/common/moments.h"
#include "shaders/common/windows.h"

namespace xrds {
namespace {

constexpr uint32_t kTokens = shader::kSwinTokens;
constexpr double kLog2E = 1.4426950408889634;

uint32_t channelsOf(const SwinLayer& op) { return op.input.channels; }
uint32_t hiddenOf(const SwinLayer& op) { return static_cast<uint32_t>(op.fc1.bias.size()); }
uint32_t headCount(const SwinLayer& op) { return channelsOf(op) / op.headChannels; }
bool grows(const SwinLayer& op) { return !op.grow.bias.empty(); }

/// How a workgroup goes about its window.
struct WindowShare {
  uint32_t subgroups = 0;    // 0: the device has no kernel for the layer
  uint32_t invocations = 0;  // of the workgroup
  uint32_t scoreRows = 0;    // queries at a time
  uint32_t hiddenPart = 0;   // hidden features at a time
  uint32_t poolTexels = 0;   // of shared memory
};

/// The most queries and hidden features at a time for which there is room, with at least as many invocations.
WindowShare windowShare(const SwinLayer& op, const DeviceTraits& device, uint32_t leastInvocations) {
  constexpr uint32_t kLeastSubgroups = 4, kMostHidden = 128;
  constexpr uint32_t kTexelBytes = 16, kTexelHalves = 8, kMostShares = 8;  // invocations for a row of scores
  const uint32_t lanes = matrixLanes(device);
  WindowShare share{.subgroups = std::max(kLeastSubgroups, leastInvocations / lanes)};
  share.invocations = share.subgroups * lanes;
  const uint32_t tokenTexels = kTokens * (channelsOf(op) / kTexelHalves + 1);
  const uint32_t headTexels =
      kTokens * (2 * op.headChannels / kTexelHalves + 1) + op.headChannels * (kTokens / kTexelHalves + 1);
  const uint32_t scoreStride = kTokens / 4 + 1;
  const auto byteSize = [&](uint32_t texels) { return texels * kTexelBytes + share.invocations * 4; };
  for (share.scoreRows = kTokens; share.scoreRows >= 16; share.scoreRows /= 2) {
    share.poolTexels = tokenTexels + headTexels + share.scoreRows * scoreStride;
    if (byteSize(share.poolTexels) <= device.maxSharedBytes && share.invocations <= kMostShares * share.scoreRows)
      break;
  }
  for (share.hiddenPart = kMostHidden; share.hiddenPart >= 16; share.hiddenPart -= 16) {
    const uint32_t texels = tokenTexels + kTokens * (share.hiddenPart / kTexelHalves + 1);
    if (hiddenOf(op) % share.hiddenPart != 0 || byteSize(texels) > device.maxSharedBytes) continue;
    share.poolTexels = std::max(share.poolTexels, texels);
    break;
  }
  const bool isPossible = share.scoreRows >= 16 && share.hiddenPart >= 16 && share.invocations % kTokens == 0 &&
                          share.invocations <= device.maxGroupInvocations;
  if (!isPossible) share.subgroups = 0;
  return share;
}

/// Few windows fit the shared memory of a GPU beside each other: each has many invocations, to keep it busy. In
/// software they are few, because drivers take their time to compile more.
WindowShare windowShare(const SwinLayer& op, const DeviceTraits& device) {
  constexpr uint32_t kInvocations = 256, kFewInvocations = 128;
  const WindowShare share = inSoftware(device) ? WindowShare{} : windowShare(op, device, kInvocations);
  return share.subgroups > 0 ? share : windowShare(op, device, kFewInvocations);
}

/// [N][K] in double precision, as the kernel's tiles are made from it.
struct Matrix {
  uint32_t outputs = 0, inputs = 0;
  std::vector<double> weight, bias;
};

Matrix matrixOf(const SwinLayer::Map& map) {
  const size_t outputs = map.bias.size();
  return {static_cast<uint32_t>(outputs),
          static_cast<uint32_t>(map.weight.size() / outputs),
          {map.weight.begin(), map.weight.end()},
          {map.bias.begin(), map.bias.end()}};
}

/// The map of norm(x) as one of (x - mean) / deviation.
Matrix normed(const SwinLayer::Map& norm, const SwinLayer::Map& map) {
  Matrix matrix = matrixOf(map);
  for (size_t i = 0; i < matrix.weight.size(); ++i) {
    matrix.bias[i / matrix.inputs] += matrix.weight[i] * norm.bias[i % matrix.inputs];
    matrix.weight[i] *= norm.weight[i % matrix.inputs];
  }
  return matrix;
}

/// Scores are powers of two in the kernel.
Matrix scaledQueries(const SwinLayer& op) {
  Matrix matrix = normed(op.norm1, op.qkv);
  const double scale = kLog2E / std::sqrt(op.headChannels);
  for (uint32_t n = 0; n < channelsOf(op); ++n) {
    matrix.bias[n] *= scale;
    for (uint32_t k = 0; k < matrix.inputs; ++k) matrix.weight[size_t{n} * matrix.inputs + k] *= scale;
  }
  return matrix;
}

/// fc2, or grow of fc2.
Matrix lastMap(const SwinLayer& op) {
  const Matrix inner = matrixOf(op.fc2);
  if (!grows(op)) return inner;
  const Matrix outer = matrixOf(op.grow);
  Matrix product{outer.outputs, inner.inputs, std::vector<double>(size_t{outer.outputs} * inner.inputs), outer.bias};
  for (uint32_t n = 0; n < outer.outputs; ++n)
    for (uint32_t m = 0; m < outer.inputs; ++m) {
      const double w = outer.weight[size_t{n} * outer.inputs + m];
      product.bias[n] += w * inner.bias[m];
      for (uint32_t k = 0; k < inner.inputs; ++k)
        product.weight[size_t{n} * inner.inputs + k] += w * inner.weight[size_t{m} * inner.inputs + k];
    }
  return product;
}

/// A bias as two halves, of which the second is what the first lacks; `part` above 1: nothing.
double partOfBias(double bias, uint32_t part) {
  const float rounded = fromHalf(toHalf(static_cast<float>(bias)));
  return part == 0 ? rounded : part == 1 && std::isfinite(rounded) ? bias - rounded : 0;
}

/// Writes tiles of 16 x 16, row by row.
class Tiles {
 public:
  std::vector<float> numbers;

  void add(auto&& at) {
    for (uint32_t row = 0; row < 16; ++row)
      for (uint32_t column = 0; column < 16; ++column) numbers.push_back(static_cast<float>(at(row, column)));
  }
  /// The outputs from `first` on, `count` of them in sixteens.
  void addMap(const Matrix& matrix, uint32_t first, uint32_t count, bool withBias = true) {
    for (uint32_t n = first; n < first + count; n += 16) {
      if (withBias) add([&](uint32_t row, uint32_t k) { return partOfBias(matrix.bias[n + row], k); });
      for (uint32_t k = 0; k < matrix.inputs; k += 16)
        add([&](uint32_t row, uint32_t column) { return matrix.weight[size_t{n + row} * matrix.inputs + k + column]; });
    }
  }
  void addMap(const Matrix& matrix, bool withBias = true) { addMap(matrix, 0, matrix.outputs, withBias); }
};

Windows windowsOf(const SwinLayer& op) { return {op.window, op.shift}; }

double bias(const SwinLayer& op, uint32_t query, uint32_t key, uint32_t head) {
  return op.biasTable[windowsOf(op).relativePosition(query, key) * headCount(op) + head];
}

void addScoreBiases(const SwinLayer& op, std::vector<float>& numbers) {
  constexpr double kMasked = -1e4;  // 2 to that is 0, whatever the largest score
  const Windows windows = windowsOf(op);
  for (uint32_t windowClass = 0; windowClass < windows.classCount(); ++windowClass)
    for (uint32_t head = 0; head < headCount(op); ++head)
      for (uint32_t query = 0; query < kTokens; ++query)
        for (uint32_t key = 0; key < kTokens; ++key)
          numbers.push_back(static_cast<float>(
              windows.isParted(query, key, windowClass) ? kMasked : bias(op, query, key, head) * kLog2E));
}

}  // namespace

TensorShape outputShape(const SwinLayer& op) {
  const uint32_t c = channelsOf(op);
  checkView(op.input, op.input.shape());
  XRDS_CHECK_LE(2u, op.window);
  XRDS_CHECK(op.shift == 0 || 2 * op.shift == op.window);
  XRDS_CHECK_EQ(op.input.height % op.window, 0u);
  XRDS_CHECK_EQ(op.input.width % op.window, 0u);
  XRDS_CHECK_LT(0u, op.headChannels);
  XRDS_CHECK_EQ(c % op.headChannels, 0u);
  const auto checkMap = [](const SwinLayer::Map& map, size_t outputs, size_t inputs) {
    XRDS_CHECK_EQ(map.bias.size(), outputs);
    XRDS_CHECK_EQ(map.weight.size(), outputs * inputs);
  };
  for (const SwinLayer::Map* norm : {&op.norm1, &op.norm2}) checkMap(*norm, c, 1);
  checkMap(op.qkv, 3 * c, c);
  checkMap(op.proj, c, c);
  checkMap(op.fc1, hiddenOf(op), c);
  checkMap(op.fc2, c, hiddenOf(op));
  checkMap(op.grow, op.grow.bias.size(), c);
  const size_t relativePositions = size_t{2 * op.window - 1} * (2 * op.window - 1);
  XRDS_CHECK_EQ(op.biasTable.size(), relativePositions * headCount(op));
  return {op.input.height, op.input.width, grows(op) ? static_cast<uint32_t>(op.grow.bias.size()) : c};
}

bool fits(const SwinLayer& op, const DeviceTraits& device) {
  constexpr float kLargestBias = 16;  // of which a half is off by less than findPromotions() allows a score
  const TensorShape shape = outputShape(op);
  const auto isHeldWell = [](float bias) { return std::abs(bias) <= kLargestBias; };
  return device.family == KernelFamily::fused && device.matrixSize.halfSums && op.input.type == DataType::f16 &&
         op.output.type == DataType::f16 && op.window == shader::kSwinWindow &&
         (op.headChannels | hiddenOf(op) | shape.channels) % 16 == 0 && shape.channels <= channelsOf(op) &&
         std::all_of(op.biasTable.begin(), op.biasTable.end(), isHeldWell) && windowShare(op, device).subgroups > 0;
}

uint64_t mapMultiplyAdds(const SwinLayer& op) {
  const RowRange rows = resolve(op.rows, op.output.height);
  const uint64_t c = channelsOf(op), last = op.output.channels,
                 tokens = uint64_t{rows.end - rows.begin} * op.output.width;
  return tokens * (4 * c * c + c * hiddenOf(op) + hiddenOf(op) * last + (grows(op) ? c * last : 0));
}

uint64_t attentionMultiplyAdds(const SwinLayer& op) {
  const RowRange rows = resolve(op.rows, op.output.height);
  return 2ull * (rows.end - rows.begin) * op.output.width * channelsOf(op) * op.window * op.window;
}

Dispatch dispatch(const SwinLayer& op, const DeviceTraits& device) {
  const TensorShape shape = outputShape(op);
  checkView(op.output, shape);
  const RowRange rows = resolve(op.rows, shape.height);
  const Windows::Rows windowRows = windowsOf(op).rowsThatMeet(rows, shape.height);
  const shader::SwinLayerParams params{.source = sliceOf(op.input),
                                       .target = sliceOf(op.output),
                                       .width = shape.width,
                                       .height = shape.height,
                                       .rowBegin = rows.begin,
                                       .rowEnd = rows.end,
                                       .shift = op.shift,
                                       .firstWindowRow = windowRows.first,
                                       .storeOrigin = storeOrigin(op.output, rows),
                                       .epsilon = op.epsilon};
  const WindowShare share = windowShare(op, device);
  const MatrixSize unit = device.matrixSize;
  Dispatch launch{.bindings = {readTexels(op.input), readPackedHalves(), writeRows(op.output, rows)},
                  .pushConstants = pushBytes(params),
                  .multiplyAdds = mapMultiplyAdds(op) + attentionMultiplyAdds(op)};
  launch.program =
      matrixProgramName("swin_layer", inSoftware(device) ? MatrixUnits::software : device.matrixUnits, DataType::f16);
  launch.specialization = {share.subgroups, channelsOf(op),   op.headChannels,  hiddenOf(op), shape.channels,
                           grows(op),       unit.rows,        unit.columns,     unit.depth,   share.invocations,
                           share.scoreRows, share.hiddenPart, share.poolTexels, op.shift > 0};
  countSubgroups(launch, device);
  launch.groupCount = {shape.width / op.window, windowRows.count, 1};
  return launch;
}

std::vector<float> packedWeights(const SwinLayer& op, const DeviceTraits&) {
  const uint32_t c = channelsOf(op), d = op.headChannels;
  Tiles tiles;
  const Matrix qkv = scaledQueries(op);
  for (uint32_t head = 0; head < headCount(op); ++head)
    for (uint32_t part = 0; part < 3; ++part) tiles.addMap(qkv, part * c + head * d, d);
  addScoreBiases(op, tiles.numbers);
  tiles.addMap(matrixOf(op.proj));
  tiles.addMap(normed(op.norm2, op.fc1));
  tiles.addMap(lastMap(op));
  if (grows(op)) tiles.addMap(matrixOf(op.grow), false);
  tiles.add([](uint32_t row, uint32_t column) { return row == column; });
  return std::move(tiles.numbers);
}

namespace {

using Tokens = std::vector<std::vector<double>>;  // of a window

std::vector<double> mapped(const SwinLayer::Map& map, const std::vector<double>& x) {
  std::vector<double> y(map.bias.begin(), map.bias.end());
  for (size_t i = 0; i < map.weight.size(); ++i) y[i / x.size()] += map.weight[i] * x[i % x.size()];
  return y;
}

void add(const std::vector<double>& x, std::vector<double>& sum) {
  for (size_t i = 0; i < x.size(); ++i) sum[i] += x[i];
}

std::vector<double> normalized(const SwinLayer& op, const SwinLayer::Map& norm, std::vector<double> x) {
  const auto count = static_cast<double>(x.size());
  double mean = 0, variance = 0;
  for (const double v : x) mean += v / count;
  for (const double v : x) variance += (v - mean) * (v - mean) / count;
  for (size_t i = 0; i < x.size(); ++i)
    x[i] = (x[i] - mean) / std::sqrt(variance + op.epsilon) * norm.weight[i] + norm.bias[i];
  return x;
}

// WMSA without the map behind it. `isSeen` tells whether a query sees a key.
Tokens attended(const SwinLayer& op, const Tokens& qkv, const std::function<bool(uint32_t, uint32_t)>& isSeen) {
  const uint32_t c = channelsOf(op), d = op.headChannels;
  Tokens heads(qkv.size(), std::vector<double>(c));
  std::vector<double> weights(qkv.size());
  for (uint32_t head = 0; head < headCount(op); ++head)
    for (uint32_t query = 0; query < qkv.size(); ++query) {
      for (uint32_t key = 0; key < qkv.size(); ++key) {
        double product = 0;
        for (uint32_t i = head * d; i < (head + 1) * d; ++i) product += qkv[query][i] * qkv[key][c + i];
        weights[key] = isSeen(query, key) ? product / std::sqrt(d) + bias(op, query, key, head) : -INFINITY;
      }
      const double highest = *std::max_element(weights.begin(), weights.end());
      double sum = 0;
      for (double& weight : weights) sum += weight = std::exp(weight - highest);
      for (uint32_t key = 0; key < qkv.size(); ++key)
        for (uint32_t i = head * d; i < (head + 1) * d; ++i)
          heads[query][i] += weights[key] / sum * qkv[key][2 * c + i];
    }
  return heads;
}

}  // namespace

void reference(const SwinLayer& op, HostMemory& memory) {
  const TensorShape shape = outputShape(op);
  const RowRange rows = resolve(op.rows, shape.height);
  const uint32_t w = op.window;
  for (uint32_t top = 0; top < shape.height; top += w) {
    const auto yOf = [&](uint32_t token) { return (top + token / w + op.shift) % shape.height; };
    const auto isAsked = [&](uint32_t token) { return yOf(token) >= rows.begin && yOf(token) < rows.end; };
    bool meetsRows = false;
    for (uint32_t token = 0; token < w * w; token += w) meetsRows = meetsRows || isAsked(token);
    if (!meetsRows) continue;
    for (uint32_t left = 0; left < shape.width; left += w) {
      const auto xOf = [&](uint32_t token) { return (left + token % w + op.shift) % shape.width; };
      Tokens tokens(w * w, std::vector<double>(channelsOf(op))), qkv;
      for (uint32_t token = 0; token < w * w; ++token) {
        for (uint32_t k = 0; k < channelsOf(op); ++k) tokens[token][k] = memory.at(op.input, yOf(token), xOf(token), k);
        qkv.push_back(mapped(op.qkv, normalized(op, op.norm1, tokens[token])));
      }
      const auto regionOf = [&](uint32_t token) {
        const Windows windows = windowsOf(op);
        return std::pair{windows.region(top + token / w, shape.height), windows.region(left + token % w, shape.width)};
      };
      const Tokens heads =
          attended(op, qkv, [&](uint32_t query, uint32_t key) { return regionOf(query) == regionOf(key); });
      for (uint32_t token = 0; token < w * w; ++token) {
        std::vector<double>& u = tokens[token];
        add(mapped(op.proj, heads[token]), u);
        std::vector<double> hidden = mapped(op.fc1, normalized(op, op.norm2, u));
        for (double& v : hidden) v = activate(Activation::gelu, v);
        add(mapped(op.fc2, hidden), u);
        const std::vector<double> y = grows(op) ? mapped(op.grow, u) : u;
        if (!isAsked(token)) continue;
        for (uint32_t n = 0; n < y.size(); ++n) memory.at(op.output, yOf(token), xOf(token), n) = y[n];
      }
    }
  }
}

OperatorFacts facts(const SwinLayer& op) {
  // Four maps and an attention in one, whose features between them are halves; there is none in fp32.
  return {"swin_layer",         {op.input}, {1e-6, 1e-3}, mapMultiplyAdds(op), attentionMultiplyAdds(op),
          {op.window, op.shift}};
}

void propagate(const SwinLayer&, Moments&) {
  throw std::logic_error("layers are fused after what they store is known");
}

void addExamples(ExampleMaker& maker, std::vector<SwinLayer>& examples) {
  constexpr uint32_t kChannels = 32;
  SwinLayer op{.input = maker.view({16, 16, kChannels}), .output = maker.view({16, 16, kChannels})};
  const auto map = [&](uint32_t outputs, uint32_t inputs) -> SwinLayer::Map {
    return {maker.weights(size_t{outputs} * inputs), maker.weights(outputs)};
  };
  op.norm1 = map(kChannels, 1);
  op.norm2 = map(kChannels, 1);
  op.qkv = map(3 * kChannels, kChannels);
  op.proj = map(kChannels, kChannels);
  op.fc1 = map(2 * kChannels, kChannels);
  op.fc2 = map(kChannels, 2 * kChannels);
  op.headChannels = 16;
  op.shift = 4;
  op.biasTable = maker.weights(size_t{15} * 15 * headCount(op));
  if (fits(op, maker.device())) examples.push_back(op);
}

}  // namespace xrds
