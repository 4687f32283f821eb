#include "frames/quiet_windows.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "xrds/auxiliary_input.h"
#include "xrds/error.h"

namespace xrds {
namespace {

constexpr uint32_t kMargin = 2;               // the base image's kernels reach so far
constexpr float kBackgroundSlack = 4;         // bench/skip.md: the residual is smallest there
constexpr float kGuideTolerance = 1.f / 128;  // normals are often stored in steps of 1/512

float clampedAlbedo(float value) { return std::clamp(value, 0.f, shader::kAlbedoMax); }

struct Range {
  uint32_t begin, end;
};

Range around(uint32_t index, uint32_t windowSize, uint32_t size) {
  const uint32_t begin = index * windowSize;
  return {begin - std::min(begin, kMargin), std::min(begin + windowSize + kMargin, size)};
}

/// Where a high-resolution pixel lies between two low-resolution ones, half-pixel centres, edges replicated.
struct Between {
  uint32_t first, second;
  float share;  // of the second
};

Between between(uint32_t position, uint32_t scale, uint32_t size) {
  const float at = (static_cast<float>(position) + 0.5f) / static_cast<float>(scale) - 0.5f;
  const float low = std::floor(at);
  const auto clamped = [&](float i) { return static_cast<uint32_t>(std::clamp(i, 0.f, static_cast<float>(size - 1))); };
  return {clamped(low), clamped(low + 1), at - low};
}

}  // namespace

std::string whyNeverQuiet(const NetworkConfig& config) {
  if (config.base == BaseImage::none) return "has no base image that could stand for its result";
  if (config.transfer == Transfer::none) return "works on linear radiance, where no relative bound holds";
  if (config.groups == 0) return "has no network to leave out";
  if (config.prefilter > 0) return "filters the colour further than the windows reach that the bound is asked of";
  if (!config.radianceInputs().empty()) return "takes full-resolution light, whose noise is nowhere quiet";
  return {};
}

QuietWindows::QuietWindows(const NetworkConfig& config, const PixelView& colour, std::span<const PixelView> auxiliary,
                           float exposure, float bound)
    : scale_(config.scale),
      windowSize_(config.window),
      frame_{colour.height, colour.width},
      colour_(colour),
      ratios_(size_t{3} * colour.width * colour.height),
      needed_(frame_, config.window, true) {
  if (const std::string why = whyNeverQuiet(config); !why.empty()) throw InvalidArgument("The model " + why + ".");
  std::vector<PixelView> guides;
  for (size_t i = 0; i < auxiliary.size(); ++i) {
    if (config.demodulates() && config.auxInputs[i] == kAlbedo.name)
      albedo_ = auxiliary[i];
    else
      guides.push_back(auxiliary[i]);
  }
  guideCount_ = guides.size();
  readBoxes(guides);
  for (uint32_t row = 0; row < needed_.rows; ++row)
    for (uint32_t column = 0; column < needed_.columns; ++column)
      needed_.at(row, column) = !quiet(row, column, exposure, bound);
}

// One pass over every pixel: all that is asked of an image later is known for each of its boxes of s x s pixels.
void QuietWindows::readBoxes(std::span<const PixelView> guides) {
  guides_.resize(guideCount_ * frame_.width * frame_.height);
  unevenness_.resize(size_t{frame_.width} * frame_.height);
  const auto box = [&](const PixelView& image, uint32_t x, uint32_t y, const auto& visit) {
    for (uint32_t row = y * scale_; row < (y + 1) * scale_; ++row) {
      const float* pixel = image.pixels + (size_t{row} * image.width + size_t{x} * scale_) * image.stride;
      for (uint32_t i = 0; i < scale_; ++i, pixel += image.stride)
        for (uint32_t c = 0; c < 3; ++c) visit(c, pixel[c]);
    }
  };
  const float share = 1.f / static_cast<float>(scale_ * scale_);
  for (uint32_t y = 0; y < frame_.height; ++y)
    for (uint32_t x = 0; x < frame_.width; ++x) {
      const size_t at = size_t{y} * frame_.width + x;
      float mean[3] = {1, 1, 1}, furthest[3] = {};
      bool finite = true;
      if (albedo_.pixels) {
        std::fill_n(mean, 3, shader::kAlbedoEpsilon);
        box(albedo_, x, y, [&](uint32_t c, float v) {
          mean[c] += share * clampedAlbedo(v);
          finite &= std::isfinite(v);
        });
        box(albedo_, x, y, [&](uint32_t c, float v) {
          furthest[c] = std::max(furthest[c], std::abs(clampedAlbedo(v) + shader::kAlbedoEpsilon - mean[c]));
        });
      }
      for (size_t g = 0; g < guides.size(); ++g) {
        Guide& guide = guides_[at * guideCount_ + g];
        std::fill_n(guide.least, 3, std::numeric_limits<float>::infinity());
        std::fill_n(guide.greatest, 3, -std::numeric_limits<float>::infinity());
        box(guides[g], x, y, [&](uint32_t c, float v) {
          guide.least[c] = std::min(guide.least[c], v);
          guide.greatest[c] = std::max(guide.greatest[c], v);
          finite &= std::isfinite(v);
        });
      }
      for (uint32_t c = 0; c < 3; ++c) {
        const float radiance = std::max(colour_.pixels[at * colour_.stride + c], 0.f);
        ratios_[3 * at + c] = finite ? radiance / mean[c] : NAN;
        unevenness_[at] = std::max(unevenness_[at], furthest[c] / mean[c]);
      }
    }
}

// Comparisons are written so that a NaN, which marks auxiliary images that are not finite, makes no window quiet.
bool QuietWindows::quiet(uint32_t row, uint32_t column, float exposure, float bound) const {
  const Range ys = around(row, windowSize_, frame_.height), xs = around(column, windowSize_, frame_.width);
  const size_t corner = size_t{ys.begin} * frame_.width + xs.begin;
  float least[3], greatest[3], unevenness = 0;
  std::copy_n(&ratios_[3 * corner], 3, least);
  std::copy_n(&ratios_[3 * corner], 3, greatest);
  std::vector<Guide> spans(guides_.begin() + static_cast<ptrdiff_t>(corner * guideCount_),
                           guides_.begin() + static_cast<ptrdiff_t>((corner + 1) * guideCount_));
  for (uint32_t y = ys.begin; y < ys.end; ++y)
    for (uint32_t x = xs.begin; x < xs.end; ++x) {
      const size_t at = size_t{y} * frame_.width + x;
      unevenness = std::max(unevenness, unevenness_[at]);
      for (uint32_t c = 0; c < 3; ++c) {
        const float ratio = ratios_[3 * at + c];
        if (!(ratio >= 0)) return false;
        least[c] = std::min(least[c], ratio);
        greatest[c] = std::max(greatest[c], ratio);
      }
      for (size_t g = 0; g < guideCount_; ++g)
        for (uint32_t c = 0; c < 3; ++c) {
          const Guide& guide = guides_[at * guideCount_ + g];
          spans[g].least[c] = std::min(spans[g].least[c], guide.least[c]);
          spans[g].greatest[c] = std::max(spans[g].greatest[c], guide.greatest[c]);
          if (!(spans[g].greatest[c] - spans[g].least[c] <= kGuideTolerance)) return false;
        }
    }
  const bool background = guideCount_ > 0 && std::all_of(spans.begin(), spans.end(), [](const Guide& guide) {
                            return std::all_of(guide.least, guide.least + 3, [](float v) { return v == 0; }) &&
                                   std::all_of(guide.greatest, guide.greatest + 3, [](float v) { return v == 0; });
                          });
  const float limit = background ? kBackgroundSlack * bound : bound;
  if (!(unevenness <= (background ? kBackgroundSlack : 1) * limit)) return false;
  for (uint32_t c = 0; c < 3; ++c)
    if (!(std::log1p(exposure * greatest[c]) - std::log1p(exposure * least[c]) <= limit &&
          std::log1p(exposure * greatest[c]) < shader::kTransformedMax))
      return false;
  return true;
}

void QuietWindows::fill(const WindowMask& marked, std::span<float> output) const {
  for (uint32_t row = 0; row < marked.rows; ++row)
    for (uint32_t column = 0; column < marked.columns; ++column)
      if (marked.at(row, column)) fillWindow(row, column, output);
}

void QuietWindows::fillWindow(uint32_t row, uint32_t column, std::span<float> output) const {
  const uint32_t width = frame_.width * scale_, side = windowSize_ * scale_, left = column * side;
  const uint32_t right = std::min(left + side, width), bottom = std::min((row + 1) * side, frame_.height * scale_);
  std::vector<Between> columns;
  for (uint32_t x = left; x < right; ++x) columns.push_back(between(x, scale_, frame_.width));
  const uint32_t first = columns.front().first, end = columns.back().second + 1;
  std::vector<float> ratios(size_t{3} * (end - first));  // of a row of the output
  for (uint32_t y = row * side; y < bottom; ++y) {
    const Between rows = between(y, scale_, frame_.height);
    const float* above = &ratios_[3 * (size_t{rows.first} * frame_.width + first)];
    const float* below = &ratios_[3 * (size_t{rows.second} * frame_.width + first)];
    for (size_t i = 0; i < ratios.size(); ++i) ratios[i] = above[i] + rows.share * (below[i] - above[i]);
    float* pixel = &output[3 * (size_t{y} * width + left)];
    const float* albedo = albedo_.pixels ? albedo_.pixels + (size_t{y} * width + left) * albedo_.stride : nullptr;
    for (const Between& at : columns) {
      for (uint32_t c = 0; c < 3; ++c) {
        const float a = ratios[3 * (at.first - first) + c], b = ratios[3 * (at.second - first) + c];
        pixel[c] = (a + at.share * (b - a)) * (albedo ? clampedAlbedo(albedo[c]) + shader::kAlbedoEpsilon : 1.f);
      }
      pixel += 3;
      if (albedo) albedo += albedo_.stride;
    }
  }
}

}  // namespace xrds
