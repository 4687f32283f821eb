#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "advice/scene_features.h"

namespace xrds {

/// Where albedo and normal come from.
enum class Guides {
  rendered,  // a full-resolution render of the same paths, whose samples cost as many as they are
  free,      // clean ones, made by cheaper means
};

/// One way from samples to a picture, and how its error was found to depend on the scene: bench/advice.md.
struct Way {
  std::string name;   // "x4-full, merged, denoised first"
  std::string model;  // empty: a denoiser alone, at full resolution
  int scale = 1;
  Guides guides = Guides::rendered;
  bool merges = false, denoisesFirst = false, takesFullColour = false;
  std::vector<double> ratios;  // samples of the low- over those of the full-resolution render, as they were measured
  double constant = 0, perNoise = 0, perDetail = 0, perGuideNoise = 0;  // dB, of 1 and of each feature
  double leastNoise = 0, mostNoise = 0;                                 // that were measured, of noiseLeft()
  double spread = 0;  // dB, root mean square of the errors for scenes that were left out

  bool needsDenoiser() const { return model.empty() || denoisesFirst; }

  /// The logarithm to the base 2 of the variance that the noise has in the colour that the way begins with.
  double noiseLeft(const SceneFeatures& scene, RenderSamples samples) const;

  /// PSNR in dB.
  double predictedPsnr(const SceneFeatures& scene, RenderSamples samples) const;
};

/// The ways of a file that bench/advice.py has written. Throws Error if it cannot be read or is none.
std::vector<Way> readWays(const std::filesystem::path& file);

}  // namespace xrds
