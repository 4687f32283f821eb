// A library with the C interface of Open Image Denoise 2, as far as the engine calls it, that takes no noise out: it
// halves radiance and albedo and leaves the normal. It refuses what the real one refuses, and wants auxiliary images to
// be clean.
#include <cstddef>
#include <cstring>
#include <map>
#include <string>
#include <vector>

namespace {

const char* message = nullptr;
int alive = 0;  // buffers and filters

struct Buffer {
  std::vector<char> bytes;
};

struct Filter {
  std::map<std::string, Buffer*> images;
  std::map<std::string, bool> flags;
  size_t width = 0, height = 0;
  bool committed = false;
};

void require(bool condition, const char* text) {
  if (!condition) message = text;
}

float* pixels(Buffer* buffer) { return reinterpret_cast<float*>(buffer->bytes.data()); }

}  // namespace

#define API extern "C" __attribute__((visibility("default")))

API void* oidnNewDevice(int) { return &alive; }
API void oidnCommitDevice(void*) {}
API void oidnReleaseDevice(void*) {}
API int oidnGetDeviceInt(void*, const char* name) { return std::strcmp(name, "versionMajor") == 0 ? 2 : 7; }
API int oidnGetDeviceError(void*, const char** text) {
  require(alive == 0, "a buffer or a filter was not released");
  *text = message;
  message = nullptr;
  return *text ? 1 : 0;
}
API void* oidnNewBuffer(void*, size_t bytes) {
  ++alive;
  return new Buffer{std::vector<char>(bytes)};
}
API void oidnWriteBuffer(void* buffer, size_t offset, size_t bytes, const void* from) {
  std::memcpy(static_cast<Buffer*>(buffer)->bytes.data() + offset, from, bytes);
}
API void oidnReadBuffer(void* buffer, size_t offset, size_t bytes, void* to) {
  std::memcpy(to, static_cast<Buffer*>(buffer)->bytes.data() + offset, bytes);
}
API void oidnReleaseBuffer(void* buffer) {
  --alive;
  delete static_cast<Buffer*>(buffer);
}
API void* oidnNewFilter(void*, const char* type) {
  require(std::strcmp(type, "RT") == 0, "no such filter");
  ++alive;
  return new Filter;
}
API void oidnSetFilterImage(void* filter, const char* name, void* buffer, int format, size_t width, size_t height,
                            size_t, size_t, size_t) {
  auto& own = *static_cast<Filter*>(filter);
  require(format == 3, "not three floats");
  require(own.images.empty() || (own.width == width && own.height == height), "images of several sizes");
  require(static_cast<Buffer*>(buffer)->bytes.size() == 12 * width * height, "a buffer of another size");
  own.images[name] = static_cast<Buffer*>(buffer);
  own.width = width;
  own.height = height;
}
API void oidnSetFilterBool(void* filter, const char* name, bool value) {
  static_cast<Filter*>(filter)->flags[name] = value;
}
API void oidnSetFilterInt(void*, const char*, int) {}
API void oidnCommitFilter(void* filter) { static_cast<Filter*>(filter)->committed = true; }
API void oidnExecuteFilter(void* filter) {
  auto& own = *static_cast<Filter*>(filter);
  const bool radiance = own.images.count("color") != 0;
  require(own.committed, "not committed");
  require(own.flags["hdr"] == radiance, "radiance alone has a high dynamic range");
  require(own.flags["cleanAux"] == (own.images.size() > 2), "auxiliary images that are not clean");
  const char* source = radiance ? "color" : own.images.count("albedo") != 0 ? "albedo" : "normal";
  for (size_t i = 0; i < 3 * own.width * own.height; ++i)
    pixels(own.images["output"])[i] = (source == std::string("normal") ? 1.F : 0.5F) * pixels(own.images[source])[i];
}
API void oidnReleaseFilter(void* filter) {
  --alive;
  delete static_cast<Filter*>(filter);
}
