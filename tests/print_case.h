#pragma once

#include <gtest/gtest.h>

#include <ostream>
#include <tuple>
#include <type_traits>

#include "engine/dispatch.h"
#include "network/config.h"
#include "network/precision.h"

/// Prints the parameters of tests as a person reads them, in place of their bytes. A test file whose parameters are
/// aggregates of its own says `using test::PrintTo;` in their namespace.
namespace xrds {

inline void PrintTo(KernelFamily family, std::ostream* out) { *out << nameOf(family); }
inline void PrintTo(DataType type, std::ostream* out) { *out << (type == DataType::f32 ? "f32" : "f16"); }
inline void PrintTo(Precision precision, std::ostream* out) { *out << nameOf(precision); }
inline void PrintTo(Transfer transfer, std::ostream* out) { *out << (transfer == Transfer::none ? "none" : "log1p"); }
inline void PrintTo(BlockKind block, std::ostream* out) {
  constexpr const char* kNames[] = {"rdst", "rstb", "rdb"};
  *out << kNames[static_cast<size_t>(block)];
}
inline void PrintTo(RowRange rows, std::ostream* out) { *out << rows.begin << ".." << rows.end; }

namespace test {

/// Stands for a field of any type when the fields of an aggregate are counted.
struct AnyField {
  template <class T>
  operator T() const;  // NOLINT: must convert silently
};

template <class T, class... Fields>
constexpr size_t fieldCount() {
  if constexpr (requires { T{Fields{}..., AnyField{}}; })
    return fieldCount<T, Fields..., AnyField>();
  else
    return sizeof...(Fields);
}

/// The fields of an aggregate, of at most fifteen: C++20 has no structured binding of any number.
template <class T>
auto fieldsOf(const T& value) {
  constexpr size_t kCount = fieldCount<T>();
  static_assert(kCount >= 1 && kCount <= 15, "extend fieldsOf()");
  if constexpr (kCount == 1) {
    const auto& [a] = value;
    return std::tie(a);
  } else if constexpr (kCount == 2) {
    const auto& [a, b] = value;
    return std::tie(a, b);
  } else if constexpr (kCount == 3) {
    const auto& [a, b, c] = value;
    return std::tie(a, b, c);
  } else if constexpr (kCount == 4) {
    const auto& [a, b, c, d] = value;
    return std::tie(a, b, c, d);
  } else if constexpr (kCount == 5) {
    const auto& [a, b, c, d, e] = value;
    return std::tie(a, b, c, d, e);
  } else if constexpr (kCount == 6) {
    const auto& [a, b, c, d, e, f] = value;
    return std::tie(a, b, c, d, e, f);
  } else if constexpr (kCount == 7) {
    const auto& [a, b, c, d, e, f, g] = value;
    return std::tie(a, b, c, d, e, f, g);
  } else if constexpr (kCount == 8) {
    const auto& [a, b, c, d, e, f, g, h] = value;
    return std::tie(a, b, c, d, e, f, g, h);
  } else if constexpr (kCount == 9) {
    const auto& [a, b, c, d, e, f, g, h, i] = value;
    return std::tie(a, b, c, d, e, f, g, h, i);
  } else if constexpr (kCount == 10) {
    const auto& [a, b, c, d, e, f, g, h, i, j] = value;
    return std::tie(a, b, c, d, e, f, g, h, i, j);
  } else if constexpr (kCount == 11) {
    const auto& [a, b, c, d, e, f, g, h, i, j, k] = value;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k);
  } else if constexpr (kCount == 12) {
    const auto& [a, b, c, d, e, f, g, h, i, j, k, l] = value;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l);
  } else if constexpr (kCount == 13) {
    const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m] = value;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m);
  } else if constexpr (kCount == 14) {
    const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n] = value;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n);
  } else {
    const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o] = value;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o);
  }
}

/// "{1, 37, f16, 4..9}".
template <class T>
requires std::is_aggregate_v<T>
void PrintTo(const T& value, std::ostream* out) {
  *out << '{';
  std::apply(
      [&](const auto&... fields) {
        const char* separator = "";
        const auto print = [&]<class Field>(const Field& field) {
          *out << separator;
          separator = ", ";
          if constexpr (requires { PrintTo(field, out); })
            PrintTo(field, out);
          else if constexpr (std::is_enum_v<Field>)
            *out << static_cast<int64_t>(field);
          else
            *out << testing::PrintToString(field);
        };
        (print(fields), ...);
      },
      fieldsOf(value));
  *out << '}';
}

}  // namespace test
}  // namespace xrds
