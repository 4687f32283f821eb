#include "shaders/pack_auxiliary/pack_auxiliary.h"

#include <algorithm>
#include <bit>

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {
namespace {

bool isOf(uint32_t channel, int offset) {
  return offset >= 0 && static_cast<int>(channel) >= offset && static_cast<int>(channel) < offset + 3;
}

// The channels beyond the mask are none.
bool isLight(const PackAuxiliary& op, uint32_t channel) {
  return channel < 32 && (op.lightChannels >> channel & 1) != 0;
}

bool isRadiance(const PackAuxiliary& op, uint32_t channel) {
  return isOf(channel, op.colourOffset) || isLight(op, channel);
}

double albedoOf(double value) { return std::clamp(value, 0.0, double{shader::kAlbedoMax}); }

}  // namespace

TensorShape outputShape(const PackAuxiliary& op) {
  checkHolds(op.input, {1, 1, 4});
  checkHolds(op.output, op.input.shape());
  XRDS_CHECK_EQ(op.output.channels, op.input.channels);
  XRDS_CHECK_LE(-1, op.albedoOffset);
  XRDS_CHECK_LE(op.albedoOffset + 3, static_cast<int>(op.input.channels));
  XRDS_CHECK_LE(-1, op.colourOffset);
  XRDS_CHECK_LE(op.colourOffset + 3, static_cast<int>(op.input.channels));
  XRDS_CHECK_LE(static_cast<int>(std::bit_width(op.lightChannels)), static_cast<int>(op.input.channels));
  if (op.takesRadiance()) checkView(op.exposure, {1, 1, 4});
  XRDS_CHECK(!op.demodulates || op.albedoOffset >= 0);
  return op.output.shape();
}

Dispatch dispatch(const PackAuxiliary& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  // An unread binding must still name something.
  const TensorView& exposure = op.takesRadiance() ? op.exposure : op.input;
  const shader::PackAuxiliaryParams params{imageOf(op.input), imageOf(op.output), targetRows(op.output, rows),
                                           imageOf(exposure).offset};
  return imageDispatch(
      "pack_auxiliary", device, op.output, rows, 1, params,
      {op.output.channels, static_cast<uint32_t>(op.albedoOffset), static_cast<uint32_t>(op.colourOffset),
       op.demodulates, static_cast<uint32_t>(op.transfer), op.lightChannels},
      {readTexels(op.input), readTexels(exposure), writeRows(op.output, rows)});
}

std::vector<float> packedWeights(const PackAuxiliary&, const DeviceTraits&) { return {}; }

void reference(const PackAuxiliary& op, HostMemory& memory) {
  const auto [height, width, channels] = outputShape(op);
  const RowRange rows = resolve(op.rows, height);
  const double limit = shader::kAuxiliaryMax;
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < width; ++x)
      for (uint32_t c = 0; c < channels; ++c) {
        const auto from = [&](uint32_t channel) {
          return memory.at(op.input, std::min(y, op.input.height - 1), std::min(x, op.input.width - 1), channel);
        };
        double value = from(c);
        if (isRadiance(op, c)) {
          value = std::max(value, 0.0) * memory.at(op.exposure, 0, 0, 0);
          const auto albedo = static_cast<uint32_t>(op.albedoOffset + static_cast<int>(c) - op.colourOffset);
          if (op.demodulates && !isLight(op, c)) value /= albedoOf(from(albedo)) + shader::kAlbedoEpsilon;
          value = transform(op.transfer, value);
        }
        memory.at(op.output, y, x, c) = isOf(c, op.albedoOffset) ? albedoOf(value) : std::clamp(value, -limit, limit);
      }
}

OperatorFacts facts(const PackAuxiliary& op) {
  return {"pack_auxiliary", {op.input, op.exposure}, {op.takesRadiance() ? 5e-7 : 1e-7, 4e-4}};
}

void propagate(const PackAuxiliary& op, Moments& moments) {
  for (uint32_t c = 0; c < op.output.channels; ++c) {
    const Moment radiance{1, 2}, albedo{0.5, 0.1}, unitVector{0, 0.33};  // radiance: T of values around mid-grey
    moments.at(op.output, c) = isOf(c, op.albedoOffset) ? albedo : isRadiance(op, c) ? radiance : unitVector;
  }
}

void addExamples(ExampleMaker& maker, std::vector<PackAuxiliary>& examples) {
  examples.push_back(
      {.input = maker.view({16, 16, 8}, DataType::f32), .output = maker.view({24, 24, 8}), .albedoOffset = 0});
  examples.push_back({.input = maker.view({16, 16, 12}, DataType::f32),
                      .output = maker.view({24, 24, 12}),
                      .albedoOffset = 0,
                      .colourOffset = 6,
                      .exposure = maker.exposure(),
                      .demodulates = true,
                      .transfer = Transfer::log1p});
  examples.push_back({.input = maker.view({16, 16, 16}, DataType::f32),
                      .output = maker.view({24, 24, 16}),
                      .albedoOffset = 0,
                      .colourOffset = 9,
                      .lightChannels = 7u << 6 | 7u << 12,
                      .exposure = maker.exposure(),
                      .demodulates = true,
                      .transfer = Transfer::log1p});
}

}  // namespace xrds
