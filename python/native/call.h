#pragma once

#include <nanobind/nanobind.h>

#include <exception>
#include <string>

#include "xrds/xrds.h"

namespace xrds::python {

namespace nb = nanobind;

/// A sentence of our own as an exception of the package: ArgumentError, which is a ValueError too.
[[noreturn]] void refuse(const std::string& sentence);

/// The handle of what is named, "upscaler". Raises ArgumentError if it was closed.
template <class Handle>
Handle* opened(Handle* handle, const char* name) {
  if (!handle) refuse(std::string("The ") + name + " was closed: make another one.");
  return handle;
}

/// Raises the exception of the package that fits, unless the result is XRDS_OK.
void require(XrdsResult result, const char* sentence);

/// A call of the library that may take long. It runs without Python's lock; meanwhile `progress`, unless it is None,
/// hears how far it is, and an interrupt or an exception of `progress` ends it. Within `progress` no other may begin:
/// it would wait for the device for ever.
class Call {
 public:
  /// Raises Error within the progress of another call.
  explicit Call(nb::handle progress = Py_None);
  ~Call();
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  /// Calls `action`, which returns an XrdsResult, and raises what became of it.
  template <class Action>
  void run(const Action& action) {
    XrdsResult result;
    std::string sentence;
    {
      const nb::gil_scoped_release released;
      result = action();
      if (result != XRDS_OK) sentence = xrdsGetMessage();
    }
    if (raised_) std::rethrow_exception(raised_);
    require(result, sentence.c_str());
  }

  /// What the library is told as XrdsProgress of a frame, and as XrdsPreparation of every device.
  static int hearFrame(void* call, double share);
  static int hearPreparation(void*, int machineCode, size_t done, size_t total);

  /// Closes a handle without Python's lock, for which the thread that holds the device may be waiting; within a
  /// progress, where this thread holds it, once the call is over.
  static void close(void (*closeHandle)(void*), void* handle);

 private:
  bool goesOn(const char* stage, double share);
  bool tell(const char* stage, double share);

  nb::handle progress_;
  std::exception_ptr raised_;
  double nextLook_ = 0;  // for an interrupt, seconds
};

}  // namespace xrds::python
