#pragma once

#include <string>
#include <vector>

#include "cli/bench/model_run.h"
#include "xrds/xrds.hpp"

namespace xrds {

/// The largest change of a window, root mean square of log(1 + exposure radiance).
struct LargestChange {
  double interpolated = 0, computed = 0;
};

/// One scene without and with skipping.
struct SkipMeasurement {
  std::string scene;
  SkipMap map;
  std::vector<double> secondsOff, seconds;  // of each pair of runs
  double psnrOff = 0, psnr = 0;
  LargestChange change;
};

/// All that a run of `xrds bench skip` found out.
struct SkipReport {
  ModelRun run;
  std::string skip;  // as it was asked for
  int runs = 0;      // pairs of each scene
  bool cpuTime = false;
  std::vector<SkipMeasurement> scenes;
};

/// Setting, table and verdict for a terminal, and the table alone as Markdown.
std::string plainText(const SkipReport& report);
std::string markdownText(const SkipReport& report);

/// Every number with its definition.
std::string jsonText(const SkipReport& report);

}  // namespace xrds
