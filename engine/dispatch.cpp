#include "engine/dispatch.h"

#include <algorithm>

namespace xrds {

std::string programName(const char* op, KernelFamily family, DataType stored) {
  return std::string(op) + "_" + nameOf(family) + (stored == DataType::f32 ? "_f32" : "_f16");
}

std::string matrixProgramName(const char* op, MatrixUnits units, DataType stored) {
  return std::string(op) + "_matrix_" + nameOf(units) + (stored == DataType::f32 ? "_f32" : "_f16");
}

std::string operatorOf(const std::string& program) {
  size_t end = program.size();
  for (const char* family : kernelFamilyNames()) end = std::min(end, program.find(std::string("_") + family));
  return program.substr(0, end);
}

Dispatch copyRows(std::string program, const TensorView& from, const TensorView& to, RowRange rows) {
  XRDS_CHECK(from.type == to.type);
  for (const TensorView& view : {from, to}) XRDS_CHECK_EQ(view.channels, view.channelStride);
  XRDS_CHECK_EQ(from.rowByteSize(), to.rowByteSize());
  const auto bytesOf = [&](const TensorView& view, Access access) -> Binding {
    return {view.value,
            access,
            BindingKind::copied,
            view.type,
            view.storedRow(rows.begin) * view.rowByteSize(),
            (rows.end - rows.begin) * view.rowByteSize()};
  };
  return {.program = std::move(program), .bindings = {bytesOf(from, Access::read), bytesOf(to, Access::write)}};
}

}  // namespace xrds
