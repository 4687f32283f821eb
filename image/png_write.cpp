#include "image/png_write.h"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "image/pending_file.h"
#include "image/srgb.h"
#include "xrds/error.h"

namespace xrds {
namespace {

png_uint_32 formatFor(const std::filesystem::path& path, const Image& image) {
  switch (image.pixels.empty() ? 0 : image.channels) {
    case 1:
      return PNG_FORMAT_GRAY;
    case 3:
      return PNG_FORMAT_RGB;
    case 4:
      return PNG_FORMAT_RGBA;
    default:
      throw Error("Cannot write '" + path.string() + "': expected pixels of 1, 3 or 4 channels, found " +
                  std::to_string(image.width) + " x " + std::to_string(image.height) + " pixels of " +
                  std::to_string(image.channels) + ".");
  }
}

uint8_t step(double display) { return static_cast<uint8_t>(std::lround(display * 255.0)); }

std::vector<uint8_t> displayBytes(const Image& image, float exposure) {
  std::vector<uint8_t> bytes(image.pixels.size());
  for (size_t i = 0; i < bytes.size(); ++i) {
    const bool isAlpha = image.channels == 4 && i % 4 == 3;
    const double value = std::isnan(image.pixels[i]) ? 0.0 : double{image.pixels[i]} * (isAlpha ? 1.0 : exposure);
    const double clamped = std::clamp(value, 0.0, 1.0);
    bytes[i] = step(isAlpha ? clamped : srgbFromLinear(clamped));
  }
  return bytes;
}

// The whole file in memory: libpng's own file writing does not report a disk that fills up on closing.
std::vector<char> encode(const std::filesystem::path& path, const Image& image, float exposure) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = formatFor(path, image);
  const std::vector<uint8_t> bytes = displayBytes(image, exposure);
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::vector<char> file(size);
  if (png_image_write_to_memory(&png, file.data(), &size, 0, bytes.data(), 0, nullptr) == 0) {
    const std::string reason = png.message;
    png_image_free(&png);
    throw Error("Cannot write '" + path.string() + "': libpng refuses the image (" + reason + "); make it smaller.");
  }
  file.resize(size);
  return file;
}

}  // namespace

void writePng(const std::filesystem::path& path, const Image& image, float exposure) {
  const std::vector<char> bytes = encode(path, image, exposure);
  PendingFile pending(path);
  std::ofstream file(pending.temporaryPath(), std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) {
    throw Error(
        "Cannot write '" + path.string() +
        "': the file cannot be created or the disk is full; check the folder's permissions and the free space.");
  }
  pending.commit();
}

}  // namespace xrds
