#pragma once

#include <string>
#include <vector>

#include "cli/frame.h"
#include "xrds/xrds.h"

namespace xrds {

/// Prints device time, GFLOP/s, bytes and share of each kind of operator, then of the slowest single dispatches.
void printProfile(const std::vector<Upscaler::ProfileRow>& rows);

/// Compares each operator with its reference on the middle of the frame, at most 16 x 16 low-resolution pixels.
std::vector<Upscaler::CheckRow> checkOnCrop(Device& device, const Model& model, const Frame& frame,
                                            const Upscaler::Options& options);

/// Prints the operators that diverge, or that none does; returns the index of the first one, -1 for none.
int printCheck(const std::vector<Upscaler::CheckRow>& rows);

/// Upscales without a network: "bicubic", "demodulated" or "guided", with transfer "log1p" or "none".
Image runBaseline(Device& device, const std::string& base, const std::string& transfer, const Image& colour,
                  const std::vector<Image>& auxiliary, int scale);

/// Writes the input's pixels enlarged, its bicubic upscaling, the result and, if a path is given, the reference side by
/// side as a PNG.
void writeSideBySide(Device& device, const Model& model, const Frame& frame, const Image& result,
                     const std::string& referencePath, const std::string& pngPath);

/// Prints PSNR, RelMSE, its trimmed form and FLIP for the result and for the baselines that the frame's layers allow.
void printAgainstReference(Device& device, const Model& model, const Frame& frame, const Image& result,
                           const std::string& referencePath);

}  // namespace xrds
