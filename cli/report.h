#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/frame.h"
#include "image/metrics/metrics.h"
#include "xrds/xrds.hpp"

namespace xrds {

/// Prints device time, GFLOP/s, bytes and share of each kind of operator, then of the slowest single dispatches.
void printProfile(const std::vector<Upscaler::ProfileRow>& rows);

/// Compares each operator with its reference on the middle of the frame, at most 16 x 16 low-resolution pixels.
std::vector<Upscaler::CheckRow> checkOnCrop(Device& device, const Model& model, const Frame& frame,
                                            const Upscaler::Options& options);

/// The index of the first operator that diverges, -1 for none.
int firstDivergent(const std::vector<Upscaler::CheckRow>& rows);

/// Prints the operators that diverge, or that none does.
void printCheck(const std::vector<Upscaler::CheckRow>& rows);

/// A way to upscale without a network: base "bicubic", "demodulated" or "guided"; transfer "log1p" or "none".
struct Baseline {
  std::string base, transfer = "log1p";
  std::optional<float> exposure{};  // empty: from the frame
  TileOptions tiles{};
};

/// Throws Error as Model::untrained and Upscaler do, Failure when interrupted.
Image runBaseline(Device& device, const Baseline& baseline, const Image& colour, const std::vector<Image>& auxiliary,
                  int scale);

/// Reads the colour of a file that must have width x height pixels; `what` it is, "reference", stands in messages.
/// Throws Error unless it has this size and finite values.
Image readFullSize(const std::string& path, const std::string& what, int width, int height);
Image readReference(const std::string& path, int width, int height);

/// Writes the input's pixels enlarged, its bicubic upscaling, the result and, if there is one, the reference side by
/// side as a PNG.
void writeSideBySide(Device& device, const Frame& frame, const Image& result, const std::optional<Image>& reference,
                     const std::string& pngPath);

/// How far an image of that name is from the reference.
struct MeasuredImage {
  std::string name;
  Metrics metrics;
};

/// Measures the baselines that the frame's layers allow, then the result, "xrds", against the reference.
std::vector<MeasuredImage> measureWithBaselines(Device& device, const Frame& frame, const Image& result,
                                                const Image& reference);

/// Prints PSNR, RelMSE, its trimmed form and FLIP of each; nothing if there are none.
void printMeasured(const std::vector<MeasuredImage>& images);

}  // namespace xrds
