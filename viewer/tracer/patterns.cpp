#include "viewer/tracer/patterns.h"

namespace xrds {
namespace {

int wrapped(int i, int period) { return (i % period + period) % period; }
float smooth(float t) { return t * t * (3 - 2 * t); }

float cellNoise(float x, float y, int period) {
  const auto ix = static_cast<int>(std::floor(x)), iy = static_cast<int>(std::floor(y));
  const float fx = smooth(x - std::floor(x)), fy = smooth(y - std::floor(y));
  const auto at = [&](int dx, int dy) { return scramble(wrapped(ix + dx, period), wrapped(iy + dy, period) + period); };
  const float top = at(0, 0) + (at(1, 0) - at(0, 0)) * fx, bottom = at(0, 1) + (at(1, 1) - at(0, 1)) * fx;
  return top + (bottom - top) * fy;
}

}  // namespace

float scramble(int x, int y) {
  auto h = static_cast<uint32_t>(x) * 0x8DA6B343U ^ static_cast<uint32_t>(y) * 0xD8163841U;
  h = (h ^ h >> 15) * 0x2C1B3C6DU;
  h = (h ^ h >> 12) * 0x297A2D39U;
  return static_cast<float>((h ^ h >> 15) >> 8) * 0x1p-24F;
}

float noise(float u, float v, int period, int octaves) {
  float sum = 0, weight = 0.5F, weights = 0;
  for (int i = 0; i < octaves; ++i, period *= 2, weight *= 0.5F) {
    sum += weight * cellNoise(u * static_cast<float>(period), v * static_cast<float>(period), period);
    weights += weight;
  }
  return sum / weights;
}

Texture paint(uint32_t size, const std::function<Vec3(float, float)>& colourAt) {
  Texture texture{size, size};
  for (uint32_t y = 0; y < size; ++y)
    for (uint32_t x = 0; x < size; ++x)
      texture.pixels.push_back(colourAt((static_cast<float>(x) + 0.5F) / static_cast<float>(size),
                                        (static_cast<float>(y) + 0.5F) / static_cast<float>(size)));
  return texture;
}

Texture checker(uint32_t cells, Vec3 first, Vec3 second) {
  const auto count = static_cast<float>(cells);
  return paint(64 * cells, [=](float u, float v) {
    const bool isFirst = (static_cast<int>(u * count) + static_cast<int>(v * count)) % 2 == 0;
    const float wear = 0.85F + 0.15F * noise(u, v, 4 * static_cast<int>(cells));
    return wear * (isFirst ? first : second);
  });
}

Texture planks(uint32_t count, Vec3 dark, Vec3 light) {
  return paint(512, [=](float u, float v) {
    const float across = u * static_cast<float>(count);
    const auto plank = static_cast<int>(across);
    const float along = v + scramble(plank, 7), inPlank = across - static_cast<float>(plank);
    const auto board = static_cast<int>(std::floor(along));
    const float edge = std::min({inPlank, 1 - inPlank, 8 * std::abs(along - std::round(along))});
    const float tone = 0.5F * scramble(plank, wrapped(board, 2) + 20);
    const float grain = 0.5F * noise(u + 0.1F * noise(u, v, 4, 2), 0.06F * v, 64, 3);
    return (edge < 0.02F ? 0.35F : 1.0F) * mix(dark, light, tone + grain);
  });
}

Texture bricks(uint32_t rows, Vec3 brick, Vec3 joint) {
  return paint(512, [=](float u, float v) {
    const float y = v * static_cast<float>(rows);
    const auto row = static_cast<int>(y);
    const float x = u * 0.5F * static_cast<float>(rows) + 0.5F * static_cast<float>(row % 2);
    const auto column = wrapped(static_cast<int>(x), static_cast<int>(rows / 2));
    const float fx = x - std::floor(x), fy = y - std::floor(y);
    const bool isJoint = std::min(fx, 1 - fx) < 0.025F || std::min(fy, 1 - fy) < 0.06F;
    const float tone = 0.65F + 0.35F * scramble(column, row) + 0.4F * (noise(u, v, 32) - 0.5F);
    return isJoint ? joint * (0.8F + 0.4F * noise(u, v, 64, 2)) : brick * tone;
  });
}

Texture print(uint32_t lines, Vec3 paper, Vec3 ink) {
  return paint(512, [=](float u, float v) {
    const float y = v * static_cast<float>(lines), x = u * static_cast<float>(lines) * 1.6F;
    const auto line = static_cast<int>(y), letter = static_cast<int>(x);
    const float fx = x - static_cast<float>(letter), fy = y - static_cast<float>(line);
    const bool isMargin = std::min({u, 1 - u, v, 1 - v}) < 0.07F || scramble(letter / 5, line) < 0.12F;
    const bool isGap = scramble(letter, line + 50) < 0.16F || fy < 0.3F || fx < 0.2F;
    const bool isStroke = scramble(letter * 3 + static_cast<int>(fx * 3), line * 4 + static_cast<int>(fy * 4)) < 0.62F;
    return !isMargin && !isGap && isStroke ? ink : paper;
  });
}

Texture mottled(int period, Vec3 first, Vec3 second) {
  return paint(512, [=](float u, float v) { return mix(first, second, noise(u, v, period, 5)); });
}

}  // namespace xrds
