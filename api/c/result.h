#pragma once

#include <exception>
#include <new>
#include <stdexcept>
#include <string>

#include "frames/too_little_memory.h"
#include "xrds/error.h"
#include "xrds/xrds.h"

namespace xrds::c {

/// What xrdsGetMessage() says in this thread.
std::string& message();

/// Notes the message and gives the result back.
XrdsResult failed(XrdsResult result, const char* text) noexcept;

/// Calls `action`, which returns an XrdsResult, and turns what it throws into one: nothing gets through to C.
template <class Action>
XrdsResult guarded(const Action& action) noexcept {
  try {
    return action();
  } catch (const Cancelled& error) {
    return failed(XRDS_CANCELLED, error.what());
  } catch (const InvalidArgument& error) {
    return failed(XRDS_ERROR_ARGUMENT, error.what());
  } catch (const OutOfMemory& error) {
    return failed(XRDS_ERROR_OUT_OF_MEMORY, error.what());
  } catch (const TooLittleMemory& error) {
    return failed(XRDS_ERROR_OUT_OF_MEMORY, error.what());
  } catch (const DeviceLost& error) {
    return failed(XRDS_ERROR_DEVICE_LOST, error.what());
  } catch (const Error& error) {
    return failed(XRDS_ERROR_FAILED, error.what());
  } catch (const std::bad_alloc&) {
    return failed(XRDS_ERROR_OUT_OF_MEMORY, "The host has no memory left for what was asked for.");
  } catch (const std::exception& error) {
    return failed(XRDS_ERROR_INTERNAL, error.what());
  } catch (...) {
    return failed(XRDS_ERROR_INTERNAL, "An unknown error of the library.");
  }
}

/// Throws InvalidArgument that names the pointer if it is null.
template <class T>
T& required(T* pointer, const char* name) {
  if (!pointer) throw InvalidArgument(std::string("The argument '") + name + "' is a null pointer.");
  return *pointer;
}

}  // namespace xrds::c
