// Winograd's F(4, 3): four results side by side of six inputs and three weights by six products, at points 0, 3/2,
// -3/2, 2/3, -2/3 and infinity. In two directions, F(4 x 4, 3 x 3): 16 results of 36 inputs and 9 weights by 36
// products.
#ifndef XRDS_SHADERS_COMMON_WINOGRAD_H
#define XRDS_SHADERS_COMMON_WINOGRAD_H
#include "shaders/common/shared.h"

XRDS_SHARED_BEGIN
const float kWinogradPoint = 1.5;    // beside its inverse, the negatives of both, zero and infinity
const uint kWinogradSide = 4;        // of a square of results
const uint kWinogradElements = 6;    // of its inputs, and of the products
const uint kWinogradPlanes = 36;     // products of a square
const uint kMostRowItems = 1 << 17;  // squares of a row times quads of channels, which one row of workgroups makes
XRDS_SHARED_END

#ifdef __cplusplus
#include <array>
namespace xrds {

/// The element that stands in place of three weights.
inline double winogradWeight(const std::array<double, 3>& w, uint32_t element) {
  if (element == 0) return w[0];
  if (element == shader::kWinogradElements - 1) return w[2];
  const double point = element <= 2 ? shader::kWinogradPoint : 1 / shader::kWinogradPoint, square = point * point;
  return (w[0] + (element % 2 ? point : -point) * w[1] + square * w[2]) / (2 * (square * square - 1));
}

/// The elements that stand in place of six inputs.
inline std::array<double, 6> winogradInput(const std::array<double, 6>& d) {
  const double a = shader::kWinogradPoint, b = 1 / shader::kWinogradPoint, sum = a * a + b * b;
  const double evenA = d[4] - b * b * d[2], oddA = a * (d[3] - b * b * d[1]);
  const double evenB = d[4] - a * a * d[2], oddB = b * (d[3] - a * a * d[1]);
  return {d[0] - sum * d[2] + d[4], evenA + oddA, evenA - oddA, evenB + oddB, evenB - oddB, d[1] - sum * d[3] + d[5]};
}

/// The four results of six products.
inline std::array<double, 4> winogradResults(const std::array<double, 6>& m) {
  const double a = shader::kWinogradPoint, b = 1 / shader::kWinogradPoint;
  const double evenA = m[1] + m[2], oddA = m[1] - m[2], evenB = m[3] + m[4], oddB = m[3] - m[4];
  return {m[0] + evenA + evenB, a * oddA + b * oddB, a * a * evenA + b * b * evenB,
          a * a * a * oddA + b * b * b * oddB + m[5]};
}

/// `map` in both directions: of rows of kFrom numbers, then of columns.
template <size_t kTo, size_t kFrom, class Map>
std::array<double, kTo * kTo> inBothDirections(const std::array<double, kFrom * kFrom>& square, const Map& map) {
  std::array<std::array<double, kTo>, kFrom> rows;
  for (size_t y = 0; y < kFrom; ++y) {
    std::array<double, kFrom> row;
    for (size_t x = 0; x < kFrom; ++x) row[x] = square[y * kFrom + x];
    rows[y] = map(row);
  }
  std::array<double, kTo * kTo> mapped;
  for (size_t x = 0; x < kTo; ++x) {
    std::array<double, kFrom> column;
    for (size_t y = 0; y < kFrom; ++y) column[y] = rows[y][x];
    const std::array<double, kTo> made = map(column);
    for (size_t y = 0; y < kTo; ++y) mapped[y * kTo + x] = made[y];
  }
  return mapped;
}

/// What stands in place of 3 x 3 weights, and of 6 x 6 inputs; the 4 x 4 results of the products. Row-major.
inline std::array<double, 36> winogradWeights(const std::array<double, 9>& weights) {
  return inBothDirections<6, 3>(weights, [](const std::array<double, 3>& w) {
    std::array<double, 6> elements;
    for (uint32_t e = 0; e < 6; ++e) elements[e] = winogradWeight(w, e);
    return elements;
  });
}
inline std::array<double, 36> winogradInputs(const std::array<double, 36>& inputs) {
  return inBothDirections<6, 6>(inputs, winogradInput);
}
inline std::array<double, 16> winogradSquare(const std::array<double, 36>& products) {
  return inBothDirections<4, 6>(products, winogradResults);
}

}  // namespace xrds
#endif
#endif
