#pragma once

#include <array>
#include <concepts>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "engine/tensor.h"

namespace xrds {

/// The written version of a kernel: `plain` is the readable one and runs anywhere, `lane` keeps one token a lane for
/// CPU devices, `tile` shares memory for GPUs, `matrix` uses matrix units, and `fused` besides makes whole layers in
/// one kernel. An operator without it falls back: `fused` to `matrix`, `matrix` to `tile`, all to `plain`.
enum class KernelFamily : uint8_t { plain, lane, tile, matrix, fused };

/// Whether the family's kernels use matrix units.
constexpr bool usesMatrixUnits(KernelFamily family) {
  return family == KernelFamily::matrix || family == KernelFamily::fused;
}

/// "plain", "lane", "tile", "matrix" or "fused".
const char* nameOf(KernelFamily family);

/// The names of all families, in their order.
std::span<const char* const> kernelFamilyNames();

/// The family of that name. Throws Error that lists the names if there is none.
KernelFamily kernelFamilyOf(std::string_view name);

/// How kernels reach a device's matrix units: through one of two extensions, or, for tests, by plain arithmetic on the
/// same fragments. All multiply matrices of 16-bit floats and add up in 32 bits.
enum class MatrixUnits : uint8_t { none, software, nv, khr };

/// "none", "software", "nv" or "khr".
const char* nameOf(MatrixUnits units);

/// The products that matrix units take: rows x depth by depth x columns, 8 or 16 each.
struct MatrixSize {
  uint32_t rows = 16, columns = 16, depth = 16;
  bool halfSums = true;  // the sums may be halves, too, so that fp32 ones are converted in registers
};

/// How the kernel of a family shares out its work, where that may be chosen. What is 0, or does not fit an operator, is
/// left to the operator's own rule.
struct KernelShape {
  uint32_t outputs = 0;   // channels of a lane, fragments of them of a workgroup, or pixels
  uint32_t rows = 0;      // rows of pixels, tokens or queries of an invocation; or the order of its outputs
  uint32_t subgroup = 0;  // invocations of a subgroup, one of subgroupSizes()
  auto operator<=>(const KernelShape&) const = default;
};

/// Which kernel makes an operator.
struct KernelChoice {
  KernelFamily family = KernelFamily::plain;
  KernelShape shape{};
  auto operator<=>(const KernelChoice&) const = default;
};

/// How a CPU device hands the value of one lane to all in few instructions.
enum class LaneCode : uint8_t {
  shuffles,    // by a shuffle with a constant lane
  broadcasts,  // of 64 bits by a broadcast, outside of control flow: its shuffles of them are loops
  scalars      // by a broadcast: what is equal in all lanes is a scalar to the compiler
};

/// The properties of a device that decide how work is dispatched: plain numbers, testable without a device.
struct DeviceTraits {
  KernelFamily family = KernelFamily::plain;
  KernelShape shape{};                          // asked of its kernels
  MatrixUnits matrixUnits = MatrixUnits::none;  // of the families `matrix` and `fused`
  MatrixSize matrixSize;                        // of their products
  uint32_t subgroupSize = 8;
  uint32_t leastSubgroup = 0, mostSubgroup = 0;  // sizes that a pipeline may ask for; 0: it has no choice
  uint32_t maxGroupSubgroups = 0;                // of a workgroup whose pipeline asks for a size
  uint64_t maxStorageBufferRange = uint64_t{128} << 20;
  uint64_t maxTexelBufferElements = uint64_t{1} << 27;
  uint64_t maxAllocationBytes = uint64_t{1} << 31;
  uint64_t memoryBytes = 0;  // of a GPU, for which frames are cut into large pieces; 0: a CPU device
  uint32_t maxSharedBytes = 32768;
  uint32_t maxGroupInvocations = 1024;
  bool shaderInt64 = false;  // also in subgroup operations
  /// Of a CPU device (engine/llvmpipe.h). Kernels read it as the constant kLaneCodeConstant, beside those of their
  /// dispatch.
  LaneCode laneCode = LaneCode::shuffles;
  bool bufferAddresses = false;  // of a CPU device: kernels may read buffers by address
};

/// The sizes of subgroups, beside the device's own, that a pipeline of any workgroup may ask for.
std::vector<uint32_t> subgroupSizes(const DeviceTraits& device);

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

}  // namespace xrds
