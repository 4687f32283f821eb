#pragma once

#include <array>
#include <concepts>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "engine/device_traits.h"
#include "engine/tensor.h"

namespace xrds {

enum class Access : uint8_t { read, write };
/// Reads go through uniform texel buffers of vec4 (which convert f16 for free), writes through storage buffers. Kernels
/// that multiply halves read their bits: texels of as many bytes, unsigned words. Bytes that are only copied need no
/// kernel.
enum class BindingKind : uint8_t { storage, texel, texelBits, copied };

constexpr bool isTexelBuffer(BindingKind kind) { return kind == BindingKind::texel || kind == BindingKind::texelBits; }

/// One descriptor: a byte range inside a value, and what the kernel does with it.
struct Binding {
  ValueId value = kNoValue;
  Access access = Access::read;
  BindingKind kind = BindingKind::texel;
  DataType type = DataType::f32;  // of a texel: rgba32f or rgba16f
  uint64_t byteOffset = 0;        // inside the value; a multiple of kBindingAlignment, or of 4 if copied
  uint64_t byteSize = 0;          // kWeights: 0 means all of them
};

/// Every offset that is bound is a multiple of this, which satisfies any Vulkan device.
inline constexpr uint64_t kBindingAlignment = 256;
inline constexpr uint32_t kMaxPushConstantBytes = 128;
inline constexpr uint32_t kLaneCodeConstant = 32;  // constant_id, behind those of any dispatch

/// One kernel launch as plain data. Descriptor i of set 0 is bindings[i]; constant_id i is specialization[i]. Or a copy
/// of the bytes of bindings[0] to as many of bindings[1], both `copied`; its program only names it.
struct Dispatch {
  std::string program;  // operator, family and storage type of the output: "layer_norm_plain_f32"
  std::vector<uint32_t> specialization;
  std::vector<Binding> bindings;
  std::vector<std::byte> pushConstants;
  bool weightsByAddress = false;  // their address is written over the last 8 bytes of the push constants
  std::array<uint32_t, 3> groupCount{1, 1, 1};
  uint32_t subgroupSize = 0;   // invocations of its subgroups; 0: as many as the driver likes
  bool fullSubgroups = false;  // no subgroup may have fewer
  std::string label;           // the node's name in the graph
  uint64_t multiplyAdds = 0;   // of the formula: for the profile and for cutting submissions
  uint64_t savedProducts = 0;  // of these, those that the kernel does without (Winograd's)

  bool isCopy() const { return !bindings.empty() && bindings[0].kind == BindingKind::copied; }
};

template <class T>
std::vector<std::byte> pushBytes(const T& parameters) {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) <= kMaxPushConstantBytes);
  std::vector<std::byte> bytes(sizeof(T));
  std::memcpy(bytes.data(), &parameters, sizeof(T));
  return bytes;
}

/// The least multiple that is not below the size.
template <std::unsigned_integral T>
constexpr T alignUp(T size, std::type_identity_t<T> multiple) {
  return (size + multiple - 1) / multiple * multiple;
}
constexpr uint32_t ceilDivide(uint64_t a, uint64_t b) { return static_cast<uint32_t>((a + b - 1) / b); }

/// Reads all of the tensor behind the view, as vec4 texels.
inline Binding readTexels(const TensorView& view) {
  return {view.value, Access::read, BindingKind::texel, view.type, 0, view.storedByteSize()};
}

/// Reads all of a tensor of halves behind the view, as the bits of four of them.
inline Binding readBits(const TensorView& view) {
  XRDS_CHECK(view.type == DataType::f16);
  return {view.value, Access::read, BindingKind::texelBits, view.type, 0, view.storedByteSize()};
}

/// Reads the packed weights of the dispatch, as vec4 texels.
inline Binding readWeights(DataType type) { return {kWeights, Access::read, BindingKind::texel, type, 0, 0}; }

/// Reads the packed weights of the dispatch as a storage buffer, halves as they are.
inline Binding readPackedHalves() { return {kWeights, Access::read, BindingKind::storage, DataType::f16, 0, 0}; }

/// Writes the rows of the tensor behind the view. The binding starts at the aligned offset at or below the first row;
/// the kernel subtracts storeOrigin() from its vec4 index.
inline Binding writeRows(const TensorView& view, RowRange rows) {
  const uint64_t begin = view.storedRow(rows.begin) * view.rowByteSize() / kBindingAlignment * kBindingAlignment;
  const uint64_t end = view.storedRow(rows.end) * view.rowByteSize();
  return {view.value, Access::write, BindingKind::storage, view.type, begin, end - begin};
}

/// The vec4 index, counted from the start of the tensor, at which the binding of writeRows() starts.
inline uint32_t storeOrigin(const TensorView& view, RowRange rows) {
  return static_cast<uint32_t>(writeRows(view, rows).byteOffset / (4 * byteSize(view.type)));
}

/// The copy of the rows from one view to the same rows of the other, of the same width and type and both whole pixels.
Dispatch copyRows(std::string program, const TensorView& from, const TensorView& to, RowRange rows);

/// "layer_norm" + "plain" + "f16" -> the name under which CMake embeds that variant.
std::string programName(const char* op, KernelFamily family, DataType stored);

/// The same for the matrix family: "linear_matrix_nv_f16".
std::string matrixProgramName(const char* op, MatrixUnits units, DataType stored);

/// The operator of a program so named: "conv3x3" of "conv3x3_lane4_turns_f32".
std::string operatorOf(const std::string& program);

}  // namespace xrds
