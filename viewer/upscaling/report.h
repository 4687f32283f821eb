#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/exit_code.h"
#include "image/metrics/metrics.h"
#include "viewer/tracer/scene.h"
#include "viewer/upscaling/stage_times.h"

namespace xrds {

/// How far a picture is from the reference.
struct ComparedPicture {
  std::string name;
  Metrics metrics;
};

/// What the worker has done so far.
struct Report {
  std::string files, model, device;  // of the picture that is shown
  std::string denoisedBy;            // its images, first; empty: they are as they were
  std::string error, waiting, notice;
  ExitCode failure = ExitCode::ok;  // what kind the error is of
  bool fp16 = false, hasReference = false;
  uint32_t width = 0, height = 0, scale = 1;  // of the input
  double share = 1;                           // of the run under way
  uint32_t tiles = 1;
  bool onDevice = true;               // or it passes through the host
  std::string whyNotSkipped;          // by this model, though it is asked for
  double interpolated = 0, kept = 0;  // of the windows, the share
  uint32_t windowSide = 0;            // of one, in pixels of the output
  float exposure = 0;
  uint64_t deviceBytes = 0;
  std::vector<StageTime> stages;
  std::vector<std::string> warnings;
  std::vector<ComparedPicture> compared;
  double picturesPerSecond = 0;
  uint64_t pictures = 0;         // upscaled so far
  uint64_t partialPictures = 0;  // shown before all their tiles were there
  uint32_t samples = 0;          // of a pixel of a live view's colour
  size_t merged = 1;             // frames that the input is made of
  std::string scene;             // of the live view, once it is there
  Camera startCamera;            // its own
  bool current = false;          // a picture of what is wanted is shown, though samples or metrics may follow
  bool settled = false;          // all that is wanted is shown
};

}  // namespace xrds
