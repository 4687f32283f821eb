#include "cli/doctor_report.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "cli/device_json.h"
#include "cli/json_text.h"
#include "cli/table.h"
#include "xrds/precision.h"

namespace xrds {
namespace {

using Json = nlohmann::ordered_json;

/// The examinations of one program: the worst error, and the sum of their times.
struct ProgramSum {
  int kernels = 0;
  double rms = 0, bound = 0, microseconds = 0;
  bool right = true, repeatable = true;
};

std::map<std::string, ProgramSum> byProgram(const std::vector<KernelExamination>& kernels) {
  std::map<std::string, ProgramSum> sums;
  for (const KernelExamination& kernel : kernels) {
    ProgramSum& sum = sums[kernel.program];
    ++sum.kernels;
    sum.rms = std::max(sum.rms, kernel.rms);
    sum.bound = kernel.rmsBound;
    sum.microseconds += kernel.microseconds;
    sum.right = sum.right && kernel.withinBound();
    sum.repeatable = sum.repeatable && kernel.repeatable;
  }
  return sums;
}

std::string resultText(bool right, bool repeatable) { return !right ? "WRONG" : repeatable ? "right" : "CHANGES"; }

std::string kernelTable(const Findings& findings) {
  std::vector<Row> rows{{"kernel", "shapes", "rel. RMS error", "bound", "microseconds", "result"}};
  for (const PrecisionExamination& precision : findings.precisions) {
    for (const auto& [program, sum] : byProgram(precision.kernels))
      rows.push_back({program, std::to_string(sum.kernels), text("%.2g", sum.rms), text("%.0e", sum.bound),
                      text("%.0f", sum.microseconds), resultText(sum.right, sum.repeatable)});
    const FrameExamination& frame = precision.frame;
    rows.push_back({"known frame, " + std::string(precisionName(precision.fp16)),
                    std::to_string(frame.width) + "x" + std::to_string(frame.height), text("%.2g", frame.rms),
                    text("%.0e", frame.rmsBound), text("%.0f", frame.microseconds),
                    resultText(frame.withinBound(), frame.repeatable)});
  }
  return aligned(rows);
}

std::string listed(const char* title, const std::vector<std::string>& sentences) {
  if (sentences.empty()) return "";
  std::string lines = std::string("\n") + title + ":\n";
  for (const std::string& sentence : sentences) lines += "- " + sentence + "\n";
  return lines;
}

Json jsonOf(const KernelExamination& kernel, bool fp16) {
  return {{"program", kernel.program},
          {"precision", precisionName(fp16)},
          {"node", kernel.node},
          {"shapes", kernel.shapes},
          {"relativeRms", kernel.rms},
          {"relativeRmsBound", kernel.rmsBound},
          {"relativeMax", kernel.max},
          {"relativeMaxBound", kernel.maxBound},
          {"finite", kernel.finite},
          {"withinBound", kernel.withinBound()},
          {"repeatable", kernel.repeatable},
          {"microseconds", kernel.microseconds}};
}

Json jsonOf(const FrameExamination& frame, bool fp16) {
  return {{"precision", precisionName(fp16)},
          {"width", frame.width},
          {"height", frame.height},
          {"relativeRms", frame.rms},
          {"relativeRmsBound", frame.rmsBound},
          {"finite", frame.finite},
          {"withinBound", frame.withinBound()},
          {"repeatable", frame.repeatable},
          {"microseconds", frame.microseconds}};
}

}  // namespace

std::string doctorText(const Findings& findings, const Verdict& verdict) {
  const Device::Description& device = findings.device;
  const DeviceCapabilities& can = findings.capabilities;
  std::string lines =
      device.name + " (" + device.kind + ", Vulkan " + device.apiVersion + ", " +
      text("%.1f GiB", static_cast<double>(device.memoryBytes) / (1 << 30)) + ")\n  driver " + device.driver +
      "\n  kernels of the " + can.kernelFamily + " family, subgroups of " + std::to_string(can.subgroupSize) +
      ", bindings of at most " + std::to_string(can.maxBindingBytes >> 20) + " MiB, matrix units: " + can.matrixUnits +
      ", 64-bit integers: " + (can.int64 ? "yes" : "no") + ", timestamps: " + (can.timestamps ? "yes" : "no") + "\n\n";
  lines += kernelTable(findings);
  lines += "\nEach ran " + std::to_string(findings.runs) +
           " times; errors are against double precision, times those of the fastest runs.\n";
  lines += listed("Kernels", findings.tuning);
  lines += listed("Wrong", verdict.failures) + listed("Degraded", verdict.degraded);
  return lines + "\n" + verdict.sentence + "\n";
}

std::string doctorJson(const Findings& findings, const Verdict& verdict) {
  const Device::Description& device = findings.device;
  const DeviceCapabilities& can = findings.capabilities;
  Json json{{"version", XRDS_VERSION}, {"runs", findings.runs}};
  json["device"] = jsonOf(device);
  json["capabilities"] = {{"kernelFamily", can.kernelFamily},
                          {"matrixUnits", can.matrixUnits},
                          {"matrixTrusted", can.matrixTrusted},
                          {"subgroupSize", can.subgroupSize},
                          {"int64", can.int64},
                          {"timestamps", can.timestamps},
                          {"maxBindingBytes", can.maxBindingBytes},
                          {"maxTensorTexels", can.maxTensorTexels}};
  for (const PrecisionExamination& precision : findings.precisions) {
    for (const auto& kernel : precision.kernels) json["kernels"].push_back(jsonOf(kernel, precision.fp16));
    json["knownFrames"].push_back(jsonOf(precision.frame, precision.fp16));
  }
  if (findings.usual)
    json["usualFrame"] = {{"model", findings.usual->model},
                          {"width", findings.usual->width},
                          {"height", findings.usual->height},
                          {"fp32Bytes", findings.usual->fp32Bytes},
                          {"fp16Bytes", findings.usual->fp16Bytes}};
  json["tuning"] = findings.tuning;
  json["trusted"] = verdict.code == ExitCode::ok;
  json["verdict"] = verdict.sentence;
  json["failures"] = verdict.failures;
  json["degraded"] = verdict.degraded;
  return textOf(json);
}

}  // namespace xrds
