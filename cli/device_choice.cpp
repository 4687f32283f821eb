#include "cli/device_choice.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <vector>

#include "app/failing_with.h"
#include "cli/progress.h"

namespace xrds {
namespace {

/// A device as Device::Options::select takes it, and its name for messages.
struct Candidate {
  std::string select, name;
  size_t rank = 0;
};

// In the order in which Device itself would choose.
std::vector<Candidate> bestFirst(const std::vector<Device::Description>& devices) {
  static constexpr const char* kKinds[] = {"discrete", "integrated", "virtual", "cpu", "other"};
  std::vector<Candidate> candidates;
  for (size_t i = 0; i < devices.size(); ++i) {
    const auto kind = std::find(std::begin(kKinds), std::end(kKinds), devices[i].kind);
    candidates.push_back({std::to_string(i), devices[i].name, static_cast<size_t>(kind - std::begin(kKinds))});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.rank < b.rank; });
  return candidates;
}

void runOn(const std::string& select, bool quiet, const std::function<void(Device&)>& work) {
  failingWith(ExitCode::device, [&] {
    std::optional<EndsAtOnce> endsAtOnce(std::in_place);
    const auto device = openDevice(select, quiet);
    endsAtOnce.reset();
    printNotes(*device);
    untilInterrupted([&] { work(*device); });
  });
}

}  // namespace

std::unique_ptr<Device> openDevice(const std::string& select, bool quiet) {
  const auto line = std::make_shared<PreparationLine>(quiet);
  return untilInterrupted([&] {
    return std::make_unique<Device>(Device::Options{
        .select = select, .onPreparation = [line](const Preparation& now) { return line->update(now); }});
  });
}

void printNotes(const Device& device) {
  for (const std::string& note : device.notes()) std::fprintf(stderr, "xrds: warning: %s.\n", note.c_str());
}

void onDevice(const std::string& select, bool quiet, const std::function<void(Device&)>& work) {
  std::vector<Candidate> candidates{{select, "", 0}};
  if (select.empty()) {
    const auto devices = failingWith(ExitCode::device, [] { return Device::list(); });
    if (devices.size() > 1) candidates = bestFirst(devices);
  }
  for (size_t i = 0; i + 1 < candidates.size(); ++i) try {
      return runOn(candidates[i].select, quiet, work);
    } catch (const Failure& failure) {
      if (failure.code != ExitCode::device) throw;
      std::fprintf(stderr, "xrds: warning: device %s (%s) failed: %s; continuing on device %s (%s).\n",
                   candidates[i].select.c_str(), candidates[i].name.c_str(), failure.message.c_str(),
                   candidates[i + 1].select.c_str(), candidates[i + 1].name.c_str());
    }
  runOn(candidates.back().select, quiet, work);
}

std::string usualKernelFamily() {
  std::vector<Device::Description> devices;
  try {
    devices = Device::list();
  } catch (const Error&) {  // no Vulkan
  }
  if (devices.empty()) return "tile";
  return devices[std::stoul(bestFirst(devices).front().select)].kernelFamily;
}

}  // namespace xrds
