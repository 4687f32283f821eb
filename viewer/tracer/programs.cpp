#include "viewer/tracer/programs.h"

namespace xrds {
namespace {
#include "trace_auxiliary.h"
#include "trace_radiance.h"
}  // namespace

std::span<const uint32_t> tracerProgram(std::string_view name) {
  if (name == "trace_radiance") return trace_radiance;
  if (name == "trace_auxiliary") return trace_auxiliary;
  return {};
}

}  // namespace xrds
