#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/exit_code.h"
#include "xrds/examination.h"

namespace xrds {

/// What one precision showed.
struct PrecisionExamination {
  bool fp16 = false;
  std::vector<KernelExamination> kernels;
  FrameExamination frame;
};

/// What a usual frame takes of the device's memory.
struct UsualFrame {
  std::string model;  // shipped
  uint32_t width = 0, height = 0;
  uint64_t fp32Bytes = 0, fp16Bytes = 0;
};

/// All that `xrds doctor` knows of a device.
struct Findings {
  Device::Description device;
  DeviceCapabilities capabilities;
  std::vector<PrecisionExamination> precisions;  // fp32, fp16
  std::optional<UsualFrame> usual;               // none without a shipped model
  uint32_t runs = 0;
  std::vector<std::string> tuning{};  // what runs on the device and why, a sentence each
};

/// In plain words, whether the device is trusted and what it lacks.
struct Verdict {
  ExitCode code = ExitCode::ok;  // ok or differs
  std::string sentence;
  std::vector<std::string> failures, degraded;  // one sentence each
};

Verdict judge(const Findings& findings);

}  // namespace xrds
