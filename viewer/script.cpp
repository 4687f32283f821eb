#include "viewer/script.h"

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "xrds/error.h"

namespace xrds {

std::vector<ScriptLine> readScript(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw Error("The script '" + file.string() + "' cannot be read.");
  std::vector<ScriptLine> lines;
  std::string text;
  for (int number = 1; std::getline(stream, text); ++number) {
    std::istringstream words(text.substr(0, text.find('#')));
    ScriptLine line{number};
    if (!(words >> line.verb)) continue;
    for (std::string word; words >> word;) line.arguments.push_back(word);
    lines.push_back(std::move(line));
  }
  return lines;
}

Script::Script(std::vector<ScriptLine> lines, std::map<std::string, Verb> verbs)
    : lines_(lines.begin(), lines.end()), verbs_(std::move(verbs)) {
  verbs_["wait"] = {0, [](const auto&) {}};
  verbs_["sleep"] = {1, [this](const auto& arguments) {
                       const auto seconds = std::chrono::duration<double>(std::atof(arguments[0].c_str()));
                       until_ = std::chrono::steady_clock::now() +
                                std::chrono::duration_cast<std::chrono::steady_clock::duration>(seconds);
                     }};
  for (const ScriptLine& line : lines_) {
    const std::string verb = line.verb.starts_with('!') ? line.verb.substr(1) : line.verb;
    const auto found = verbs_.find(verb);
    if (found == verbs_.end())
      throw Error("Line " + std::to_string(line.number) + " of the script has an unknown verb '" + line.verb + "'.");
    const int wanted = found->second.count, given = static_cast<int>(line.arguments.size());
    if (wanted >= 0 ? given != wanted : given < 1)
      throw Error("Line " + std::to_string(line.number) + " of the script gives '" + line.verb + "' " +
                  std::to_string(given) + " arguments, expected " + (wanted < 0 ? "some" : std::to_string(wanted)) +
                  ".");
  }
}

std::optional<double> Script::patience(bool ready) const {
  const double sleep = std::chrono::duration<double>(until_ - std::chrono::steady_clock::now()).count();
  if (sleep > 0) return sleep;
  if (ready || (!lines_.empty() && lines_.front().verb.starts_with('!'))) return 0;
  return std::nullopt;
}

void Script::step(bool ready) {
  if (lines_.empty() || std::chrono::steady_clock::now() < until_) return;
  const bool hasty = lines_.front().verb.starts_with('!');
  if (!ready && !hasty) return;
  const ScriptLine line = lines_.front();
  lines_.pop_front();
  try {
    verbs_.at(hasty ? line.verb.substr(1) : line.verb).action(line.arguments);
  } catch (const Error& failure) {
    throw Error("Line " + std::to_string(line.number) + " of the script: " + failure.what());
  }
}

}  // namespace xrds
