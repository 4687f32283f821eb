// The pixel under the cursor.
#include <algorithm>
#include <cstring>

#include "viewer/viewer.h"

namespace xrds {

void Viewer::recordProbe(VkCommandBuffer commands) {
  probe_.rows.clear();
  probe_.x = -1;
  const Viewport& viewport = view_.viewport;
  if (!pictures_.at(Slot::input).valid || cursorX_ < 0 || cursorX_ >= viewport.areaWidth || panel_.takesMouse() ||
      !viewport.contains(cursorX_, cursorY_))
    return;
  probe_.x = static_cast<int>(viewport.pictureX(cursorX_));
  probe_.y = static_cast<int>(viewport.pictureY(cursorY_));
  std::vector<View> views{view_.right};
  if (view_.wiping && view_.left != view_.right) views.insert(views.begin(), view_.left);
  if (pictures_.at(Slot::reference).valid && std::find(views.begin(), views.end(), View::reference) == views.end())
    views.push_back(View::reference);
  constexpr uint64_t kTexelBytes = 4 * sizeof(float);
  for (const View view : views) {
    if (canvas_.shownFor(view) != view) continue;
    const Canvas::Choice choice = Canvas::choiceOf(view);
    const PictureView picture = pictures_.at(choice.slot);
    const auto x = static_cast<uint64_t>(probe_.x * picture.width / viewport.pictureWidth);
    const auto y = static_cast<uint64_t>(probe_.y * picture.height / viewport.pictureHeight);
    const uint64_t row = std::min<uint64_t>(y, picture.height - 1) * picture.planes + choice.plane();
    const uint64_t place = kProbeRowBytes * probe_.rows.size();
    const VkBufferCopy region{kTexelBytes * (row * picture.width + x), place, 12};
    vkCmdCopyBuffer(commands, picture.buffer, probeBuffer_.buffer(), 1, &region);
    probe_.rows.push_back({.name = nameOf(view), .isError = view == View::error});
    if (view != View::error) continue;
    const PictureView expected = pictures_.at(choice.other);
    const uint64_t at = uint64_t{static_cast<uint32_t>(probe_.y)} * expected.width + static_cast<uint32_t>(probe_.x);
    const VkBufferCopy second{kTexelBytes * at, place + kProbeRowBytes / 2, 12};
    vkCmdCopyBuffer(commands, expected.buffer, probeBuffer_.buffer(), 1, &second);
  }
}

// What the drawing before this one has copied.
void Viewer::readProbe() {
  for (size_t i = 0; i < probe_.rows.size(); ++i) {
    float values[3], expected[3];
    PixelProbe::Row& row = probe_.rows[i];
    const std::byte* from = probeBuffer_.bytes().data() + kProbeRowBytes * i;
    std::memcpy(values, from, sizeof values);
    std::memcpy(expected, from + kProbeRowBytes / 2, sizeof expected);
    if (row.isError)
      for (size_t c = 0; c < 3; ++c) values[c] = shader::relativeSquaredError(values[c], expected[c]);
    row.red = values[0], row.green = values[1], row.blue = values[2];
  }
}

}  // namespace xrds
