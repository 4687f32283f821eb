#pragma once

#include <string>

namespace xrds {

/// What the process returns; documented in `xrds --help`.
enum class ExitCode : int {
  ok = 0,
  bug = 1,      // of ours: please report
  usage = 2,    // a wrong option or argument
  input = 3,    // an image cannot be read, or its layers or sizes do not fit
  model = 4,    // a model file cannot be read or does not fit
  device = 5,   // no Vulkan device, or it failed, or not enough memory
  output = 6,   // the result cannot be written
  differs = 7,  // --check, doctor or compare --min-psnr found too large a difference, advise no plan
  frames = 8,   // frames of a sequence could not be made; the others were
  interrupted = 130
};

/// A failure with its exit code; the text is one sentence for the user.
struct Failure {
  ExitCode code = ExitCode::bug;
  std::string message;
};

}  // namespace xrds
