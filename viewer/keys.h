#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace xrds {

/// What a key does.
enum class Command : uint8_t {
  quit,
  help,
  panel,
  wipe,
  wipeLeft,
  wipeRight,
  showRight,  // a view, by the key's digit; 0 is the tenth
  showLeft,
  flickerRight,
  flickerLeft,
  denoisedRight,
  denoisedLeft,
  zoomIn,
  zoomOut,
  fit,
  pixels,
  panLeft,
  panRight,
  panUp,
  panDown,
  brighter,
  darker,
  resetExposure,
  curve,
  nextModel,
  previousModel,
  precision,
  denoiseFirst,
  skip,
  temporal,
  play,
  loop,
  nextFrame,
  previousFrame,
  firstFrame,
  lastFrame,
  orbitLeft,
  orbitRight,
  orbitUp,
  orbitDown,
  closer,
  farther,
  startView,
  nextScene,
  openFiles,
  reload,
  screenshot,
  save,
};

/// A key, as GLFW numbers it, with modifiers, and what it does. Of the digits it is that of 1, for all.
struct KeyMeaning {
  int key, modifiers;
  Command command;
};

/// A row of the help: how keys are written, what they do, and which they are.
struct KeyBinding {
  const char* keys;
  const char* text;
  std::vector<KeyMeaning> meanings;
};

/// Every key, in the order of the help.
const std::vector<KeyBinding>& keyBindings();

/// What a key that was pressed means; `digit` is 0 to 9 for the views.
struct Pressed {
  Command command;
  int digit = 0;
};
std::optional<Pressed> commandOf(int key, int modifiers);

/// A key and its modifiers as scripts write them: "W", "Shift+2", "Ctrl+S", "Space", "F1", "Right", "PageDown", "Plus".
struct KeyPress {
  int key = 0, modifiers = 0;
};
/// Nothing if the text names no key.
std::optional<KeyPress> parseKey(const std::string& text);

}  // namespace xrds
