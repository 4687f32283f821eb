#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cli/bench/model_run.h"
#include "xrds/xrds.hpp"

namespace xrds {

/// How far a picture made of tiles is from that of the whole frame, and both from the reference.
struct TileError {
  double relativeRms = 0;  // of log(1 + e x), e the exposure
  double step = 0;         // of the sRGB picture, in 255ths: by how much the difference jumps between neighbours
  double psnr = 0;         // less that of the whole frame, dB
};

/// The errors of one halo, in the order of the report's scene names.
struct HaloErrors {
  uint32_t halo = 0;  // low-resolution pixels
  std::vector<TileError> scenes{};

  TileError mean() const;
  TileError worst() const;  // of each number
};

/// All that a run of `xrds bench tiles` found out.
struct TilesReport {
  ModelRun run;
  uint32_t columns = 2, rows = 1;
  std::vector<std::string> sceneNames;
  std::vector<HaloErrors> halos;  // that fit every scene
};

/// Setting and table for a terminal.
std::string plainText(const TilesReport& report);

/// Every number with its definition.
std::string jsonText(const TilesReport& report);

}  // namespace xrds
