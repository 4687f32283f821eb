#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "viewer/display/picture_parameters.h"

namespace xrds {

/// What one side of the divider shows.
enum class View : uint8_t {
  output,
  input,
  bicubic,
  demodulated,
  guided,
  reference,
  error,
  albedo,
  normal,
  skip,
  flicker,
  denoised
};
inline constexpr std::array<const char*, 12> kViewNames{"xrds",   "input",     "bicubic", "demodulated",
                                                        "guided", "reference", "error",   "albedo",
                                                        "normal", "skip map",  "flicker", "denoised"};
inline const char* nameOf(View view) { return kViewNames[static_cast<size_t>(view)]; }

/// Where a picture lies on an area of the display. Lengths are display pixels from the top left corner of the area.
struct Viewport {
  double areaWidth = 1, areaHeight = 1;
  double pictureWidth = 1, pictureHeight = 1;
  double zoom = 1;  // display pixels in a pixel of the picture
  double left = 0, top = 0;
  bool fitted = true;  // stays so when a size changes

  /// The whole picture in the middle of the area; enlarged by whole factors only, so that every pixel is as wide.
  void fit() {
    const double ratio = std::min(areaWidth / pictureWidth, areaHeight / pictureHeight);
    zoom = ratio > 1 ? std::floor(ratio) : ratio;
    fitted = true;
    centre();
  }
  void centre() {
    left = std::round((areaWidth - zoom * pictureWidth) / 2);
    top = std::round((areaHeight - zoom * pictureHeight) / 2);
  }
  /// Changes the zoom; what lies under (x, y) stays there.
  void zoomAbout(double x, double y, double newZoom) {
    newZoom = std::clamp(newZoom, 1.0 / 16, 128.0);
    left = std::round(x - (x - left) * newZoom / zoom);
    top = std::round(y - (y - top) * newZoom / zoom);
    zoom = newZoom;
    fitted = false;
    keepInSight();
  }
  /// The next step of zoom in a direction: half-octaves that meet every power of two, whole numbers above 1.
  double zoomStep(int direction) const {
    double best = zoom;
    for (int step = -8; step <= 14; ++step) {
      double candidate = std::exp2(step / 2.0);
      if (candidate > 1) candidate = std::round(candidate);
      if (direction > 0 && candidate > zoom * 1.001) return candidate;
      if (direction < 0 && candidate < zoom * 0.999) best = candidate;
    }
    return best;
  }
  void pan(double x, double y) {
    left += x;
    top += y;
    fitted = false;
    keepInSight();
  }
  /// Takes a new size of area or picture.
  void resize(double width, double height, double pictureW, double pictureH) {
    if (width == areaWidth && height == areaHeight && pictureW == pictureWidth && pictureH == pictureHeight) return;
    const double middleX = (areaWidth / 2 - left) / zoom / pictureWidth;
    const double middleY = (areaHeight / 2 - top) / zoom / pictureHeight;
    areaWidth = width, areaHeight = height, pictureWidth = pictureW, pictureHeight = pictureH;
    if (fitted) return fit();
    left = std::round(width / 2 - middleX * zoom * pictureWidth);
    top = std::round(height / 2 - middleY * zoom * pictureHeight);
    keepInSight();
  }
  double pictureX(double x) const { return std::floor((x - left) / zoom); }
  double pictureY(double y) const { return std::floor((y - top) / zoom); }
  bool contains(double x, double y) const {
    return pictureX(x) >= 0 && pictureY(y) >= 0 && pictureX(x) < pictureWidth && pictureY(y) < pictureHeight;
  }

 private:
  // A picture that has left the area cannot be found again.
  void keepInSight() {
    constexpr double kRim = 32;
    left = std::clamp(left, kRim - zoom * pictureWidth, areaWidth - kRim);
    top = std::clamp(top, kRim - zoom * pictureHeight, areaHeight - kRim);
  }
};

/// How a frame is looked at: all that the drawing depends on besides the frame.
struct ViewState {
  View left = View::input, right = View::output;
  bool wiping = true;  // else the right view alone
  double wipe = 0.5;   // where the divider is, as a share of the picture's width
  float stops = 0;     // of exposure
  uint32_t curve = shader::kCurveSrgb;
  Viewport viewport;
  uint32_t windowSide = 0;  // of the skip map, in pixels of the picture
  bool panel = true, help = false;
  bool unfolded = false;  // the panel, over the picture of a small display

  float exposure() const { return std::exp2(stops); }
  /// Of the divider, on the display.
  double divider() const { return viewport.left + wipe * viewport.zoom * viewport.pictureWidth; }
};

}  // namespace xrds
