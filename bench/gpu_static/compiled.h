#pragma once

#include <map>
#include <string>

#include "engine/handles.h"

namespace xrds {

/// What a driver's compiler says of a pipeline.
struct Compiled {
  std::string error;                         // not empty: it was refused
  uint32_t subgroupSize = 0;                 // of the invocations
  std::map<std::string, double> statistics;  // in the driver's words
  std::map<std::string, std::string> texts;  // "NIR Shader(s)", "Assembly", ...
};

/// Compiles the pipeline, asks for its statistics and destroys it.
Compiled compiled(Gpu::Handles& gpu, const PipelineKey& key);

}  // namespace xrds
