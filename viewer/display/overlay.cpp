#include "viewer/display/overlay.h"

#include <imgui.h>

#include <cmath>

#include "app/skip_map.h"
#include "image/srgb.h"
#include "viewer/display/canvas.h"

namespace xrds {
namespace {

constexpr ImU32 kInk = IM_COL32(235, 235, 235, 255), kPaper = IM_COL32(0, 0, 0, 170);

/// What is said of one side of the picture.
struct Label {
  std::string text;
  View shown = View::output;
  bool hasLegend() const { return isHeatMap() || shown == View::skip; }
  bool isHeatMap() const { return shown == View::error || shown == View::flicker; }
};

// A view's name, with what stands in for it.
Label labelOf(View wanted, View shown) {
  return {wanted == shown ? nameOf(wanted) : std::string(nameOf(shown)) + ", for want of " + nameOf(wanted), shown};
}

struct Entry {
  const char* text;
  ImU32 colour;
};

ImU32 colourOf(float red, float green, float blue) {
  const auto code = [](float linear) { return static_cast<int>(std::lround(255 * srgbFromLinear(linear))); };
  return IM_COL32(code(red), code(green), code(blue), 255);
}

// The tints of windows as they are over a picture of middle grey.
std::array<Entry, 3> skipEntries() {
  const auto tinted = [](SkipMap::Window window) {
    const auto tint = skipTint(window);
    constexpr float kGrey = 0.3F;
    return colourOf(tint[3] * kGrey + tint[0], tint[3] * kGrey + tint[1], tint[3] * kGrey + tint[2]);
  };
  return {{{"computed", tinted(SkipMap::Window::computed)},
           {"interpolated", tinted(SkipMap::Window::interpolated)},
           {"kept", tinted(SkipMap::Window::kept)}}};
}

const char* captionOf(View shown) {
  return shown == View::error ? "relative squared error" : "deviation over the last frames";
}

float legendWidth(const Label& label, float scale) {
  if (label.isHeatMap()) return std::max(170 * scale, ImGui::CalcTextSize(captionOf(label.shown)).x);
  float width = 0;
  for (const Entry& entry : skipEntries()) width += ImGui::CalcTextSize(entry.text).x + 22 * scale;
  return width;
}

Area extentOf(const Label& label, float scale) {
  if (label.text.empty()) return {};
  const float line = ImGui::GetFontSize(), rim = 6 * scale;
  Area area{0, 0, ImGui::CalcTextSize(label.text.c_str()).x, line};
  if (label.hasLegend()) area.width = std::max(area.width, legendWidth(label, scale));
  if (label.isHeatMap()) area.height += 2 * line + 14 * scale;
  if (label.shown == View::skip) area.height += line + 2 * scale;
  return {0, 0, area.width + 2 * rim, area.height + rim};
}

// The heat map's colours from end to end, with the powers of ten that they stand for.
void drawHeatLegend(ImDrawList& list, View shown, const Area& area, float scale) {
  constexpr int kSteps = 64;
  static const Image colours = heatRamp(kSteps);
  const float line = ImGui::GetFontSize(), bar = 10 * scale;
  list.AddText({area.x, area.y}, kInk, shortened(captionOf(shown), area.width).c_str());
  const float top = area.y + line + 2 * scale, step = area.width / kSteps;
  for (int i = 0; i < kSteps; ++i)
    list.AddRectFilled({area.x + step * static_cast<float>(i), top},
                       {area.x + step * static_cast<float>(i + 1), top + bar},
                       colourOf(colours.at(i, 0, 0), colours.at(i, 0, 1), colours.at(i, 0, 2)));
  const bool isError = shown == View::error;
  const int least = static_cast<int>(isError ? shader::kLeastErrorLog10 : shader::kLeastFlickerLog10);
  const int most = static_cast<int>(isError ? shader::kMostErrorLog10 : shader::kMostFlickerLog10);
  for (int power = least; power <= most; ++power) {
    char text[16];
    std::snprintf(text, sizeof text, power == 0 ? "1" : "1e%d", power);
    const float width = ImGui::CalcTextSize(text).x,
                share = static_cast<float>(power - least) / static_cast<float>(most - least);
    list.AddText({area.x + share * (area.width - width), top + bar + scale}, kInk, text);
  }
}

void drawSkipLegend(ImDrawList& list, const Area& area, float scale) {
  const float side = ImGui::GetFontSize() - 2 * scale;
  float x = area.x;
  for (const Entry& entry : skipEntries()) {
    const float width = side + 4 * scale + ImGui::CalcTextSize(entry.text).x;
    if (x + width > area.x + area.width + scale) return;
    list.AddRectFilled({x, area.y + scale}, {x + side, area.y + scale + side}, entry.colour);
    list.AddText({x + side + 4 * scale, area.y}, kInk, entry.text);
    x += width + 5 * scale;
  }
}

void draw(ImDrawList& list, const Label& label, const Area& area, float scale) {
  if (area.height == 0 || area.width <= 0) return;
  const float rim = 6 * scale, line = ImGui::GetFontSize();
  list.AddRectFilled({area.x, area.y}, {area.x + area.width, area.y + area.height}, kPaper, 3 * scale);
  Area inner{area.x + rim, area.y + rim / 2, area.width - 2 * rim, line};
  if (label.isHeatMap()) {
    drawHeatLegend(list, label.shown, inner, scale);
    inner.y += 2 * line + 14 * scale;
  } else if (label.shown == View::skip) {
    drawSkipLegend(list, inner, scale);
    inner.y += line + 2 * scale;
  }
  list.AddText({inner.x, inner.y}, kInk, shortened(label.text, inner.width).c_str());
}

void drawDivider(ImDrawList& list, float x, float height, float scale) {
  list.AddRectFilled({x - 1.5F * scale, 0}, {x + 1.5F * scale, height}, IM_COL32(0, 0, 0, 130));
  list.AddRectFilled({x - 0.5F * scale, 0}, {x + 0.5F * scale, height}, IM_COL32(255, 255, 255, 220));
  list.AddCircleFilled({x, height / 2}, 7 * scale, IM_COL32(0, 0, 0, 150), 24);
  list.AddCircleFilled({x, height / 2}, 5 * scale, IM_COL32(255, 255, 255, 230), 24);
}

// Of what is asked for, before the worker tells more.
std::string firstMessage(const Wanted& wanted) {
  if (!wanted.live.scene.empty()) return "Preparing the scene " + wanted.live.scene + " ...";
  if (!wanted.files.colour.empty()) return "Preparing " + wanted.files.colour.filename().string() + " ...";
  if (!wanted.folder.empty()) return "Looking for EXR files in " + wanted.folder.string() + " ...";
  return "Drop EXR files here, or press Ctrl+O to open some.";
}

// In the middle while there is no picture, else at the top, beside the folded panel.
void drawMessage(const PanelModel& model, float width, float scale, float height) {
  const Report& report = model.report;
  const bool failed = !report.error.empty();
  std::string text = failed ? report.error : report.waiting;
  if (text.empty() && !model.hasPicture) text = firstMessage(model.wanted);
  if (text.empty()) return;
  const float rim = 6 * scale, kept = model.hasPicture ? 90 * scale : 0;
  const float wrap = std::max(60 * scale, std::min(420 * scale, width - 2 * rim - 16 * scale - kept));
  const ImVec2 size = ImGui::CalcTextSize(text.c_str(), nullptr, false, wrap);
  ImVec2 at{8 * scale + rim, 8 * scale + rim};
  if (!model.hasPicture) at = {std::round((width - size.x) / 2), std::max(at.y, std::round((height - size.y) / 2))};
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  list.AddRectFilled({at.x - rim, at.y - rim}, {at.x + size.x + rim, at.y + size.y + rim}, kPaper, 3 * scale);
  const ImU32 ink = failed ? IM_COL32(255, 115, 102, 255) : kInk;
  list.AddText(ImGui::GetFont(), ImGui::GetFontSize(), at, ink, text.c_str(), nullptr, wrap);
}

}  // namespace

std::string shortened(const std::string& text, float width) {
  const auto fits = [&](const std::string& candidate) { return ImGui::CalcTextSize(candidate.c_str()).x <= width; };
  if (fits(text)) return text;
  // Letters of more bytes than one are kept whole.
  const auto isMiddle = [&](size_t i) {
    return i < text.size() && (static_cast<unsigned char>(text[i]) & 0xc0) == 0x80;
  };
  for (size_t kept = text.size() - 1; kept > 0; --kept) {
    size_t head = kept / 2, tail = text.size() - (kept - kept / 2);
    while (isMiddle(head)) --head;
    while (isMiddle(tail)) ++tail;
    if (const std::string candidate = text.substr(0, head) + "..." + text.substr(tail); fits(candidate))
      return candidate;
  }
  return "...";
}

void drawOverlay(const PanelModel& model, PanelPlace place, float width, float height, float scale, float unit) {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const ViewState& view = model.view;
  if (model.hasPicture) {
    const auto x = std::round(static_cast<float>(view.divider()) / unit);
    if (view.wiping && x >= 0 && x <= width) drawDivider(list, x, height, scale);
    const Label left = view.wiping ? labelOf(view.left, model.shownLeft) : Label{};
    const Label right = labelOf(view.right, model.shownRight);
    const auto areas = placeInCorners(width, height, extentOf(left, scale), extentOf(right, scale), 8 * scale);
    draw(list, left, areas[0], scale);
    draw(list, right, areas[1], scale);
  }
  if (!model.hasPicture || (place != PanelPlace::beside && place != PanelPlace::over))
    drawMessage(model, width, scale, height);
}

}  // namespace xrds
