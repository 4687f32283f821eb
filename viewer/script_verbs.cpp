#include "viewer/script_verbs.h"

#include <algorithm>
#include <sstream>

namespace xrds {

int ScriptVerb::argumentCount() const {
  int count = 0;
  std::istringstream words(arguments);
  for (std::string word; words >> word; ++count)
    if (word == "...") return -1;
  return count;
}

const std::vector<ScriptVerb>& scriptVerbs() {
  static const std::vector<ScriptVerb> verbs{
      {"wait", "", "do nothing but wait, as every step does"},
      {"sleep", "SECONDS", "wait so long"},
      {"await", "N", "wait for N upscaled pictures since the start"},
      {"samples", "N", "from here on wait for N samples a pixel of a live scene, not for all (0: for all)", true},
      {"key", "KEY", "press a key: W, Shift+2, Ctrl+S, Space, Left, PageDown, Enter, Backspace, F1, Plus, Comma"},
      {"move", "X Y", "move the mouse there, in pixels of the window"},
      {"press", "", "press the left mouse button"},
      {"release", "", "release it"},
      {"scroll", "STEPS", "turn the wheel; a negative number zooms out"},
      {"drop", "FILE ...", "drop files or a folder into the window"},
      {"size", "WIDTH HEIGHT", "give the window another size"},
      {"minimize", "", "minimize the window"},
      {"restore", "", "bring it back"},
      {"screenshot", "PNG", "write what the window shows"},
      {"save", "EXR", "write the upscaled picture"},
      {"print", "", "print what is shown, the pixel under the mouse, errors, notices and warnings, in one line"},
      {"times", "", "print what each stage of the last picture took, in ms, in one line"},
      {"clock", "", "print time, processor time and turns since the last clock"},
      {"copy", "FROM TO", "copy a file, in a renderer's place"},
      {"part", "BYTES FROM TO", "copy the beginning of a file, in the place of a renderer that still writes"},
      {"lose", "WHAT", "lose the window's images (swapchain) or its surface (surface), for tests"},
  };
  return verbs;
}

std::string scriptHelp() {
  std::string text =
      "Steps of a --script, one a line, '#' begins a comment. Each waits until the picture is what the steps before "
      "it\n"
      "asked for, but samples; a ! before the word takes it at once.\n";
  size_t widest = 0;
  const auto usage = [](const ScriptVerb& verb) {
    return std::string(verb.word) + (*verb.arguments ? " " : "") + verb.arguments;
  };
  for (const ScriptVerb& verb : scriptVerbs()) widest = std::max(widest, usage(verb).size());
  for (const ScriptVerb& verb : scriptVerbs()) {
    const std::string written = usage(verb);
    text += "  " + written + std::string(widest + 2 - written.size(), ' ') + verb.text + "\n";
  }
  return text;
}

}  // namespace xrds
