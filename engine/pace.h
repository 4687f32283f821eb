#pragma once

#include <cstdint>

namespace xrds {

/// How fast a device works, as it was measured on what it ran: in multiply-adds a second as workOf() counts them.
struct Pace {
  double mean = 0;     // of a whole run; 0: not known yet
  double slowest = 0;  // of the submission with the least
};

/// A submission is to take that long at most, so that others wait no longer for the device.
inline constexpr double kSubmissionSeconds = 0.05;
/// Of a device that has not run anything: 43 ms at 100 GFLOP/s.
inline constexpr uint64_t kUnknownWork = uint64_t{1} << 31;

/// The work of a submission, or of a dispatch, of such a device, at most `most`.
uint64_t workOfSubmission(const Pace& pace, uint64_t most);

/// The pace after a run of so much work, whose slowest submission had `slowest`. Runs too short to tell are ignored.
Pace measured(const Pace& before, double work, double seconds, double slowest);

}  // namespace xrds
