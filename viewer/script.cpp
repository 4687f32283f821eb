#include "viewer/script.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

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
  if (stream.bad()) throw Error("The script '" + file.string() + "' cannot be read.");  // a folder, say
  return lines;
}

Script::Script(std::vector<ScriptLine> lines, const std::vector<ScriptVerb>& verbs, Actions actions)
    : lines_(lines.begin(), lines.end()), actions_(std::move(actions)) {
  actions_["wait"] = [](const auto&) {};
  actions_["sleep"] = [this](const auto& arguments) {
    const auto seconds = std::chrono::duration<double>(std::atof(arguments[0].c_str()));
    until_ =
        std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(seconds);
  };
  for (const ScriptVerb& verb : verbs)
    if (!actions_.contains(verb.word))
      throw std::logic_error(std::string("The step '") + verb.word + "' has no action.");
  for (ScriptLine& line : lines_) {
    const std::string word = line.verb.starts_with('!') ? line.verb.substr(1) : line.verb;
    const std::string where = "Line " + std::to_string(line.number) + " of the script ";
    const auto verb = std::find_if(verbs.begin(), verbs.end(), [&](const ScriptVerb& v) { return v.word == word; });
    if (verb == verbs.end())
      throw Error(where + "has an unknown step '" + line.verb + "': xrds view --help lists all.");
    if (verb->atOnce) line.verb = "!" + word;
    const int wanted = verb->argumentCount(), given = static_cast<int>(line.arguments.size());
    if (wanted >= 0 ? given != wanted : given < 1)
      throw Error(where + "gives '" + line.verb + "' " + std::to_string(given) + " arguments, expected " +
                  (*verb->arguments ? verb->arguments : "none") + ".");
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
    actions_.at(hasty ? line.verb.substr(1) : line.verb)(line.arguments);
  } catch (const Error& failure) {
    throw Error("Line " + std::to_string(line.number) + " of the script: " + failure.what());
  }
}

}  // namespace xrds
