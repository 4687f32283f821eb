// frames write FOLDER: a small frame as portable float maps, lit from below; frames check FOLDER: whether result.pfm is
// that frame, four times as large and as bright, rows in their order; frames lit FILE WIDTH HEIGHT: whether the file
// has that size, and every pixel is finite, some are bright and no two neighbouring rows the same.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

constexpr int kWidth = 12, kHeight = 8, kScale = 4;

static float lightAt(float row) { return 0.2F + 0.1F * row; }  // rows from the bottom

static void write(const std::string& path, int scale, float (*value)(float row, int channel)) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  std::fprintf(file, "PF\n%d %d\n-1.0\n", scale * kWidth, scale * kHeight);
  for (int y = 0; y < scale * kHeight; ++y)
    for (int i = 0; i < 3 * scale * kWidth; ++i) {
      const float number = value(static_cast<float>(y) / static_cast<float>(scale), i % 3);
      std::fwrite(&number, sizeof number, 1, file);
    }
  std::fclose(file);
}

static int checkLit(const char* path, int wide, int high) {
  std::FILE* file = std::fopen(path, "rb");
  int width = 0, height = 0;
  if (!file || std::fscanf(file, "PF %d %d -%*f%*1[\n]", &width, &height) != 2) return 1;
  if (width != wide || height != high) return 2;
  std::vector<float> pixels(size_t{3} * width * height);
  if (std::fread(pixels.data(), sizeof(float), pixels.size(), file) != pixels.size()) return 3;
  float sum = 0;
  for (const float value : pixels) {
    if (!std::isfinite(value) || value < 0) return 4;
    sum += value;
  }
  for (int y = 1; y < height; ++y)
    if (std::memcmp(&pixels[size_t{3} * width * y], &pixels[size_t{3} * width * (y - 1)], 12 * size_t(width)) == 0)
      return 5;
  return sum > 0.1F * static_cast<float>(pixels.size()) ? 0 : 6;
}

int main(int count, char** arguments) {
  if (count == 5) return checkLit(arguments[2], std::stoi(arguments[3]), std::stoi(arguments[4]));
  const std::string folder = std::string(arguments[2]) + "/";
  if (std::strcmp(arguments[1], "write") == 0) {
    write(folder + "colour.pfm", 1, [](float row, int) { return lightAt(row); });
    write(folder + "albedo.pfm", kScale, [](float, int) { return 0.5F; });
    write(folder + "normal.pfm", kScale, [](float, int c) { return c == 2 ? 1.F : 0.F; });
    return 0;
  }
  std::FILE* file = std::fopen((folder + "result.pfm").c_str(), "rb");
  int width = 0, height = 0;
  if (!file || std::fscanf(file, "PF %d %d -%*f%*1[\n]", &width, &height) != 2) return 1;
  if (width != kScale * kWidth || height != kScale * kHeight) return 2;
  std::vector<float> pixels(size_t{3} * width * height + 1);
  if (std::fread(pixels.data(), sizeof(float), pixels.size(), file) != pixels.size() - 1) return 3;
  for (int y = 0; y < height; ++y)
    for (int i = 0; i < 3 * width; ++i) {
      const float expected = lightAt((static_cast<float>(y) + 0.5F) / kScale - 0.5F);
      if (std::abs(pixels[size_t{3} * width * y + i] - expected) > 0.15F) return 4;
    }
  return 0;
}
