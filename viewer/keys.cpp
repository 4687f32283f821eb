#include "viewer/keys.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <map>

namespace xrds {
namespace {

constexpr int kUsedModifiers = GLFW_MOD_SHIFT | GLFW_MOD_CONTROL | GLFW_MOD_ALT;

const std::vector<KeyBinding> kBindings{
    {"W", "wipe between two views, or one alone", {{GLFW_KEY_W, 0, Command::wipe}}},
    {", .",
     "move the divider (or drag it)",
     {{GLFW_KEY_COMMA, 0, Command::wipeLeft}, {GLFW_KEY_PERIOD, 0, Command::wipeRight}}},
    {"1 ... 0",
     "right view: xrds, input, bicubic, demodulated, guided,\nreference, error, albedo, normal, skip map",
     {{GLFW_KEY_1, 0, Command::showRight}}},
    {"Shift+1 ... 0", "left view, in the same order", {{GLFW_KEY_1, GLFW_MOD_SHIFT, Command::showLeft}}},
    {"Y, Shift+Y",
     "right, left view: flicker",
     {{GLFW_KEY_Y, 0, Command::flickerRight}, {GLFW_KEY_Y, GLFW_MOD_SHIFT, Command::flickerLeft}}},
    {"J, Shift+J",
     "right, left view: the full-resolution render,\ndenoised by Open Image Denoise's networks",
     {{GLFW_KEY_J, 0, Command::denoisedRight}, {GLFW_KEY_J, GLFW_MOD_SHIFT, Command::denoisedLeft}}},
    {"+ -",
     "zoom (or turn the wheel)",
     {{GLFW_KEY_EQUAL, 0, Command::zoomIn},
      {GLFW_KEY_EQUAL, GLFW_MOD_SHIFT, Command::zoomIn},
      {GLFW_KEY_KP_ADD, 0, Command::zoomIn},
      {GLFW_KEY_MINUS, 0, Command::zoomOut},
      {GLFW_KEY_KP_SUBTRACT, 0, Command::zoomOut}}},
    {"arrows",
     "pan (or drag; a live scene with the right button)",
     {{GLFW_KEY_LEFT, 0, Command::panLeft},
      {GLFW_KEY_RIGHT, 0, Command::panRight},
      {GLFW_KEY_UP, 0, Command::panUp},
      {GLFW_KEY_DOWN, 0, Command::panDown}}},
    {"F", "fit the picture into the window", {{GLFW_KEY_F, 0, Command::fit}}},
    {"Z", "one pixel of the display for each of the picture", {{GLFW_KEY_Z, 0, Command::pixels}}},
    {"E D",
     "exposure: half a stop brighter, darker",
     {{GLFW_KEY_E, 0, Command::brighter}, {GLFW_KEY_D, 0, Command::darker}}},
    {"X", "exposure as rendered", {{GLFW_KEY_X, 0, Command::resetExposure}}},
    {"T", "tone curve: sRGB, filmic", {{GLFW_KEY_T, 0, Command::curve}}},
    {"M, Shift+M",
     "next, previous model",
     {{GLFW_KEY_M, 0, Command::nextModel}, {GLFW_KEY_M, GLFW_MOD_SHIFT, Command::previousModel}}},
    {"C", "precision: fp32, fp16", {{GLFW_KEY_C, 0, Command::precision}}},
    {"B",
     "all images through Open Image Denoise's networks\nbefore the network, or not",
     {{GLFW_KEY_B, 0, Command::denoiseFirst}}},
    {"K", "skip windows: off, safe, up to the bound in the panel", {{GLFW_KEY_K, 0, Command::skip}}},
    {"A",
     "frames merged with those around them, or not\n(live: with what was shown before)",
     {{GLFW_KEY_A, 0, Command::temporal}}},
    {"Space", "play, pause", {{GLFW_KEY_SPACE, 0, Command::play}}},
    {"L", "loop", {{GLFW_KEY_L, 0, Command::loop}}},
    {"PageUp PageDown",
     "previous, next frame of a sequence",
     {{GLFW_KEY_PAGE_UP, 0, Command::previousFrame}, {GLFW_KEY_PAGE_DOWN, 0, Command::nextFrame}}},
    {"Home End", "first, last frame", {{GLFW_KEY_HOME, 0, Command::firstFrame}, {GLFW_KEY_END, 0, Command::lastFrame}}},
    {"Shift+arrows",
     "go round the live scene (or drag)",
     {{GLFW_KEY_LEFT, GLFW_MOD_SHIFT, Command::orbitLeft},
      {GLFW_KEY_RIGHT, GLFW_MOD_SHIFT, Command::orbitRight},
      {GLFW_KEY_UP, GLFW_MOD_SHIFT, Command::orbitUp},
      {GLFW_KEY_DOWN, GLFW_MOD_SHIFT, Command::orbitDown}}},
    {"I O", "closer to it, farther from it", {{GLFW_KEY_I, 0, Command::closer}, {GLFW_KEY_O, 0, Command::farther}}},
    {"V", "its first view again", {{GLFW_KEY_V, 0, Command::startView}}},
    {"N", "next live scene", {{GLFW_KEY_N, 0, Command::nextScene}}},
    {"Ctrl+O", "open files", {{GLFW_KEY_O, GLFW_MOD_CONTROL, Command::openFiles}}},
    {"R", "read the files again", {{GLFW_KEY_R, 0, Command::reload}}},
    {"S", "screenshot as PNG", {{GLFW_KEY_S, 0, Command::screenshot}}},
    {"Ctrl+S", "save the result as EXR", {{GLFW_KEY_S, GLFW_MOD_CONTROL, Command::save}}},
    {"P", "panel", {{GLFW_KEY_P, 0, Command::panel}}},
    {"H, F1", "this help", {{GLFW_KEY_H, 0, Command::help}, {GLFW_KEY_F1, 0, Command::help}}},
    {"Q, Esc", "quit", {{GLFW_KEY_Q, 0, Command::quit}, {GLFW_KEY_ESCAPE, 0, Command::quit}}},
};

const std::map<std::string, int> kNamedKeys = {
    {"Space", GLFW_KEY_SPACE},
    {"Left", GLFW_KEY_LEFT},
    {"Right", GLFW_KEY_RIGHT},
    {"Up", GLFW_KEY_UP},
    {"Down", GLFW_KEY_DOWN},
    {"PageUp", GLFW_KEY_PAGE_UP},
    {"Home", GLFW_KEY_HOME},
    {"PageDown", GLFW_KEY_PAGE_DOWN},
    {"End", GLFW_KEY_END},
    {"Escape", GLFW_KEY_ESCAPE},
    {"F1", GLFW_KEY_F1},
    {"Plus", GLFW_KEY_EQUAL},
    {"Minus", GLFW_KEY_MINUS},
    {"Comma", GLFW_KEY_COMMA},
    {"Period", GLFW_KEY_PERIOD},
    {"Enter", GLFW_KEY_ENTER},
    {"Backspace", GLFW_KEY_BACKSPACE},
};

bool takesDigit(Command command) { return command == Command::showRight || command == Command::showLeft; }

}  // namespace

const std::vector<KeyBinding>& keyBindings() { return kBindings; }

std::optional<Pressed> commandOf(int key, int modifiers) {
  const bool isDigit = key >= GLFW_KEY_0 && key <= GLFW_KEY_9;
  for (const KeyBinding& binding : kBindings)
    for (const KeyMeaning& meaning : binding.meanings) {
      if ((modifiers & kUsedModifiers) != meaning.modifiers) continue;
      if (takesDigit(meaning.command) && isDigit) return Pressed{meaning.command, (key - GLFW_KEY_1 + 10) % 10};
      if (key == meaning.key) return Pressed{meaning.command};
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
