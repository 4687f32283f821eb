#include "image/camera_motion.h"

#include <cmath>
#include <limits>

#include "xrds/error.h"

namespace xrds {
namespace {

using Row = FrameCamera::Row;
using Vector = std::array<double, 3>;

constexpr float kFarthest = 1e8F;

Vector cross(const Row& a, const Row& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// Of the first three numbers.
template <class A, class B>
double dot3(const A& a, const B& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double dot(const Row& a, const Row& b) { return dot3(a, b) + a[3] * b[3]; }

// a - s b
Row less(const Row& a, double s, const Row& b) {
  return {a[0] - s * b[0], a[1] - s * b[1], a[2] - s * b[2], a[3] - s * b[3]};
}

// The point, up to a factor, at which three rows are 0.
Row meeting(const Row& a, const Row& b, const Row& c) {
  const Vector bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
  Row point{};
  for (size_t i = 0; i < 3; ++i) point[i] = -(a[3] * bc[i] + b[3] * ca[i] + c[3] * ab[i]);
  point[3] = dot3(a, bc);
  return point;
}

// Points are rows in OpenEXR, so that a column makes a number of them.
Row column(const std::array<float, 16>& matrix, size_t c) {
  return {matrix[c], matrix[4 + c], matrix[8 + c], matrix[12 + c]};
}

void negate(Row& row) {
  for (double& number : row) number = -number;
}

/// A number of the points that a row of pixels shows: linear in the place u and in the nearness, as the point is.
struct Seen {
  double constant = 0, byU = 0, byNearness = 0, byBoth = 0;
  double operator()(double u, double nearness) const {
    return constant + byU * u + nearness * (byNearness + byBoth * u);
  }
};

/// What the points of the row at v are to their own camera (w) and to another one (x, y, w).
struct SeenRow {
  Seen own, x, y, w;

  SeenRow(const FrameCamera& present, const FrameCamera& other, double v) {
    const Row above = less(present.y, v, present.w), infinite{0, 0, 0, -1}, along = less({}, 1, present.w);
    const Row points[4] = {meeting(present.x, above, infinite), meeting(along, above, infinite),
                           meeting(present.x, above, present.depth), meeting(along, above, present.depth)};
    const auto seenAs = [&](const Row& number) {
      return Seen{dot(points[0], number), dot(points[1], number), dot(points[2], number), dot(points[3], number)};
    };
    own = seenAs(present.w);
    x = seenAs(other.x);
    y = seenAs(other.y);
    w = seenAs(other.w);
  }
};

}  // namespace

std::optional<FrameCamera> cameraOf(const ExrPart& part) {
  const auto ndc = part.attributes.matrix("worldToNDC"), camera = part.attributes.matrix("worldToCamera");
  if (!ndc) return std::nullopt;
  FrameCamera found{column(*ndc, 0), column(*ndc, 1), column(*ndc, 3), {}};
  const double steepness = std::sqrt(dot3(found.w, found.w));  // of w; 0: parallel rays
  if (camera) {
    found.depth = column(*camera, 2);
    if (dot3(found.w, found.depth) < 0 || (steepness == 0 && found.w[3] < 0))
      for (Row* row : {&found.x, &found.y, &found.w}) negate(*row);
    if (dot3(found.x, column(*camera, 0)) <= 0 || dot3(found.y, column(*camera, 1)) >= 0)
      throw Error("The attribute worldToNDC does not have x to the right and y down, as OpenEXR's standard wants it.");
  } else {
    if (steepness == 0)
      throw Error("The camera has parallel rays: besides worldToNDC its motion needs the attribute worldToCamera.");
    for (size_t i = 0; i < 4; ++i) found.depth[i] = found.w[i] / steepness;
  }
  return found;
}

std::vector<float> cameraMotion(const FrameCamera& present, const FrameCamera& other, std::span<const float> depths,
                                const Box& dataWindow, const Box& displayWindow) {
  const auto width = static_cast<size_t>(dataWindow.width());
  const auto wide = static_cast<double>(displayWindow.width()), high = static_cast<double>(displayWindow.height());
  std::vector<float> motion(2 * depths.size(), std::numeric_limits<float>::infinity());
  for (size_t y = 0; y < depths.size() / width; ++y) {
    const double v = (static_cast<double>(y) + 0.5 + dataWindow.minY - displayWindow.minY) / high;
    const SeenRow row(present, other, v);
    for (size_t x = 0, p = y * width; x < width; ++x, ++p) {
      const double u = (static_cast<double>(x) + 0.5 + dataWindow.minX - displayWindow.minX) / wide;
      const double nearness = depths[p] > 0 && depths[p] < kFarthest ? 1.0 / depths[p] : 0;
      // Both in front of their cameras, or both behind: the point is known up to a factor.
      const double w = row.w(u, nearness);
      if (!(w * row.own(u, nearness) > 0)) continue;
      motion[2 * p] = static_cast<float>((row.x(u, nearness) / w - u) * wide);
      motion[2 * p + 1] = static_cast<float>((row.y(u, nearness) / w - v) * high);
    }
  }
  return motion;
}

}  // namespace xrds
