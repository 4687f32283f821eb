#include "viewer/display/file_dialog.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "viewer/display/overlay.h"

namespace xrds {
namespace {

// Where one is; what is typed there is gone to.
void drawPath(FileBrowser& browser) {
  static char text[4096];
  static bool typing = false;
  if (ImGui::Button("up")) browser.goUp();
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1);
  if (!typing) std::snprintf(text, sizeof text, "%s", browser.folder().string().c_str());
  const bool entered = ImGui::InputText("##path", text, sizeof text, ImGuiInputTextFlags_EnterReturnsTrue);
  typing = !entered && ImGui::IsItemActive();
  if (entered) browser.go(text);
}

std::string sizeText(uint64_t byteSize) {
  char text[32];
  if (byteSize < 1000000)
    std::snprintf(text, sizeof text, "%.0f kB", std::ceil(static_cast<double>(byteSize) / 1e3));
  else
    std::snprintf(text, sizeof text, "%.0f MB", static_cast<double>(byteSize) / 1e6);
  return text;
}

// Returns whether the entry was double-clicked.
bool drawEntry(FileBrowser& browser, size_t i, bool scrollThere) {
  const FileBrowser::Entry& entry = browser.entries()[i];
  ImGui::PushID(static_cast<int>(i));
  bool chosen = entry.chosen;
  if (!entry.isFolder) {
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {1, 0});
    if (ImGui::Checkbox("##chosen", &chosen)) browser.moveTo(i), browser.toggle();
    ImGui::PopStyleVar();
    ImGui::SameLine();
  }
  const std::string size = entry.isFolder ? "" : sizeText(entry.byteSize);
  const float sizeWidth = ImGui::CalcTextSize(size.c_str()).x, width = ImGui::GetContentRegionAvail().x;
  const std::string name = shortened(entry.name + (entry.isFolder ? "/" : ""), width - sizeWidth - 8);
  bool taken = false;
  if (ImGui::Selectable((name + "##name").c_str(), i == browser.cursor(), ImGuiSelectableFlags_AllowDoubleClick)) {
    browser.moveTo(i);
    if (ImGui::GetIO().KeyCtrl) browser.toggle();
    taken = ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
  }
  if (scrollThere && i == browser.cursor()) ImGui::SetScrollHereY();
  if (!size.empty() && width > 3 * sizeWidth) {
    ImGui::SameLine(ImGui::GetCursorPosX() + ImGui::GetWindowContentRegionMax().x - sizeWidth - 8);
    ImGui::TextDisabled("%s", size.c_str());
  }
  ImGui::PopID();
  return taken;
}

void drawEntries(FileBrowser& browser, float below) {
  ImGui::BeginChild("entries", {0, -below}, true);
  if (!browser.failure().empty())
    ImGui::TextWrapped("%s", browser.failure().c_str());
  else if (browser.entries().empty())
    ImGui::TextDisabled("No folder and no EXR file is here.");
  const bool moved = browser.takeMoved();
  bool taken = false;
  for (size_t i = 0; i < browser.entries().size(); ++i) taken |= drawEntry(browser, i, moved);
  ImGui::EndChild();
  if (taken) browser.accept();
}

}  // namespace

void drawFileDialog(FileBrowser& browser, float scale) {
  if (!browser.isOpen()) return;
  const ImVec2 area = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({area.x / 2, area.y / 2}, ImGuiCond_Always, {0.5F, 0.5F});
  ImGui::SetNextWindowSize({std::min(620 * scale, area.x - 8 * scale), std::min(460 * scale, area.y - 8 * scale)});
  ImGui::Begin("open", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove);
  drawPath(browser);
  const bool roomy = area.x >= 520 * scale && area.y >= 360 * scale;
  const float line = ImGui::GetTextLineHeightWithSpacing(), button = ImGui::GetFrameHeightWithSpacing();
  drawEntries(browser, button + (roomy ? 2 * line : 0));
  if (roomy) {
    ImGui::TextDisabled("Colour, auxiliary images and reference: choose several with Space or the boxes.");
    ImGui::TextDisabled("Enter opens, Backspace goes up, a letter jumps, Ctrl+Enter watches the folder.");
  }
  if (browser.isOpen()) {
    if (ImGui::Button("open")) browser.accept();
    ImGui::SameLine();
    if (ImGui::Button("watch folder")) browser.takeFolder();
    ImGui::SameLine();
    if (ImGui::Button("cancel")) browser.close();
  }
  ImGui::End();
}

}  // namespace xrds
