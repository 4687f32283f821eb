#pragma once

#include <exception>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "xrds/error.h"
#include "xrds/path_text.h"
#include "xrds/xrds.h"

/// How the classes call the C API, which is all that the library exports.
namespace xrds::call {

/// Throws what a result stands for.
inline void check(XrdsResult result) {
  switch (result) {
    case XRDS_OK:
      return;
    case XRDS_CANCELLED:
      throw Cancelled(xrdsGetMessage());
    case XRDS_ERROR_ARGUMENT:
      throw InvalidArgument(xrdsGetMessage());
    case XRDS_ERROR_OUT_OF_MEMORY:
      throw OutOfMemory(xrdsGetMessage());
    case XRDS_ERROR_DEVICE_LOST:
      throw DeviceLost(xrdsGetMessage());
    case XRDS_ERROR_INTERNAL:
      throw std::logic_error(xrdsGetMessage());
    case XRDS_ERROR_FAILED:
    case XRDS_ERROR_BUSY:
      break;
  }
  throw Error(xrdsGetMessage());
}

/// A function of the caller's that C calls with `user` pointing here. What it throws ends the call and comes out of
/// finish(). `Function` returns bool, whether to go on, or nothing.
template <class Function>
class Heard {
 public:
  explicit Heard(const Function& function) : function_(function) {}
  void* user() { return this; }

  template <class... Arguments>
  static int hear(void* user, Arguments... arguments) noexcept {
    return static_cast<Heard*>(user)->tell(arguments...);
  }
  template <class... Arguments>
  static void listen(void* user, Arguments... arguments) noexcept {
    static_cast<Heard*>(user)->tell(arguments...);
  }
  /// Throws what the function threw, else what the result stands for.
  void finish(XrdsResult result) {
    if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
    check(result);
  }

 private:
  template <class... Arguments>
  int tell(Arguments... arguments) noexcept {
    if (thrown_) return 0;
    try {
      if constexpr (std::is_void_v<decltype(function_(arguments...))>) {
        function_(arguments...);
        return 1;
      } else {
        return function_(arguments...) ? 1 : 0;
      }
    } catch (...) {
      thrown_ = std::current_exception();
      return 0;
    }
  }
  const Function& function_;
  std::exception_ptr thrown_{};
};

/// Gives a handle back to the library.
struct Close {
  void operator()(XrdsDevice* device) const { xrdsCloseDevice(device); }
  void operator()(XrdsModel* model) const { xrdsCloseModel(model); }
  void operator()(XrdsUpscaler* upscaler) const { xrdsDestroyUpscaler(upscaler); }
  void operator()(XrdsTemporalFilter* filter) const { xrdsDestroyTemporalFilter(filter); }
};
template <class Handle>
using Owned = std::unique_ptr<Handle, Close>;

/// A path as the C API has it; pathOf() is the inverse.
inline std::string text(const std::filesystem::path& path) {
  const std::u8string text = path.u8string();
  return {text.begin(), text.end()};
}

/// An empty structure of this version.
template <class Structure>
Structure sized() {
  Structure structure{};
  structure.structSize = sizeof structure;
  return structure;
}

}  // namespace xrds::call
