#pragma once

#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "xrds/upscaler.h"
#include "xrds/xrds_examine.h"

namespace xrds {

/// What Upscaler::stress() is to try.
struct StressOptions {
  struct NamedModel {
    std::string name;
    const Model* model = nullptr;
  };
  std::vector<NamedModel> models{};  // beside random ones
  bool randomModels = true;
  uint32_t seed = 1;
  bool shortForm = false;  // some thousand cases of nine random models, a minute instead of many
  /// Called after each row with the finished share in [0, 1]; returning false ends the run with what there is.
  std::function<bool(double)> progress{};
};

/// One model with one change to its weights, in one precision and kernel family, over all inputs.
struct StressRow {
  std::string model, weights, precision, family;
  bool bounded = true;                          // with these weights the bounds on the error hold
  uint64_t cases = 0, nonFiniteOutputs = 0;     // frames
  uint64_t casesInParts = 0;                    // of these, in exact or bounded tiles or with windows skipped
  uint64_t repairedPixels = 0, lostPixels = 0;  // of the inputs; of the output, without the network's share
  uint64_t naturalCases = 0;
  double worstError = 0;  // of the natural inputs: RMS relative to double precision, in the transformed domain
  std::string worstInput;
  std::string firstDegraded;          // the first operator whose own error exceeds its budget; empty: none
  std::vector<std::string> promoted;  // values, and layers whose weights, fp16 keeps in fp32
  bool replaysExactly = true;         // after all other inputs
  bool bandsExactly = true;           // in bands of rows as in one piece
  bool tilesExactly = true;           // in exact tiles as in one piece
  double worstScaling = 0;    // change of the result where the colour is scaled: as worstError, of natural inputs
  uint64_t litFromBlack = 0;  // pixels above 0 of black frames, of models with a base image
  double worstSkip = 0;       // largest change of a skipped window, as SkipOptions::bound has it
};

/// The largest error of an operator alone, on what the device gave it, over all natural inputs.
struct StressOperator {
  std::string name, precision, family;
  double worstError = 0, budget = 0;  // RMS relative to double precision
  std::string where;                  // model, weights, and node
};

/// What came out.
struct StressReport {
  uint32_t seed = 0;
  double fp32Bound = 0, fp16Bound = 0;  // of StressRow::worstError
  double fp32ScalingBound = 0, fp16ScalingBound = 0;
  std::vector<std::string> colours, auxiliaries;
  std::vector<StressRow> rows{};
  std::vector<StressOperator> operators{};

  uint64_t cases() const;
  /// One sentence for each bar that is not met; empty: all are.
  std::vector<std::string> exceptions() const;
};

}  // namespace xrds

#include "xrds/stress_inline.h"
