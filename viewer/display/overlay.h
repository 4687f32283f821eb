#pragma once

#include "viewer/display/panel.h"

namespace xrds {

/// What stands over the picture, whose area is `width` x `height` of Dear ImGui's units: the divider, the names of the
/// views, the legends of their colours, and what the user waits for where the panel does not say it. `scale`: units in
/// a pixel of an ordinary display; `unit`: display pixels in a unit.
void drawOverlay(const PanelModel& model, PanelPlace place, float width, float height, float scale, float unit);

/// The text, or as much of its beginning and end as is no wider, with dots between them.
std::string shortened(const std::string& text, float width);

}  // namespace xrds
