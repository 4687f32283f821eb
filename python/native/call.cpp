#include "python/native/call.h"

#include <chrono>
#include <string_view>
#include <utility>
#include <vector>

namespace xrds::python {
namespace {

constexpr double kSecondsBetweenLooks = 0.05;

thread_local Call* current = nullptr;
thread_local std::vector<std::pair<void (*)(void*), void*>> leftToClose;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

[[noreturn]] void raise(const char* exception, const char* sentence) {
  const nb::object type = nb::module_::import_("xrds._errors").attr(exception);
  PyErr_SetString(type.ptr(), sentence);
  throw nb::python_error();
}

const char* exceptionOf(XrdsResult result) {
  switch (result) {
    case XRDS_CANCELLED:
      return "Cancelled";
    case XRDS_ERROR_ARGUMENT:
      return "ArgumentError";
    case XRDS_ERROR_OUT_OF_MEMORY:
      return "OutOfMemory";
    case XRDS_ERROR_DEVICE_LOST:
      return "DeviceLost";
    default:
      return "Error";
  }
}

void closeWithoutLock(void (*closeHandle)(void*), void* handle) {
  const nb::gil_scoped_release released;
  closeHandle(handle);
}

}  // namespace

void refuse(const std::string& sentence) { raise("ArgumentError", sentence.c_str()); }

void require(XrdsResult result, const char* sentence) {
  if (result != XRDS_OK) raise(exceptionOf(result), sentence);
}

Call::Call(nb::handle progress) : progress_(progress) {
  if (current)
    raise("Error", "A function that hears the progress of a call cannot make another: it would wait for itself.");
  current = this;
}

Call::~Call() {
  current = nullptr;
  for (const auto& [closeHandle, handle] : std::exchange(leftToClose, {})) closeWithoutLock(closeHandle, handle);
}

int Call::hearFrame(void* call, double share) { return static_cast<Call*>(call)->goesOn("upscaling", share); }

int Call::hearPreparation(void*, int machineCode, size_t done, size_t total) {
  constexpr const char* kStages[] = {"loading", "compiling", "tuning"};
  const size_t stage = machineCode < 0 || machineCode > 2 ? 1 : static_cast<size_t>(machineCode);
  return !current ||
         current->goesOn(kStages[stage], total ? static_cast<double>(done) / static_cast<double>(total) : 0);
}

void Call::close(void (*closeHandle)(void*), void* handle) {
  if (current)
    leftToClose.emplace_back(closeHandle, handle);
  else
    closeWithoutLock(closeHandle, handle);
}

// In C's frames: nothing may be thrown through them.
bool Call::goesOn(const char* stage, double share) {
  if (raised_) return false;
  if (progress_.is_none() && now() < nextLook_) return true;
  const nb::gil_scoped_acquire lock;
  nextLook_ = now() + kSecondsBetweenLooks;
  try {
    return tell(stage, share);
  } catch (...) {
    raised_ = std::current_exception();
    return false;
  }
}

bool Call::tell(const char* stage, double share) {
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
  if (progress_.is_none()) return true;
  const nb::object answer = progress_(stage, share);
  const bool isBool =
      nb::isinstance<nb::bool_>(answer) || std::string_view(Py_TYPE(answer.ptr())->tp_name).starts_with("numpy.bool");
  return !isBool || PyObject_IsTrue(answer.ptr()) != 0;
}

}  // namespace xrds::python
