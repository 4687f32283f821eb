#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/upscale_options.h"

namespace xrds {

/// One frame of a sequence.
struct SequenceFrame {
  int number = 0;
  std::filesystem::path colour, auxiliary, output;  // auxiliary: empty where its layers are in the colour's file
  /// The options of a run of this frame alone.
  UpscaleOptions alone(const UpscaleOptions& options) const;
};

/// What is to be made.
struct SequencePlan {
  std::vector<SequenceFrame> frames;
  std::vector<int> there;                          // frames that --skip-existing leaves out
  std::string output;                              // names of the outputs, for messages
  std::function<SequenceFrame(int number)> frame;  // any frame, whether it is asked for, or there, or not
};

/// The frames that the output of a frame says it was merged without (kMergedWithout); nothing if it says none, or is
/// not there.
std::optional<std::string> mergedWithout(const SequenceFrame& frame);

/// Whether the output of a frame is there, for good: not if it says that it was merged without some.
bool isMade(const SequenceFrame& frame);

/// The frames that the options name, those that are to be made and those that are there. Makes the folder of the
/// outputs. Throws Failure if there are none, if two frames would write one file, or if the folder cannot be written.
SequencePlan planSequence(const UpscaleOptions& options);

}  // namespace xrds
