#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

struct GLFWwindow;

namespace xrds {

/// The desktop's windowing system, open as long as this lives; the first of its kind in the process.
class Desktop {
 public:
  /// Throws Error if there is no display, or none that Vulkan can draw on.
  Desktop();
  ~Desktop();
  Desktop(const Desktop&) = delete;
  Desktop& operator=(const Desktop&) = delete;

  /// Vulkan instance extensions that drawing on it needs.
  std::vector<std::string> instanceExtensions() const;
};

/// Where a display lies on the desktop, in screen coordinates; its size as it would be on an ordinary monitor.
struct Placement {
  int width = 1280, height = 800;
  std::optional<int> x{}, y{};
  bool maximized = false;
};

/// What the user does to a display. Positions are in pixels of the framebuffer.
struct DisplayEvents {
  std::function<void(int key, int modifiers)> key{};
  std::function<void(int button, bool pressed)> button{};
  std::function<void(double x, double y)> move{};
  std::function<void(double steps)> scroll{};
  std::function<void(const std::vector<std::string>& files)> drop{};
  std::function<void()> redraw{};
  std::function<void()> rescale{};  // the display's pixels are of another size now
};

/// A part of the desktop to draw on, a window of GLFW. Used by the main thread alone, but for wake().
class Display {
 public:
  /// The events must outlive the display. Throws Error if the desktop opens no window.
  Display(const Desktop& desktop, const std::string& title, const Placement& placement, const DisplayEvents& events);
  ~Display();
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;

  GLFWwindow* window() const { return window_; }
  const DisplayEvents& events() const { return events_; }
  /// Handles what has happened; waits for something to happen first, for as many seconds at most (empty: for ever).
  void handleEvents(std::optional<double> seconds);
  /// Ends a wait of handleEvents(), from any thread.
  static void wake();

  bool closing() const;
  /// Nothing to draw on.
  bool minimized() const;
  /// Pixels of the framebuffer in a pixel of the user interface, as it would be on an ordinary display.
  float scale() const;
  /// Pixels of the framebuffer in a screen coordinate, which on some desktops are as large as those of scale().
  float pixelsPerUnit() const;
  Placement placement() const;
  void resize(int width, int height);
  void minimize();
  void restore();
  void hide();
  void title(const std::string& text);

 private:
  GLFWwindow* window_ = nullptr;
  const DisplayEvents& events_;
  Placement restored_;  // its place when it is not maximized
};

}  // namespace xrds
