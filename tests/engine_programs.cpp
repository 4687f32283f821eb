#include "tests/engine_programs.h"

#include "conv3x3_matrix_software_f16.h"
#include "conv3x3_matrix_software_f32.h"
#include "linear_matrix_software_f16.h"
#include "linear_matrix_software_f32.h"
#include "swin_layer_matrix_software_f16.h"
#include "to_half.h"
#include "twice_plus.h"
#include "window_attention_matrix_software_f16.h"
#include "writes_nothing.h"

namespace xrds::test {

std::span<const uint32_t> engineProgram(std::string_view name) {
  if (name == "twice_plus") return twice_plus;
  if (name == "to_half") return to_half;
  if (name == "writes_nothing") return writes_nothing;
  if (name == "linear_matrix_software_f32") return linear_matrix_software_f32;
  if (name == "linear_matrix_software_f16") return linear_matrix_software_f16;
  if (name == "conv3x3_matrix_software_f32") return conv3x3_matrix_software_f32;
  if (name == "conv3x3_matrix_software_f16") return conv3x3_matrix_software_f16;
  if (name == "swin_layer_matrix_software_f16") return swin_layer_matrix_software_f16;
  if (name == "window_attention_matrix_software_f16") return window_attention_matrix_software_f16;
  return {};
}

PlacedDispatch twicePlus(const Buffer& buffer, uint64_t sourceOffset, uint64_t targetOffset, uint32_t quads,
                         uint32_t add) {
  PlacedDispatch placed;
  placed.dispatch.program = "twice_plus";
  placed.dispatch.specialization = {add};
  placed.dispatch.bindings = {{0, Access::read, BindingKind::texel}, {1, Access::write, BindingKind::storage}};
  placed.dispatch.pushConstants = pushBytes(quads);
  placed.dispatch.groupCount = {ceilDivide(quads, 64), 1, 1};
  placed.dispatch.multiplyAdds = uint64_t{quads} * 4;
  placed.ranges = {{&buffer, sourceOffset, uint64_t{quads} * 16}, {&buffer, targetOffset, uint64_t{quads} * 16}};
  return placed;
}

PlacedDispatch toHalfs(const Buffer& buffer, uint64_t sourceOffset, uint64_t targetOffset, uint32_t quads) {
  PlacedDispatch placed = twicePlus(buffer, sourceOffset, targetOffset, quads, 0);
  placed.dispatch.program = "to_half";
  placed.dispatch.specialization.clear();
  placed.ranges[1].byteSize = uint64_t{quads} * 8;
  return placed;
}

std::vector<float> downloadFloats(const Buffer& buffer, uint64_t byteOffset, size_t count) {
  std::vector<float> numbers(count);
  buffer.download(byteOffset, std::as_writable_bytes(std::span(numbers)));
  return numbers;
}

void uploadFloats(Buffer& buffer, uint64_t byteOffset, std::span<const float> numbers) {
  buffer.upload(byteOffset, std::as_bytes(numbers));
}

}  // namespace xrds::test
