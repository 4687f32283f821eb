#pragma once

#include <cstring>
#include <string>

#include "xrds/error.h"

namespace xrds::c {

/// The structure, whose structSize is that of this version. Throws InvalidArgument if it is not: the caller forgot it,
/// or was built with the header of another version.
template <class T>
const T& checkSize(const T& structure) {
  if (structure.structSize != sizeof(T))
    throw InvalidArgument("A structure has a structSize of " + std::to_string(structure.structSize) + ", expected " +
                          std::to_string(sizeof(T)) +
                          ": set it to its sizeof, or build with the header of this version.");
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
