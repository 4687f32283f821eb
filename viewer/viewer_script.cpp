// What scripts do in the user's place, and what they print.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <system_error>
#include <utility>

#include "viewer/viewer.h"
#include "xrds/error.h"
#include "xrds/path_text.h"

namespace xrds {
namespace fs = std::filesystem;

namespace {

using Words = std::vector<std::string>;

double number(const std::string& text) { return std::atof(text.c_str()); }

// The whole file, or so many bytes of it.
void copyFile(const fs::path& from, const fs::path& to, std::optional<uintmax_t> byteSize = {}) {
  std::error_code failure;
  fs::copy_file(from, to, fs::copy_options::overwrite_existing, failure);
  if (byteSize && !failure) fs::resize_file(to, *byteSize, failure);
  if (failure) throw Error("Cannot copy '" + from.string() + "' to '" + to.string() + "': " + failure.message() + ".");
}

}  // namespace

void Viewer::printReport() {
  swapchain_.wait();
  readProbe();
  std::printf("pictures=%llu files=%s model=%s precision=%s frame=%zu zoom=%g window=%ux%u swapchains=%u compared=%zu",
              static_cast<unsigned long long>(report_.pictures), report_.files.c_str(), report_.model.c_str(),
              precisionName(report_.fp16), playback_.index, view_.viewport.zoom, swapchain_.extent().width,
              swapchain_.extent().height, swapchain_.timesMade(), report_.compared.size());
  if (!report_.onDevice)
    std::printf(" tiles=%u partial=%llu interpolated=%.2f kept=%.2f", report_.tiles,
                static_cast<unsigned long long>(report_.partialPictures), report_.interpolated, report_.kept);
  if (report_.samples > 0) std::printf(" samples=%u", report_.samples);
  if (!report_.denoisedBy.empty()) std::printf(" denoised-by=\"%s\"", report_.denoisedBy.c_str());
  if (report_.merged > 1) std::printf(" merged=%zu", report_.merged);
  for (const PixelProbe::Row& row : probe_.rows)
    std::printf(" %s@%d,%d=%.4g,%.4g,%.4g", row.name.c_str(), probe_.x, probe_.y, row.red, row.green, row.blue);
  if (!report_.error.empty()) std::printf(" error=\"%s\"", report_.error.c_str());
  if (!report_.notice.empty()) std::printf(" notice=\"%s\"", report_.notice.c_str());
  for (const std::string& warning : report_.warnings) std::printf(" warning=\"%s\"", warning.c_str());
  if (!report_.whyNotSkipped.empty()) std::printf(" not-skipped=\"%s\"", report_.whyNotSkipped.c_str());
  if (!report_.waiting.empty()) std::printf(" waiting=\"%s\"", report_.waiting.c_str());
  std::printf("\n");
  std::fflush(stdout);
}

// What has passed since it was printed last.
void Viewer::printClock() {
  const Clocked now{std::chrono::steady_clock::now(), std::clock(), measured_.drawings};
  const Clocked last = std::exchange(clocked_, now);
  const uint64_t drawings = now.drawings - last.drawings;
  std::printf("clock seconds=%.3f processor=%.3f drawings=%llu mean_turn_ms=%.1f longest_turn_ms=%.1f\n",
              std::chrono::duration<double>(now.wall - last.wall).count(),
              static_cast<double>(now.processor - last.processor) / CLOCKS_PER_SEC,
              static_cast<unsigned long long>(drawings),
              1000 * last.turns / std::max<double>(1, static_cast<double>(drawings)), 1000 * last.longestTurn);
  std::fflush(stdout);
}

void Viewer::printTimes() {
  std::printf("times");
  for (const StageTime& time : report_.stages) {
    std::string name = (time.isPart ? "part-" : "") + time.name;
    std::replace(name.begin(), name.end(), ' ', '-');
    std::printf(" %s=%.4f", name.c_str(), time.milliseconds);
  }
  std::printf("\n");
  std::fflush(stdout);
}

Script::Actions Viewer::scriptActions() {
  Script::Actions actions;
  addInputActions(actions);
  addWindowActions(actions);
  addFileActions(actions);
  actions["print"] = [this](const Words&) { printReport(); };
  actions["times"] = [this](const Words&) { printTimes(); };
  actions["clock"] = [this](const Words&) { printClock(); };
  actions["await"] = [this](const Words& words) { awaited_ = static_cast<uint64_t>(number(words[0])); };
  actions["samples"] = [this](const Words& words) { awaitedSamples_ = static_cast<uint32_t>(number(words[0])); };
  return actions;
}

void Viewer::addInputActions(Script::Actions& actions) {
  actions["key"] = [this](const Words& words) {
    const auto press = parseKey(words[0]);
    if (!press) throw Error("There is no key '" + words[0] + "'.");
    pressKey(press->key, press->modifiers);
  };
  actions["move"] = [this](const Words& words) {
    moveCursor(number(words[0]), number(words[1]));
    panel_.pretendMouse(cursorX_, cursorY_, false);
  };
  actions["press"] = [this](const Words&) {
    pressButton(GLFW_MOUSE_BUTTON_LEFT, true);
    panel_.pretendMouse(cursorX_, cursorY_, true);
  };
  actions["release"] = [this](const Words&) {
    pressButton(GLFW_MOUSE_BUTTON_LEFT, false);
    panel_.pretendMouse(cursorX_, cursorY_, false);
  };
  actions["scroll"] = [this](const Words& words) { turnWheel(number(words[0])); };
}

void Viewer::addWindowActions(Script::Actions& actions) {
  actions["size"] = [this](const Words& words) {
    display_.resize(static_cast<int>(number(words[0])), static_cast<int>(number(words[1])));
    needDrawing();
  };
  actions["minimize"] = [this](const Words&) { display_.minimize(); };
  actions["restore"] = [this](const Words&) {
    display_.restore();
    needDrawing();
  };
  actions["lose"] = [this](const Words& words) {
    swapchain_.lose(words[0] == "surface");
    needDrawing();
  };
  actions["screenshot"] = [this](const Words& words) {
    screenshot_ = {pathOf(words[0])};
    needDrawing(1);
  };
}

void Viewer::addFileActions(Script::Actions& actions) {
  actions["drop"] = [this](const Words& words) { events_.drop(words); };
  actions["save"] = [this](const Words& words) { upscaling_->save(pathOf(words[0])); };
  actions["copy"] = [](const Words& words) { copyFile(pathOf(words[0]), pathOf(words[1])); };
  actions["part"] = [](const Words& words) {
    copyFile(pathOf(words[1]), pathOf(words[2]), static_cast<uintmax_t>(std::max(0.0, number(words[0]))));
  };
}

}  // namespace xrds
