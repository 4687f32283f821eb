#pragma once

#include "viewer/panel.h"

namespace xrds {

/// The parts of the user interface, laid out into Dear ImGui's current frame.
/// The panel's contents, into the current window.
void drawPanel(PanelModel& model);
/// Names of the views and the divider, over the picture, whose area is `width` x `height`; `unit`: display pixels in a
/// unit of these.
void drawLabels(const PanelModel& model, float width, float height, float scale, float unit);
/// The key table, in the middle.
void drawHelp(ViewState& view, float scale);

}  // namespace xrds
