#pragma once

#include "viewer/display/file_browser.h"

namespace xrds {

/// Lays out the dialog that opens files, into Dear ImGui's current frame, if it is open; `scale` as in panel_parts.h.
void drawFileDialog(FileBrowser& browser, float scale);

}  // namespace xrds
