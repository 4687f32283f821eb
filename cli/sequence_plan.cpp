#include "cli/sequence_plan.h"

#include <algorithm>
#include <system_error>

#include "app/failing_with.h"
#include "app/frame_files.h"
#include "cli/output_file.h"
#include "image/pending_file.h"
#include "sequence/file_pattern.h"
#include "sequence/frame_range.h"
#include "xrds/path_text.h"

namespace xrds {
namespace {

namespace fs = std::filesystem;

// COLOR and AUX as patterns.
struct Inputs {
  FilePattern colour, auxiliary;
};

// Also one that is not there: a name without an extension.
bool isFolder(const std::string& path) {
  std::error_code ignored;
  const fs::path place = pathOf(path);
  if (path.ends_with('/') || fs::is_directory(place, ignored)) return true;
  return !fs::exists(place, ignored) && !place.has_extension() && !FilePattern::mayBeMany(path);
}

// The same names in the same folder, however that was spelled.
FilePattern resolved(const FilePattern& pattern) {
  const fs::path folder = pattern.of(0).parent_path();
  std::error_code ignored;
  return pattern.in(fs::weakly_canonical(folder.empty() ? "." : folder, ignored));
}

// Whether a frame of both has one file.
bool meet(const FilePattern& a, const FilePattern& b, const std::vector<int>& frames) {
  return std::any_of(frames.begin(), frames.end(), [first = resolved(a), second = resolved(b)](int frame) {
    return first.of(frame) == second.of(frame);
  });
}

// --output as a pattern; in a folder files have the names of the colour.
FilePattern outputOf(const UpscaleOptions& options, const Inputs& inputs, const std::vector<int>& frames) {
  const FilePattern output =
      isFolder(options.output) ? inputs.colour.in(pathOf(options.output)) : FilePattern(options.output);
  if (!output.isMany())
    throw Failure{ExitCode::usage, "--output '" + options.output +
                                       "' is one file for many frames: put #### in its name, or name a folder."};
  for (const FilePattern& input : {inputs.colour, inputs.auxiliary})
    if (meet(input, output, frames))
      throw Failure{ExitCode::usage,
                    "--output '" + output.text() + "' is an input, too: choose another name or folder."};
  return output;
}

std::vector<int> framesOf(const UpscaleOptions& options, const FilePattern& input) {
  if (!options.frames.empty()) return failingWith(ExitCode::usage, [&] { return parseFrames(options.frames); });
  std::vector<int> frames = failingWith(ExitCode::input, [&] { return input.frames(); });
  if (frames.empty())
    throw Failure{ExitCode::input, "There is no file '" + input.text() + "'; look at the name, or give --frames."};
  return frames;
}

// Whether COLOR and AUX were given the other way round, by the first frame whose two files can be read.
bool areSwapped(const Inputs& inputs, const std::vector<int>& frames) {
  for (const int frame : frames) try {
      const fs::path colour = inputs.colour.of(frame);
      return sortPair(colour, inputs.auxiliary.of(frame)).colour != colour;
    } catch (const Error&) {  // told when its turn comes
    }
  return false;
}

void makeFolder(const fs::path& folder, const std::string& output) {
  std::error_code failure;
  if (!folder.empty()) fs::create_directories(folder, failure);
  if (failure)
    throw Failure{ExitCode::output, "Cannot make the folder of '" + output + "': " + failure.message() + "."};
  try {
    requireWritable((folder / ".xrds").string());  // any name
  } catch (const Failure&) {
    throw Failure{ExitCode::output, "Cannot write '" + output +
                                        "': its folder takes no new files; check the permissions or choose another "
                                        "place."};
  }
  removeAbandonedFiles(folder);
}

}  // namespace

UpscaleOptions SequenceFrame::alone(const UpscaleOptions& options) const {
  UpscaleOptions one = options;
  one.color = colour.string();
  one.aux = auxiliary.string();
  one.output = output.string();
  return one;
}

std::optional<std::string> mergedWithout(const SequenceFrame& frame) {
  try {
    return readExrHeader(frame.output).parts.front().attributes.text(kMergedWithout);
  } catch (const Error&) {  // whoever put it there
    return {};
  }
}

bool isMade(const SequenceFrame& frame) {
  std::error_code ignored;
  return fs::exists(frame.output, ignored) && !mergedWithout(frame);
}

SequencePlan planSequence(const UpscaleOptions& options) {
  Inputs inputs = failingWith(ExitCode::usage, [&] {
    return Inputs{FilePattern(options.color), FilePattern(options.aux.empty() ? options.color : options.aux)};
  });
  const std::vector<int> numbers = framesOf(options, inputs.colour.isMany() ? inputs.colour : inputs.auxiliary);
  if (!options.aux.empty() && areSwapped(inputs, numbers)) std::swap(inputs.colour, inputs.auxiliary);
  if (!inputs.colour.isMany())
    throw Failure{ExitCode::usage, "COLOR '" + options.color + "' is one file for many frames: put #### in its name."};
  const FilePattern output = failingWith(ExitCode::usage, [&] { return outputOf(options, inputs, numbers); });
  requireExtension(output.of(numbers.front()).string(), ".exr", "--output");
  makeFolder(output.of(numbers.front()).parent_path(), output.text());
  SequencePlan plan{.output = output.text()};
  plan.frame = [inputs, output, hasAuxiliary = !options.aux.empty()](int number) {
    SequenceFrame frame{number, inputs.colour.of(number), {}, output.of(number)};
    if (hasAuxiliary) frame.auxiliary = inputs.auxiliary.of(number);
    return frame;
  };
  for (const int number : numbers) {
    SequenceFrame frame = plan.frame(number);
    if (options.skipExisting && isMade(frame))
      plan.there.push_back(number);
    else
      plan.frames.push_back(std::move(frame));
  }
  return plan;
}

}  // namespace xrds
