#include "viewer/display/panel_parts.h"

#include <imgui.h>

#include <cstdio>

#include "viewer/display/overlay.h"

namespace xrds {
namespace {

const ImVec4 kWarning{1.0F, 0.75F, 0.35F, 1};
const ImVec4 kFailure{1.0F, 0.45F, 0.40F, 1};

void heading(const char* text) {
  ImGui::Spacing();
  ImGui::TextDisabled("%s", text);
  ImGui::Separator();
}

void row(const char* name, const char* format, ...) IM_FMTARGS(2);
void row(const char* name, const char* format, ...) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(name);
  ImGui::TableNextColumn();
  va_list arguments;
  va_start(arguments, format);
  char text[160];
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  const float indent = ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize(text).x;
  if (indent > 0) ImGui::SetCursorPosX(ImGui::GetCursorPosX() + indent);
  ImGui::TextUnformatted(text);
}

bool beginRows(const char* name) {
  if (!ImGui::BeginTable(name, 2, ImGuiTableFlags_SizingStretchProp | ImGuiTableFlags_NoPadOuterX)) return false;
  ImGui::TableSetupColumn("what", ImGuiTableColumnFlags_WidthStretch, 0.6F);
  ImGui::TableSetupColumn("how much", ImGuiTableColumnFlags_WidthStretch, 0.4F);
  return true;
}

void paragraph(const std::string& text, const ImVec4& colour) {
  ImGui::PushStyleColor(ImGuiCol_Text, colour);
  ImGui::TextWrapped("%s", text.c_str());
  ImGui::PopStyleColor();
}

void drawState(const Report& report) {
  if (!report.error.empty())
    paragraph(report.error, kFailure);
  else if (!report.waiting.empty())
    paragraph(report.waiting, kWarning);
}

void drawSource(PanelModel& model) {
  const Report& report = model.report;
  heading("SOURCE");
  if (report.files.empty())
    ImGui::TextWrapped("Drop EXR files here, or open them:");
  else
    ImGui::TextUnformatted(shortened(report.files, ImGui::GetContentRegionAvail().x).c_str());
  if (ImGui::IsItemHovered() && !report.files.empty()) ImGui::SetTooltip("%s", report.files.c_str());
  if (ImGui::Button("open ... (Ctrl+O)")) model.perform(Command::openFiles);
  if (report.width > 0)
    ImGui::Text("%u x %u  to  %u x %u", report.width, report.height, report.scale * report.width,
                report.scale * report.height);
  if (report.samples > 0) ImGui::Text("%u samples a pixel", report.samples);
  Playback& playback = model.playback;
  if (playback.frames || !model.wanted.live.scene.empty()) {
    ImGui::Checkbox("merge frames (A)", &model.wanted.temporal);
    if (report.merged > 1) {
      ImGui::SameLine();
      ImGui::TextDisabled("of %zu", report.merged);
    }
  }
  if (!playback.frames) return;
  if (ImGui::Button(playback.playing ? "pause" : "play")) model.perform(Command::play);
  ImGui::SameLine();
  ImGui::Checkbox("loop", &playback.looping);
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1);
  ImGui::DragFloat("##fps", &playback.framesPerSecond, 0.25F, 1, 120, "%.0f fps", ImGuiSliderFlags_AlwaysClamp);
  int index = static_cast<int>(playback.index);
  ImGui::SetNextItemWidth(-1);
  char format[32];
  std::snprintf(format, sizeof format, "frame %%d of %zu", playback.count());
  ++index;
  if (ImGui::SliderInt("##frame", &index, 1, static_cast<int>(playback.count()), format)) {
    playback.index = static_cast<size_t>(index - 1);
    playback.playing = false;
  }
}

void drawSkip(PanelModel& model) {
  using Mode = SkipChoice::Mode;
  SkipChoice& skip = model.wanted.skip;
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted("skip");
  for (const auto& [name, mode] : {std::pair{"off", Mode::off}, {"safe", Mode::safe}, {"##bound", Mode::bounded}}) {
    ImGui::SameLine();
    if (ImGui::RadioButton(name, skip.mode == mode)) skip.mode = mode;
  }
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1);
  constexpr ImGuiSliderFlags kFlags = ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_Logarithmic;
  if (ImGui::DragFloat("##skip", &skip.bounded, 0.001F, 0.001F, 1, "%.3f", kFlags)) skip.mode = Mode::bounded;
  const Report& report = model.report;
  if (!report.whyNotSkipped.empty())
    paragraph("Nothing is skipped: this model " + report.whyNotSkipped + ".", kWarning);
  else if (skip.mode != Mode::off && !report.onDevice)
    ImGui::Text("%.0f %% interpolated, %.0f %% kept", 100 * report.interpolated, 100 * report.kept);
  if (report.tiles > 1) ImGui::Text("in %u tiles", report.tiles);
  if (!report.onDevice) ImGui::TextDisabled("pictures pass through the host");
}

void drawDenoiseFirst(PanelModel& model) {
  Wanted& wanted = model.wanted;
  ImGui::Checkbox("denoise first (B)", &wanted.denoiseFirst);
  if (!model.report.denoisedBy.empty() && ImGui::IsItemHovered())
    ImGui::SetTooltip("%s", model.report.denoisedBy.c_str());
  if (!wanted.denoiseFirst || !wanted.live.scene.empty()) return;
  ImGui::SameLine();
  ImGui::Checkbox("clean guides", &wanted.cleanGuides);
}

void drawModel(PanelModel& model) {
  heading("NETWORK");
  const Report& report = model.report;
  const std::string current = !model.wanted.model.empty() ? model.wanted.model : report.model;
  ImGui::SetNextItemWidth(-1);
  const float room = ImGui::GetContentRegionAvail().x - 2 * ImGui::GetFrameHeight();
  if (ImGui::BeginCombo("##model", current.empty() ? "by scale" : shortened(current, room).c_str())) {
    for (const std::string& name : model.models)
      if (ImGui::Selectable(name.c_str(), name == current)) model.wanted.model = name;
    ImGui::EndCombo();
  }
  if (ImGui::RadioButton(kFp32, !model.wanted.fp16)) model.wanted.fp16 = false;
  ImGui::SameLine();
  if (ImGui::RadioButton(kFp16, model.wanted.fp16)) model.wanted.fp16 = true;
  if (report.share < 1) {
    ImGui::SameLine();
    ImGui::ProgressBar(static_cast<float>(report.share), {-1, 0});
  }
  drawDenoiseFirst(model);
  drawSkip(model);
}

void viewCombo(const char* label, View& view) {
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x * 0.75F);
  if (!ImGui::BeginCombo(label, nameOf(view))) return;
  for (size_t i = 0; i < kViewNames.size(); ++i)
    if (ImGui::Selectable(kViewNames[i], view == static_cast<View>(i))) view = static_cast<View>(i);
  ImGui::EndCombo();
}

void drawView(PanelModel& model) {
  heading("VIEW");
  ViewState& view = model.view;
  ImGui::BeginDisabled(!view.wiping);
  viewCombo("left", view.left);
  ImGui::EndDisabled();
  viewCombo("right", view.right);
  ImGui::Checkbox("wipe", &view.wiping);
  ImGui::SameLine();
  if (ImGui::Button("fit")) view.viewport.fit();
  ImGui::SameLine();
  if (ImGui::Button("1:1")) model.perform(Command::pixels);
  ImGui::SameLine();
  ImGui::Text("%.4g %%", 100 * view.viewport.zoom);
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x * 0.62F);
  ImGui::SliderFloat("exposure", &view.stops, -10, 10, "%+.1f stops");
  bool filmic = view.curve == shader::kCurveFilmic;
  if (ImGui::RadioButton("sRGB", !filmic)) view.curve = shader::kCurveSrgb;
  ImGui::SameLine();
  if (ImGui::RadioButton("filmic", filmic)) view.curve = shader::kCurveFilmic;
}

void drawProbe(const PixelProbe& probe) {
  heading("PIXEL");
  if (probe.x < 0) {
    ImGui::TextDisabled("under the cursor");
    ImGui::TextUnformatted(" \n ");
    return;
  }
  ImGui::Text("%d, %d", probe.x, probe.y);
  for (const PixelProbe::Row& found : probe.rows)
    ImGui::Text("%-11s %7.4g %7.4g %7.4g", found.name.c_str(), found.red, found.green, found.blue);
}

void drawMetrics(const Report& report) {
  if (!report.hasReference) return;
  heading("AGAINST THE REFERENCE");
  if (report.compared.empty()) return ImGui::TextDisabled("being measured");
  if (!ImGui::BeginTable("metrics", 4, ImGuiTableFlags_SizingStretchProp | ImGuiTableFlags_NoPadOuterX)) return;
  for (const char* name : {"", "PSNR", "RelMSE", "FLIP"}) {
    ImGui::TableNextColumn();
    ImGui::TextDisabled("%s", name);
  }
  for (const ComparedPicture& picture : report.compared) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(picture.name.c_str());
    ImGui::TableNextColumn();
    ImGui::Text("%.2f", picture.metrics.psnr);
    ImGui::TableNextColumn();
    ImGui::Text("%.3g", picture.metrics.relMse);
    ImGui::TableNextColumn();
    ImGui::Text("%.3f", picture.metrics.flip);
  }
  ImGui::EndTable();
}

void drawTimes(const PanelModel& model) {
  heading("TIMES");
  if (!beginRows("times")) return;
  for (const StageTime& stage : model.report.stages) {
    const bool isTotal = stage.name == kTotalStage;
    if (stage.isPart) ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    row(((stage.isPart ? "  " : "") + stage.name).c_str(), "%.1f ms", stage.milliseconds);
    if (stage.isPart) ImGui::PopStyleColor();
    if (isTotal && model.report.pictures > 1) row("pictures", "%.1f a second", model.report.picturesPerSecond);
  }
  ImGui::EndTable();
  heading("WINDOW");
  if (!beginRows("window")) return;
  row("drawing", "%.1f ms", model.drawMilliseconds);
  row("longest turn", "%.1f ms", model.longestTurnMilliseconds);
  row("device memory", "%.0f MB", static_cast<double>(model.report.deviceBytes) / 1e6);
  ImGui::EndTable();
  paragraph(model.report.device, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
}

void drawNotices(const Report& report) {
  if (!report.notice.empty()) ImGui::TextWrapped("%s", report.notice.c_str());
  for (const std::string& warning : report.warnings) paragraph(warning, kWarning);
}

}  // namespace

void drawPanel(PanelModel& model) {
  drawState(model.report);
  drawSource(model);
  drawModel(model);
  drawView(model);
  drawProbe(model.probe);
  drawMetrics(model.report);
  drawTimes(model);
  drawNotices(model.report);
  ImGui::Spacing();
  if (ImGui::Button("help (H)")) model.perform(Command::help);
  ImGui::SameLine();
  if (ImGui::Button("PNG (S)")) model.perform(Command::screenshot);
  ImGui::SameLine();
  if (ImGui::Button("EXR (Ctrl+S)")) model.perform(Command::save);
}

void drawHelp(ViewState& view, float scale) {
  const ImVec2 area = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({area.x / 2, area.y / 2}, ImGuiCond_Always, {0.5F, 0.5F});
  ImGui::SetNextWindowBgAlpha(0.94F);
  ImGui::SetNextWindowSizeConstraints({0, 0}, {area.x - 8 * scale, area.y - 8 * scale});
  constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoCollapse |
                                      ImGuiWindowFlags_HorizontalScrollbar | ImGuiWindowFlags_NoMove |
                                      ImGuiWindowFlags_AlwaysAutoResize;
  ImGui::Begin("keys", &view.help, kFlags);
  if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
    for (const KeyBinding& binding : keyBindings()) {
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      ImGui::TextDisabled("%s", binding.keys);
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(binding.text);
    }
    ImGui::EndTable();
  }
  ImGui::Dummy({0, 2 * scale});
  ImGui::TextDisabled("Drop EXR files or a folder into the window to open them.");
  ImGui::End();
}

}  // namespace xrds
