#include "cli/verdict.h"

#include <algorithm>

#include "cli/table.h"
#include "xrds/precision.h"

namespace xrds {
namespace {

constexpr const char* kTriedDrivers[] = {"llvmpipe Mesa 22.3", "llvmpipe Mesa 25.0", "llvmpipe Mesa 26.1",
                                         "llvmpipe Mesa 26.2", "SwiftShader driver", "NVIDIA 580."};
constexpr uint64_t kUsualTensorTexels = uint64_t{1} << 26;  // what GPUs of computers offer at the least

std::string mebibytes(uint64_t byteSize) { return std::to_string(byteSize >> 20) + " MiB"; }

// What is wrong with a kernel or frame; empty if nothing is.
template <class Examined>
std::string fault(const Examined& examined) {
  if (!examined.finite) return "the result is not finite";
  if (!examined.withinBound())
    return "relative RMS error " + text("%.3g", examined.rms) + ", expected at most " + text("%.3g", examined.rmsBound);
  return examined.repeatable ? "" : "equal runs gave different bits";
}

std::vector<std::string> failuresOf(const PrecisionExamination& precision) {
  std::vector<std::string> failures;
  for (const KernelExamination& kernel : precision.kernels)
    if (const std::string found = fault(kernel); !found.empty())
      failures.push_back("Kernel " + kernel.program + " (" + kernel.node + ", " + kernel.shapes + "): " + found + ".");
  if (const std::string found = fault(precision.frame); !found.empty())
    failures.push_back(std::string("The known frame in ") + precisionName(precision.fp16) + ": " + found + ".");
  return failures;
}

void addMemory(const Findings& findings, std::vector<std::string>& degraded) {
  const uint64_t memory = findings.device.memoryBytes;
  if (!findings.usual || findings.usual->fp32Bytes <= memory) return;
  const UsualFrame& usual = *findings.usual;
  const bool fitsHalf = usual.fp16Bytes <= memory;
  degraded.push_back("A frame of " + std::to_string(usual.width) + " x " + std::to_string(usual.height) + " with " +
                     usual.model + " takes " + mebibytes(usual.fp32Bytes) + " in fp32 and " +
                     mebibytes(usual.fp16Bytes) + " in fp16, but the device has " + mebibytes(memory) +
                     (fitsHalf ? ": use --precision fp16." : ": upscale smaller frames."));
}

std::vector<std::string> degradedFeatures(const Findings& findings) {
  const DeviceCapabilities& can = findings.capabilities;
  const bool software = findings.device.kind == "cpu";
  std::vector<std::string> degraded;
  if (software)
    degraded.emplace_back("It is a software device: all kernels run on the processor, far slower than on a GPU.");
  if (can.kernelFamily == "lane" && !can.int64)
    degraded.emplace_back(
        "Its shaders have no 64-bit integers: the heavy operators run their plain kernels instead of the faster lane "
        "kernels.");
  if (can.kernelFamily == "plain" && !software)
    degraded.emplace_back("All operators run their plain kernels, which are slow on a GPU.");
  if (can.matrixUnits != "none" && !can.matrixTrusted)
    degraded.emplace_back(
        "Its matrix units gave wrong products: fp16 runs the tile kernels instead of the matrix kernels.");
  if (!can.timestamps)
    degraded.emplace_back("It has no timestamps: --profile has nothing to show, and the times here are the host's.");
  if (can.maxTensorTexels < kUsualTensorTexels)
    degraded.push_back("Its kernels read tensors of at most " + std::to_string(can.maxTensorTexels) +
                       " texels: frames are cut into more tiles, or refused if not even the smallest fit.");
  addMemory(findings, degraded);
  if (std::none_of(std::begin(kTriedDrivers), std::end(kTriedDrivers),
                   [&](const char* driver) { return findings.device.driver.starts_with(driver); }))
    degraded.push_back("Its driver, '" + findings.device.driver +
                       "', is not among those that xrds was tried with: what is known of it stands here.");
  return degraded;
}

}  // namespace

Verdict judge(const Findings& findings) {
  Verdict verdict;
  bool fullFails = false;
  size_t kernels = 0;
  for (const PrecisionExamination& precision : findings.precisions) {
    const std::vector<std::string> failures = failuresOf(precision);
    fullFails = fullFails || (!precision.fp16 && !failures.empty());
    kernels += precision.kernels.size();
    verdict.failures.insert(verdict.failures.end(), failures.begin(), failures.end());
  }
  verdict.degraded = degradedFeatures(findings);
  if (verdict.failures.empty()) {
    verdict.sentence = "This device is trusted: all " + std::to_string(kernels) +
                       " kernels and the known frame agree with double precision in fp32 and fp16, and " +
                       std::to_string(findings.runs) + " runs of each gave the same bits.";
    return verdict;
  }
  verdict.code = ExitCode::differs;
  verdict.sentence = fullFails ? "This device is not trusted: update its driver, or choose another with --device."
                               : "This device is trusted in fp32 alone: do not use --precision fp16 on it.";
  return verdict;
}

}  // namespace xrds
