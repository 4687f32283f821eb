#pragma once

#include <cstddef>
#include <cstring>
#include <string>
#include <type_traits>
#include <typeinfo>

#include "api/c/result.h"

namespace xrds::c {

/// "XrdsUpscalerOptions", of which compilers have more in front.
template <class T>
std::string nameOf() {
  const std::string name = typeid(T).name();
  return name.substr(name.find("Xrds"));
}

/// The size that the caller has of a structure. Throws InvalidArgument if there was none of that size: the caller
/// forgot it, or was built with the header of a later version.
template <class T>
size_t checkedSize(const T& structure) {
  const size_t size = structure.structSize;
  if (size <= sizeof(structure.structSize) || size > sizeof(T) || size % alignof(T) != 0)
    throw InvalidArgument(nameOf<T>() + " has a structSize of " + std::to_string(size) + ", expected " +
                          std::to_string(sizeof(T)) +
                          " or, of an older header, less: set it to its sizeof, or take the library of that header.");
  return size;
}

/// What a caller has filled, at the size of this version: fields that its header did not have yet are those of
/// `defaults`. Throws as checkedSize() does.
template <class T>
T taken(const T& given, T defaults = {}) {
  std::memcpy(&defaults, &given, checkedSize(given));
  defaults.structSize = sizeof(T);
  return defaults;
}

/// Fills the fields that the caller has. Throws as checkedSize() does.
template <class T>
void give(const T& found, T& caller) {
  const auto size = static_cast<uint32_t>(checkedSize(caller));
  std::memcpy(&caller, &found, size);
  caller.structSize = size;
}

/// The structure at a place of a list, all of which have the size of the first. Throws
/// InvalidArgument, which calls the list `name`, if one has another, and as checkedSize() does.
template <class T>
T& at(T* list, uint32_t index, const char* name) {
  using Byte = std::conditional_t<std::is_const_v<T>, const std::byte, std::byte>;
  const size_t size = checkedSize(required(list, name));
  T& found = *reinterpret_cast<T*>(reinterpret_cast<Byte*>(list) + index * size);
  if (found.structSize != size)
    throw InvalidArgument("Structure " + std::to_string(index) + " of '" + name + "' has a structSize of " +
                          std::to_string(found.structSize) + ", expected " + std::to_string(size) +
                          ", as of the first: the structures of a list have one size.");
  return found;
}

/// A structure that is part of others, so that its size never changes. Throws InvalidArgument if it has another one.
template <class T>
const T& checkSize(const T& structure) {
  if (structure.structSize != sizeof(T))
    throw InvalidArgument(nameOf<T>() + " has a structSize of " + std::to_string(structure.structSize) + ", expected " +
                          std::to_string(sizeof(T)) + ": set it to its sizeof.");
  return structure;
}

/// The number that a caller in C has put into an enumeration, which need be none of its values.
template <class T>
int numberOf(const T& enumeration) {
  static_assert(sizeof(T) == sizeof(int));
  int number = 0;
  std::memcpy(&number, &enumeration, sizeof number);
  return number;
}

}  // namespace xrds::c
