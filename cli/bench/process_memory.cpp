#include "cli/bench/process_memory.h"

#include <fstream>
#include <string>

namespace xrds {

bool resetPeakMemory() {
  std::ofstream file("/proc/self/clear_refs");
  file << "5" << std::flush;
  return file.good();
}

std::optional<uint64_t> peakMemory() {
  std::ifstream file("/proc/self/status");
  for (std::string word; file >> word;)
    if (uint64_t kilobytes = 0; word == "VmHWM:" && file >> kilobytes) return kilobytes * 1024;
  return {};
}

}  // namespace xrds
