#include "image/shift_check.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace xrds {
namespace {

constexpr int kLeastSide = 12;         // Of the low-resolution image, without which an edge says little.
constexpr int kMostFullSide = 1024;    // What is looked at of large images, in the middle.
constexpr double kClearlyLess = 0.7;   // Of the squared difference; noise alone changes it by a few per cent.
constexpr double kMostOfMean = 16.0;   // Single bright samples count as so many times the mean.
constexpr double kLeastError = 1e-12;  // Below, mean of squares, the two are the same.

double brightness(const Image& image, int x, int y) {
  double sum = 0.0;
  const int channels = std::min(image.channels, 3);
  for (int c = 0; c < channels; ++c) sum += double(image.at(x, y, c));
  return sum / channels;
}

/// A rectangle of the low-resolution image.
struct Middle {
  int x = 0, y = 0, width = 0, height = 0;
};

Middle middleOf(const Image& low, int scale) {
  const int most = kMostFullSide / scale;
  const int width = std::min(low.width, most), height = std::min(low.height, most);
  return {(low.width - width) / 2, (low.height - height) / 2, width, height};
}

/// Sums over all pixels of the full-resolution image above and left of one.
class Sums {
 public:
  Sums(const Image& full, const Middle& middle, int scale, double most)
      : stride_(size_t(middle.width * scale) + 1), sums_(stride_ * (size_t(middle.height * scale) + 1)) {
    for (int y = 0; y < middle.height * scale; ++y) {
      double row = 0.0;
      for (int x = 0; x < middle.width * scale; ++x) {
        row += std::min(brightness(full, middle.x * scale + x, middle.y * scale + y), most);
        sums_[at(x + 1, y + 1)] = sums_[at(x + 1, y)] + row;
      }
    }
  }
  double mean(int x, int y, int scale) const {
    const double sum =
        sums_[at(x + scale, y + scale)] - sums_[at(x, y + scale)] - sums_[at(x + scale, y)] + sums_[at(x, y)];
    return std::max(0.0, sum / (scale * scale));
  }

 private:
  size_t at(int x, int y) const { return size_t(y) * stride_ + size_t(x); }
  size_t stride_;
  std::vector<double> sums_;
};

std::string stepText(int right, int down) {
  const auto text = [](int count, const char* forward, const char* back) {
    const std::string number = std::to_string(std::abs(count));
    return number + (number == "1" ? " pixel " : " pixels ") + (count > 0 ? forward : back);
  };
  const std::string across = text(right, "to the right", "to the left"), along = text(down, "down", "up");
  return right == 0 ? along : down == 0 ? across : across + " and " + along;
}

}  // namespace

std::vector<std::string> checkShift(const Image& low, const NamedLayer& full) {
  const int scale = full.image->width / std::max(low.width, 1);
  if (std::min(low.width, low.height) < kLeastSide || scale < 2 || full.image->width != scale * low.width ||
      full.image->height != scale * low.height)
    return {};
  const Middle middle = middleOf(low, scale);
  double mean = 0.0;
  for (int y = 0; y < middle.height; ++y)
    for (int x = 0; x < middle.width; ++x) mean += brightness(low, middle.x + x, middle.y + y);
  mean /= double(middle.width) * middle.height;
  if (!(mean > 0.0)) return {};
  const Sums sums(*full.image, middle, scale, kMostOfMean * mean);
  const auto tone = [&](double radiance) { return std::log1p(std::min(radiance, kMostOfMean * mean) / mean); };
  std::vector<double> wanted;
  for (int y = 1; y < middle.height - 1; ++y)
    for (int x = 1; x < middle.width - 1; ++x) wanted.push_back(tone(brightness(low, middle.x + x, middle.y + y)));
  const auto errorOf = [&](int dx, int dy) {
    double sum = 0.0;
    auto value = wanted.begin();
    for (int y = 1; y < middle.height - 1; ++y)
      for (int x = 1; x < middle.width - 1; ++x) {
        const double difference = tone(sums.mean(x * scale - dx, y * scale - dy, scale)) - *value++;
        sum += difference * difference;
      }
    return sum / double(wanted.size());
  };
  const double inPlace = errorOf(0, 0);
  if (inPlace < kLeastError) return {};
  double least = inPlace;
  int right = 0, down = 0;
  for (int dy = -scale; dy <= scale; ++dy)
    for (int dx = -scale; dx <= scale; ++dx)
      if (const double error = errorOf(dx, dy); error < least) least = error, right = dx, down = dy;
  if (least > kClearlyLess * inPlace) return {};
  return {"The two renders do not show the same part of the picture: moved by " + stepText(right, down) + ", " +
          (full.name.empty() ? "the full-resolution colour" : "'" + full.name + "'") +
          " fits the other one better. Some renderers move their pictures by a part of a pixel, whatever its size "
          "(docs/renderers.md)."};
}

}  // namespace xrds
