#include "viewer/keys.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <map>

namespace xrds {
namespace {

constexpr int kUsedModifiers = GLFW_MOD_SHIFT | GLFW_MOD_CONTROL | GLFW_MOD_ALT;

constexpr KeyBinding kBindings[] = {
    {GLFW_KEY_W, 0, "W", "wipe between two views, or one alone", Command::wipe},
    {GLFW_KEY_COMMA, 0, ", .", "move the divider (or drag it)", Command::wipeLeft},
    {GLFW_KEY_PERIOD, 0, "", "", Command::wipeRight},
    {GLFW_KEY_1, 0, "1 ... 0", "right view: xrds, input, bicubic, demodulated, guided,", Command::showRight},
    {GLFW_KEY_1, GLFW_MOD_SHIFT, "Shift+1 ... 0", "left view:  reference, error, albedo, normal, skip map",
     Command::showLeft},
    {GLFW_KEY_EQUAL, 0, "+ -", "zoom (or turn the wheel)", Command::zoomIn},
    {GLFW_KEY_EQUAL, GLFW_MOD_SHIFT, "", "", Command::zoomIn},
    {GLFW_KEY_KP_ADD, 0, "", "", Command::zoomIn},
    {GLFW_KEY_MINUS, 0, "", "", Command::zoomOut},
    {GLFW_KEY_KP_SUBTRACT, 0, "", "", Command::zoomOut},
    {GLFW_KEY_LEFT, 0, "arrows", "pan (or drag; a live scene with the right button)", Command::panLeft},
    {GLFW_KEY_RIGHT, 0, "", "", Command::panRight},
    {GLFW_KEY_UP, 0, "", "", Command::panUp},
    {GLFW_KEY_DOWN, 0, "", "", Command::panDown},
    {GLFW_KEY_F, 0, "F", "fit the picture into the window", Command::fit},
    {GLFW_KEY_Z, 0, "Z", "one pixel of the display for each of the picture", Command::pixels},
    {GLFW_KEY_E, 0, "E D", "exposure: half a stop brighter, darker", Command::brighter},
    {GLFW_KEY_D, 0, "", "", Command::darker},
    {GLFW_KEY_X, 0, "X", "exposure as rendered", Command::resetExposure},
    {GLFW_KEY_T, 0, "T", "tone curve: sRGB, filmic", Command::curve},
    {GLFW_KEY_M, 0, "M, Shift+M", "next, previous model", Command::nextModel},
    {GLFW_KEY_M, GLFW_MOD_SHIFT, "", "", Command::previousModel},
    {GLFW_KEY_C, 0, "C", "precision: fp32, fp16", Command::precision},
    {GLFW_KEY_K, 0, "K", "skip windows: off, safe, up to the bound in the panel", Command::skip},
    {GLFW_KEY_SPACE, 0, "Space", "play, pause", Command::play},
    {GLFW_KEY_L, 0, "L", "loop", Command::loop},
    {GLFW_KEY_PAGE_UP, 0, "PageUp PageDown", "previous, next frame of a sequence", Command::previousFrame},
    {GLFW_KEY_PAGE_DOWN, 0, "", "", Command::nextFrame},
    {GLFW_KEY_HOME, 0, "Home End", "first, last frame", Command::firstFrame},
    {GLFW_KEY_END, 0, "", "", Command::lastFrame},
    {GLFW_KEY_LEFT, GLFW_MOD_SHIFT, "Shift+arrows", "go round the live scene (or drag)", Command::orbitLeft},
    {GLFW_KEY_RIGHT, GLFW_MOD_SHIFT, "", "", Command::orbitRight},
    {GLFW_KEY_UP, GLFW_MOD_SHIFT, "", "", Command::orbitUp},
    {GLFW_KEY_DOWN, GLFW_MOD_SHIFT, "", "", Command::orbitDown},
    {GLFW_KEY_I, 0, "I O", "closer to it, farther from it", Command::closer},
    {GLFW_KEY_O, 0, "", "", Command::farther},
    {GLFW_KEY_V, 0, "V", "its first view again", Command::startView},
    {GLFW_KEY_N, 0, "N", "next live scene", Command::nextScene},
    {GLFW_KEY_R, 0, "R", "read the files again", Command::reload},
    {GLFW_KEY_S, 0, "S", "screenshot as PNG", Command::screenshot},
    {GLFW_KEY_S, GLFW_MOD_CONTROL, "Ctrl+S", "save the result as EXR", Command::save},
    {GLFW_KEY_P, 0, "P", "panel", Command::panel},
    {GLFW_KEY_H, 0, "H, F1", "this help", Command::help},
    {GLFW_KEY_F1, 0, "", "", Command::help},
    {GLFW_KEY_Q, 0, "Q, Esc", "quit", Command::quit},
    {GLFW_KEY_ESCAPE, 0, "", "", Command::quit},
};

const std::map<std::string, int> kNamedKeys = {
    {"Space", GLFW_KEY_SPACE},   {"Left", GLFW_KEY_LEFT},
    {"Right", GLFW_KEY_RIGHT},   {"Up", GLFW_KEY_UP},
    {"Down", GLFW_KEY_DOWN},     {"PageUp", GLFW_KEY_PAGE_UP},
    {"Home", GLFW_KEY_HOME},     {"PageDown", GLFW_KEY_PAGE_DOWN},
    {"End", GLFW_KEY_END},       {"Escape", GLFW_KEY_ESCAPE},
    {"F1", GLFW_KEY_F1},         {"Plus", GLFW_KEY_EQUAL},
    {"Minus", GLFW_KEY_MINUS},   {"Comma", GLFW_KEY_COMMA},
    {"Period", GLFW_KEY_PERIOD},
};

bool takesDigit(Command command) { return command == Command::showRight || command == Command::showLeft; }

}  // namespace

std::span<const KeyBinding> keyBindings() { return kBindings; }

std::optional<Pressed> commandOf(int key, int modifiers) {
  for (const KeyBinding& binding : kBindings) {
    if ((modifiers & kUsedModifiers) != binding.modifiers) continue;
    if (key == binding.key) return Pressed{binding.command};
    if (takesDigit(binding.command) && key >= GLFW_KEY_0 && key <= GLFW_KEY_9)
      return Pressed{binding.command, (key - GLFW_KEY_1 + 10) % 10};
  }
  return std::nullopt;
}

std::optional<KeyPress> parseKey(const std::string& text) {
  KeyPress press;
  std::string rest = text;
  const auto takes = [&](const char* prefix, int modifier) {
    if (!rest.starts_with(prefix)) return;
    rest = rest.substr(std::string(prefix).size());
    press.modifiers |= modifier;
  };
  takes("Ctrl+", GLFW_MOD_CONTROL);
  takes("Shift+", GLFW_MOD_SHIFT);
  const bool character = rest.size() == 1 && ((rest[0] >= 'A' && rest[0] <= 'Z') || (rest[0] >= '0' && rest[0] <= '9'));
  const auto named = kNamedKeys.find(rest);
  if (!character && named == kNamedKeys.end()) return std::nullopt;
  press.key = character ? rest[0] : named->second;  // GLFW numbers letters and digits as ASCII does
  return press;
}

}  // namespace xrds
