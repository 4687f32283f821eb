#include "image/repair.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace xrds {
namespace {

enum class PixelState : uint8_t { kFinite, kHole, kQueued };

struct Position {
  int x;
  int y;
};

template <typename Visit>
void visitNeighbours(const Image& image, Position p, Visit&& visit) {
  for (int y = std::max(p.y - 1, 0); y <= std::min(p.y + 1, image.height - 1); ++y) {
    for (int x = std::max(p.x - 1, 0); x <= std::min(p.x + 1, image.width - 1); ++x) {
      if (x != p.x || y != p.y) {
        visit(Position{x, y});
      }
    }
  }
}

bool isFinite(const Image& image, size_t pixel) {
  const auto first = image.pixels.begin() + static_cast<ptrdiff_t>(pixel * size_t(image.channels));
  return std::all_of(first, first + image.channels, [](float value) { return std::isfinite(value); });
}

/// The holes of an image and the ring of them that is filled next.
class HoleFiller {
 public:
  explicit HoleFiller(Image& image) : image_(image), states_(image.pixelCount(), PixelState::kFinite) {
    for (size_t pixel = 0; pixel < states_.size(); ++pixel) {
      if (!isFinite(image, pixel)) {
        states_[pixel] = PixelState::kHole;
        ++holeCount_;
      }
    }
  }

  size_t fill() {
    std::vector<Position> ring = firstRing();
    while (!ring.empty()) {
      ring = fillRing(ring);
    }
    for (size_t pixel = 0; pixel < states_.size(); ++pixel) {
      if (states_[pixel] == PixelState::kHole) {
        std::fill_n(image_.pixels.begin() + static_cast<ptrdiff_t>(pixel * size_t(image_.channels)), image_.channels,
                    0.0F);
      }
    }
    return holeCount_;
  }

 private:
  PixelState& state(Position p) { return states_[size_t(p.y) * size_t(image_.width) + size_t(p.x)]; }

  std::vector<Position> firstRing() {
    std::vector<Position> ring;
    for (int y = 0; holeCount_ > 0 && y < image_.height; ++y) {
      for (int x = 0; x < image_.width; ++x) {
        bool touchesFinite = false;
        if (state({x, y}) == PixelState::kHole) {
          visitNeighbours(image_, {x, y}, [&](Position n) { touchesFinite |= state(n) == PixelState::kFinite; });
        }
        if (touchesFinite) {
          ring.push_back({x, y});
        }
      }
    }
    return ring;
  }

  void fillPixel(Position p) {
    for (int c = 0; c < image_.channels; ++c) {
      double sum = 0.0;
      int count = 0;
      visitNeighbours(image_, p, [&](Position n) {
        if (state(n) == PixelState::kFinite) {
          sum += image_.at(n.x, n.y, c);
          ++count;
        }
      });
      image_.at(p.x, p.y, c) = static_cast<float>(sum / count);
    }
  }

  // A ring is filled from the pixels around it only, never from itself, so that the order of its pixels is no matter.
  std::vector<Position> fillRing(const std::vector<Position>& ring) {
    for (const Position p : ring) {
      state(p) = PixelState::kQueued;
    }
    for (const Position p : ring) {
      fillPixel(p);
    }
    std::vector<Position> next;
    for (const Position p : ring) {
      state(p) = PixelState::kFinite;
      visitNeighbours(image_, p, [&](Position n) {
        if (state(n) == PixelState::kHole) {
          state(n) = PixelState::kQueued;
          next.push_back(n);
        }
      });
    }
    return next;
  }

  Image& image_;
  std::vector<PixelState> states_;
  size_t holeCount_ = 0;
};

// Sets the negative values of finite pixels to 0; returns how many pixels had one.
size_t clampNegative(Image& image) {
  size_t count = 0;
  const auto channels = static_cast<size_t>(image.channels);
  for (size_t pixel = 0; pixel < image.pixelCount(); ++pixel) {
    float* values = &image.pixels[pixel * channels];
    if (!isFinite(image, pixel) || *std::min_element(values, values + channels) >= 0.0F) continue;
    std::replace_if(
        values, values + channels, [](float value) { return value < 0.0F; }, 0.0F);
    ++count;
  }
  return count;
}

}  // namespace

RepairCounts repairNonFinite(Image& image) { return {HoleFiller(image).fill(), 0}; }

// Negative values go first: no hole is filled with them.
RepairCounts repairRadiance(Image& image) {
  const size_t negativePixels = clampNegative(image);
  return {repairNonFinite(image).nonFinitePixels, negativePixels};
}

}  // namespace xrds
