#include "app/denoiser.h"

#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#ifdef _WIN32
#include <windows.h>
#else
#include <dlfcn.h>
#endif

#include "app/cut_library.h"
#include "xrds/error.h"
#include "xrds/path_text.h"

namespace xrds {
namespace {

#ifdef _WIN32
constexpr const char* kLibrary = "OpenImageDenoise.dll";
void* openLibrary(const char* path) { return LoadLibraryW(pathOf(path).c_str()); }
void* findSymbol(void* library, const char* name) {
  return reinterpret_cast<void*>(GetProcAddress(static_cast<HMODULE>(library), name));
}
void closeLibrary(void* library) { FreeLibrary(static_cast<HMODULE>(library)); }
std::string whyNotLoaded() { return "error " + std::to_string(GetLastError()); }
#else
#ifdef __APPLE__
constexpr const char* kLibrary = "libOpenImageDenoise.2.dylib";
#else
constexpr const char* kLibrary = "libOpenImageDenoise.so.2";
#endif
void* openLibrary(const char* path) { return dlopen(path, RTLD_NOW | RTLD_LOCAL); }
void* findSymbol(void* library, const char* name) { return dlsym(library, name); }
void closeLibrary(void* library) { dlclose(library); }
std::string whyNotLoaded() {
  const char* why = dlerror();
  return why ? why : "an error without a message";
}
#endif

constexpr const char* kVariable = "XRDS_OIDN";

// Values of enumerations of its C interface, which version 2 keeps.
constexpr int kAnyDevice = 0, kFloat3 = 3, kHighQuality = 6;

void* openWhole(const char* path) {
  if (const std::filesystem::path cut = cutLibrary(pathOf(path)); !cut.empty())
    throw Error("'" + cut.string() + "' is damaged, it ends too early: install Open Image Denoise again.");
  return openLibrary(path);
}

Error notThere(const std::string& what) {
  return Error(what +
               ": install Open Image Denoise 2 (a package of the system, openimagedenoise.org, or the one that " +
               "comes with pip install pyoidn) and set " + kVariable + " to the file if the system does not find it.");
}

// Of a file that is there the system knows more, such as a library that it needs.
Error notLoaded(const char* path) {
  const std::string why = whyNotLoaded(), what = std::string("'") + path + "' cannot be loaded";
  std::error_code ignored;
  return notThere(std::filesystem::exists(pathOf(path), ignored) ? what + " (" + why + ")" : what);
}

}  // namespace

/// Its functions, as its manual names them.
struct Denoiser::Library {
  using Handle = void*;

  explicit Library(const char* path) : file(openWhole(path)) {
    if (!file) throw notLoaded(path);
    const auto find = [&](auto& function, const char* name) {
      void* found = findSymbol(file, name);
      if (!found) throw notThere(std::string("'") + path + "' is not Open Image Denoise 2, it has no " + name);
      function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(found);
    };
    try {
      find(newDevice, "oidnNewDevice");
      find(commitDevice, "oidnCommitDevice");
      find(releaseDevice, "oidnReleaseDevice");
      find(getDeviceInt, "oidnGetDeviceInt");
      find(getDeviceError, "oidnGetDeviceError");
      find(newBuffer, "oidnNewBuffer");
      find(writeBuffer, "oidnWriteBuffer");
      find(readBuffer, "oidnReadBuffer");
      find(releaseBuffer, "oidnReleaseBuffer");
      find(newFilter, "oidnNewFilter");
      find(setFilterImage, "oidnSetFilterImage");
      find(setFilterBool, "oidnSetFilterBool");
      find(setFilterInt, "oidnSetFilterInt");
      find(commitFilter, "oidnCommitFilter");
      find(executeFilter, "oidnExecuteFilter");
      find(releaseFilter, "oidnReleaseFilter");
    } catch (...) {
      closeLibrary(file);
      throw;
    }
  }
  // Neither is the library closed, as its threads may still run, nor is anything of it used later.
  ~Library() {
    if (device) releaseDevice(device);
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  void check() const {
    const char* message = nullptr;
    if (getDeviceError(device, &message) != 0)
      throw Error(std::string("Open Image Denoise: ") + (message ? message : "an error without a message") + ".");
  }

  void* file;
  Handle device = nullptr;
  Handle (*newDevice)(int type);
  void (*commitDevice)(Handle device);
  void (*releaseDevice)(Handle device);
  int (*getDeviceInt)(Handle device, const char* name);
  int (*getDeviceError)(Handle device, const char** message);
  Handle (*newBuffer)(Handle device, size_t bytes);
  void (*writeBuffer)(Handle buffer, size_t offset, size_t bytes, const void* from);
  void (*readBuffer)(Handle buffer, size_t offset, size_t bytes, void* to);
  void (*releaseBuffer)(Handle buffer);
  Handle (*newFilter)(Handle device, const char* type);
  void (*setFilterImage)(Handle filter, const char* name, Handle buffer, int format, size_t width, size_t height,
                         size_t byteOffset, size_t pixelBytes, size_t rowBytes);
  void (*setFilterBool)(Handle filter, const char* name, bool value);
  void (*setFilterInt)(Handle filter, const char* name, int value);
  void (*commitFilter)(Handle filter);
  void (*executeFilter)(Handle filter);
  void (*releaseFilter)(Handle filter);

  using Inputs = std::vector<std::pair<const char*, const Image*>>;

  /// What the filter makes of images of one size; a radiance is one of high dynamic range.
  Image filtered(const Inputs& inputs, bool radiance) const {
    const Image& first = *inputs.front().second;
    Image result(first.width, first.height, 3);
    const size_t bytes = result.pixels.size() * sizeof(float);
    std::vector<Handle> buffers;
    const Handle filter = newFilter(device, "RT");
    const auto give = [&](const char* name, const float* pixels) {
      buffers.push_back(newBuffer(device, bytes));
      if (pixels) writeBuffer(buffers.back(), 0, bytes, pixels);
      setFilterImage(filter, name, buffers.back(), kFloat3, static_cast<size_t>(first.width),
                     static_cast<size_t>(first.height), 0, 0, 0);
    };
    for (const auto& [name, image] : inputs) give(name, image->pixels.data());
    give("output", nullptr);
    if (radiance) setFilterBool(filter, "hdr", true);
    if (inputs.size() > 1) setFilterBool(filter, "cleanAux", true);
    setFilterInt(filter, "quality", kHighQuality);
    commitFilter(filter);
    executeFilter(filter);
    readBuffer(buffers.back(), 0, bytes, result.pixels.data());
    for (const Handle buffer : buffers) releaseBuffer(buffer);
    releaseFilter(filter);
    check();
    return result;
  }
};

Denoiser::Denoiser() {
  const char* named = std::getenv(kVariable);
  library_ = std::make_unique<Library>(named && *named ? named : kLibrary);
  library_->device = library_->newDevice(kAnyDevice);
  if (!library_->device) throw Error("Open Image Denoise opens no device.");
  library_->commitDevice(library_->device);
  library_->check();
  const auto version = [&](const char* part) { return std::to_string(library_->getDeviceInt(library_->device, part)); };
  name_ =
      "Open Image Denoise " + version("versionMajor") + "." + version("versionMinor") + "." + version("versionPatch");
}

Denoiser::~Denoiser() = default;

Image Denoiser::colourWithoutNoise(const Image& colour, const Image* albedo, const Image* normal) {
  Library::Inputs inputs{{"color", &colour}};
  if (albedo) inputs.emplace_back("albedo", albedo);
  if (normal) inputs.emplace_back("normal", normal);
  return library_->filtered(inputs, true);
}

Image Denoiser::albedoWithoutNoise(const Image& albedo) { return library_->filtered({{"albedo", &albedo}}, false); }

Image Denoiser::normalWithoutNoise(const Image& normal) { return library_->filtered({{"normal", &normal}}, false); }

}  // namespace xrds
