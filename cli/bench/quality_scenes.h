#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/frame.h"

namespace xrds {

/// Which renders of a folder of scenes are to be upscaled. Scene NAME is NAME_gt.exr, the reference, whose albedo and
/// normal are converged; NAME_auxK.exr, the full-resolution render of K samples a pixel; and the colour of K samples,
/// NAME_lrK.exr at a quarter of the resolution, NAME_x2lrK.exr, NAME_x8lrK.exr, ... at other scales.
struct QualitySetting {
  int scale = 4;
  int colourSamples = 64;           // at scale 1 those of the full-resolution render whose colour is taken
  std::optional<int> auxSamples{};  // empty: converged, those of the reference
  bool mergesColour = false;        // with that of the full-resolution render
  std::string denoisedBy{};         // what takes the noise out of the colours before any method sees them
  std::vector<std::string> inputs{"albedo", "normal"};  // the auxiliary images that are read

  /// Adds those that the model takes; of one that takes the full-resolution colour, merging.
  void read(const Model& model);

  /// "_lr64.exr" and its like.
  std::string colourSuffix() const;
  std::string auxSuffix() const;
  std::string auxText() const;  // "16" or "converged"
  /// Samples in the mean of the output's pixels; a render that gives colour and auxiliary images counts once.
  /// Empty for converged auxiliary images.
  std::optional<double> averageSamples() const;
};

/// Of the model's scale, with what it takes; at scale 1 the colour is that of the `aux` samples' render.
QualitySetting settingFor(const Model& model, int colour, int aux);

/// Finished images of another program: a folder with one NAME*.exr a scene, or a pattern in which * is the scene's
/// name.
struct FinishedImages {
  std::string name;
  std::string place;

  /// Nothing if there is none. Throws Error if the folder has several for the scene.
  std::optional<std::filesystem::path> find(const std::string& scene) const;
};

/// The files of one scene; `finished` in the order of the FinishedImages asked for.
struct SceneFiles {
  std::string name;
  std::filesystem::path reference, colour, aux;
  std::vector<std::filesystem::path> finished{};
};

/// The scenes of a folder that have every file, in the order of their names, and the names of those that have not.
struct SceneList {
  std::vector<SceneFiles> scenes;
  std::vector<std::string> skipped;
};

/// Throws Error unless the folder holds at least one whole scene.
SceneList findScenes(const std::filesystem::path& folder, const QualitySetting& setting,
                     const std::vector<FinishedImages>& finished);

/// One scene's pixels: `frame` with the inputs of the setting, `reference` of scale times its colour's size.
struct Scene {
  Frame frame;
  Image reference;
  std::vector<Image> finished;
};

/// Throws Error if a file cannot be read or its size does not fit the others.
Scene loadScene(const SceneFiles& files, const QualitySetting& setting);

}  // namespace xrds
