#pragma once

#include <functional>
#include <string>
#include <vector>

#include "viewer/display/file_browser.h"
#include "viewer/display/layout.h"
#include "viewer/display/swapchain.h"
#include "viewer/keys.h"
#include "viewer/upscaling/report.h"
#include "viewer/upscaling/wanted.h"
#include "viewer/view_state.h"

namespace xrds {

/// The frames of a sequence, and which of them is shown.
struct Playback {
  std::shared_ptr<const Sequence> frames;  // null: there is none
  size_t index = 0;
  bool playing = false, looping = true;
  float framesPerSecond = 24;
  size_t count() const { return frames ? frames->size() : 0; }
};

/// The pixel under the cursor in the views that are shown; of an error view the errors as its map has them.
struct PixelProbe {
  int x = -1, y = -1;  // of the output; -1: the cursor is elsewhere
  struct Row {
    std::string name;
    float red = 0, green = 0, blue = 0;
    bool isError = false;
  };
  std::vector<Row> rows;
};

/// All that the user interface shows and changes.
struct PanelModel {
  ViewState& view;
  Wanted& wanted;
  Playback& playback;
  const Report& report;
  const PixelProbe& probe;
  const std::vector<std::string>& models;  // that can be chosen
  FileBrowser& browser;
  bool hasPicture = false;
  View shownLeft, shownRight;  // now, where the pictures of the chosen views are not there
  double drawMilliseconds = 0, longestTurnMilliseconds = 0;
  std::function<void(Command)> perform;  // as if its key had been pressed
};

/// The user interface over the picture, drawn with Dear ImGui. Used by the main thread, one at a time.
class Panel {
 public:
  /// Throws Error if Vulkan fails. All must outlive the panel.
  Panel(VulkanDevice& gpu, const Display& display, const Swapchain& swapchain);
  ~Panel();
  Panel(const Panel&) = delete;
  Panel& operator=(const Panel&) = delete;

  /// Takes a new scale of the display. Call it when what was drawn before is finished.
  void rescale();
  /// Display pixels that the panel takes from the picture, at the right of a display of that width.
  uint32_t width(const ViewState& view, uint32_t displayWidth) const;
  float scale() const { return scale_; }
  /// Whether the mouse is over the user interface rather than the picture.
  bool takesMouse() const;
  /// Whether what is typed goes into a field.
  bool takesKeys() const;
  /// Lays everything out for a display of that size.
  void layOut(PanelModel& model, VkExtent2D extent);
  /// From now on the mouse is there, in display pixels, and its left button pressed or not, for scripts.
  void pretendMouse(double x, double y, bool pressed) { pretended_ = {x, y, pressed}; }
  /// Records what was laid out.
  static void draw(VkCommandBuffer commands);

 private:
  struct Mouse {
    double x = 0, y = 0;
    bool pressed = false;
  };
  void open();
  void layOutPanel(PanelModel& model, PanelPlace place, float width, float height);
  void applyPretended() const;

  VulkanDevice& gpu_;
  const Display& display_;
  const Swapchain& swapchain_;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  float scale_ = 1;  // display pixels in a pixel of what is laid out
  float unit_ = 1;   // display pixels in Dear ImGui's unit of length, the desktop's
  std::optional<Mouse> pretended_;
};

}  // namespace xrds
