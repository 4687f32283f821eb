#include "tests/faults/faults.h"

#include <cstdlib>
#include <fstream>
#include <mutex>
#include <sstream>
#include <string>
#include <vector>

namespace xrds::test {
namespace {

struct Rule {
  std::string function;
  unsigned first = 1, count = 1;
  int result = 0;
  unsigned calls = 0;
};

std::vector<Rule> parseRules() {
  const char* text = std::getenv("XRDS_FAULTS");
  std::vector<Rule> rules;
  std::stringstream stream(text ? text : "");
  for (std::string part; std::getline(stream, part, ',');) {
    Rule rule;
    std::stringstream fields(part);
    std::getline(fields, rule.function, ':');
    char colon = 0;
    fields >> rule.first >> colon >> rule.count >> colon >> rule.result;
    rules.push_back(rule);
  }
  return rules;
}

void note(std::string_view function) {
  if (const char* path = std::getenv("XRDS_FAULTS_LOG")) std::ofstream(path, std::ios::app) << function << '\n';
}

}  // namespace

std::optional<VkResult> faultOf(std::string_view function) {
  static std::mutex mutex;
  static std::vector<Rule> rules = parseRules();
  const std::lock_guard lock(mutex);
  const bool hasResult =
      function != "vkCmdDispatch" && function != "vkGetPhysicalDeviceFeatures2" && function != "portability";
  for (Rule& rule : rules) {
    if (rule.function != function && !(rule.function == "any" && hasResult)) continue;
    const unsigned call = ++rule.calls;
    if (call < rule.first || (rule.count != 0 && call >= rule.first + rule.count)) continue;
    if (call == rule.first) note(function);
    return static_cast<VkResult>(rule.result);
  }
  return std::nullopt;
}

}  // namespace xrds::test
