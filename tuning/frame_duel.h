#pragma once

#include "frames/session.h"

namespace xrds {

/// Whole frames of random pixels, with a table of kernels and with the fixed choice, in turns.
struct FrameDuel {
  double seconds = 0, fixedSeconds = 0;  // medians
  double difference = 0;                 // RMS of the difference of the pictures over the RMS of the fixed one
  bool isSame = false;                   // within what two right devices may differ by
};

/// Throws Error if the device fails or has no room. `mayGoOn`, if given, stops it with Cancelled by returning false.
FrameDuel frameDuel(Gpu& gpu, const NetworkModel& model, FrameShape frame, Precision precision,
                    const KernelTable& table, const std::function<bool()>& mayGoOn = {});

}  // namespace xrds
