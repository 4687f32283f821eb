#include "viewer/tracer/built_in.h"

#include <algorithm>
#include <utility>

#include "xrds/error.h"

namespace xrds {
namespace {

using Make = TraceScene (*)();
constexpr std::pair<const char*, Make> kScenes[] = {
    {"room", makeRoom}, {"garden", makeGarden}, {"spheres", makeSpheres}};

}  // namespace

const std::vector<std::string>& builtInSceneNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> found;
    for (const auto& [name, make] : kScenes) found.emplace_back(name);
    return found;
  }();
  return names;
}

TraceScene builtInScene(const std::string& name) {
  for (const auto& [known, make] : kScenes)
    if (name == known) return make();
  std::string list;
  for (const std::string& known : builtInSceneNames()) list += (list.empty() ? "" : ", ") + known;
  throw Error("There is no built-in scene '" + name + "'; there are " + list + ".");
}

}  // namespace xrds
