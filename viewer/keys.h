#pragma once

#include <optional>
#include <span>
#include <string>

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
  skip,
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
  reload,
  screenshot,
  save,
};

/// A row of the key table: GLFW's key and modifiers, how they are written, what they do. Of the digits, `key` is that
/// of 1; rows without text are second keys of the row above.
struct KeyBinding {
  int key, modifiers;
  const char* keys;
  const char* text;
  Command command;
};

/// Every key, in the order of the help.
std::span<const KeyBinding> keyBindings();

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
