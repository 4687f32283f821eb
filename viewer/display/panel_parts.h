#pragma once

#include "viewer/display/panel.h"

namespace xrds {

/// The parts of the user interface, laid out into Dear ImGui's current frame.
/// The panel's contents, into the current window of ImGui.
void drawPanel(PanelModel& model);
/// The key table, in the middle; `scale`: units in a pixel of an ordinary display.
void drawHelp(ViewState& view, float scale);

}  // namespace xrds
