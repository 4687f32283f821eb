#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/bench/quality_methods.h"
#include "cli/bench/quality_scenes.h"
#include "image/metrics/metrics.h"

namespace xrds {

/// What one method made of one scene; no time where another program made it.
struct SceneQuality {
  Metrics metrics;
  std::optional<FrameSeconds> seconds{};
};

/// One method on every scene, in the order of the report's scene names; `model` is the hash of a trained model's file.
struct MethodQuality {
  std::string name, model{};
  std::vector<SceneQuality> scenes{};

  Metrics mean() const;
  std::optional<double> medianSeconds() const;
};

/// All that a run of `xrds bench quality` found out.
struct QualityReport {
  std::string folder, precision, device;
  QualitySetting setting;
  std::vector<std::string> sceneNames, skipped;
  std::vector<MethodQuality> methods;

  /// The untrained method to which the others are compared; null if it is absent.
  const MethodQuality* guided() const;
};

/// What was measured and two tables: every image, and the means. For a terminal, and as Markdown.
std::string plainText(const QualityReport& report);
std::string markdownText(const QualityReport& report);

/// Every number with its definition.
std::string jsonText(const QualityReport& report);

}  // namespace xrds
