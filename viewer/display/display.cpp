#include "viewer/display/display.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>

#include "xrds/error.h"

namespace xrds {
namespace {

std::string lastGlfwError() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text ? text : "no reason given";
}

Display& displayOf(GLFWwindow* window) { return *static_cast<Display*>(glfwGetWindowUserPointer(window)); }

template <class Action, class... Arguments>
void tell(const Action& action, const Arguments&... arguments) {
  if (action) action(arguments...);
}

void listen(GLFWwindow* window) {
  glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int modifiers) {
    if (action != GLFW_RELEASE) tell(displayOf(w).events().key, key, modifiers);
  });
  glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int) {
    tell(displayOf(w).events().button, button, action == GLFW_PRESS);
  });
  glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) {
    const double scale = displayOf(w).pixelsPerUnit();  // events count in screen coordinates
    tell(displayOf(w).events().move, scale * x, scale * y);
  });
  glfwSetScrollCallback(window, [](GLFWwindow* w, double, double y) { tell(displayOf(w).events().scroll, y); });
  glfwSetDropCallback(window, [](GLFWwindow* w, int count, const char** paths) {
    tell(displayOf(w).events().drop, std::vector<std::string>(paths, paths + count));
  });
  const auto redraw = [](GLFWwindow* w) { tell(displayOf(w).events().redraw); };
  glfwSetWindowRefreshCallback(window, redraw);
  glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int, int) { tell(displayOf(w).events().redraw); });
  glfwSetWindowIconifyCallback(window, [](GLFWwindow* w, int) { tell(displayOf(w).events().redraw); });
  glfwSetWindowContentScaleCallback(window, [](GLFWwindow* w, float, float) { tell(displayOf(w).events().rescale); });
  glfwSetCursorEnterCallback(window, [](GLFWwindow* w, int) { tell(displayOf(w).events().redraw); });
}

// Whether some monitor would show the top of a display there: they come and go between two starts.
bool onSomeMonitor(int x, int y) {
  int count = 0;
  GLFWmonitor** monitors = glfwGetMonitors(&count);
  return std::any_of(monitors, monitors + count, [&](GLFWmonitor* monitor) {
    int left = 0, top = 0, width = 0, height = 0;
    glfwGetMonitorWorkarea(monitor, &left, &top, &width, &height);
    return x >= left - 8 && x < left + width - 64 && y >= top - 8 && y < top + height - 64;
  });
}

}  // namespace

Desktop::Desktop() {
  if (!glfwInit())
    throw Error("No window can be opened (" + lastGlfwError() +
                "): start the viewer on a desktop, or under xvfb-run; xrds upscale needs no display.");
  if (glfwVulkanSupported()) return;
  const std::string reason = lastGlfwError();
  glfwTerminate();
  throw Error("Vulkan cannot draw on this desktop (" + reason + "): install the graphics driver of your GPU.");
}

Desktop::~Desktop() { glfwTerminate(); }

std::vector<std::string> Desktop::instanceExtensions() const {
  uint32_t count = 0;
  const char** names = glfwGetRequiredInstanceExtensions(&count);
  return {names, names + count};
}

Display::Display(const Desktop&, const std::string& title, const Placement& placement, const DisplayEvents& events)
    : events_(events), restored_(placement) {
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
  glfwWindowHint(GLFW_MAXIMIZED, placement.maximized ? GLFW_TRUE : GLFW_FALSE);
  window_ = glfwCreateWindow(std::max(placement.width, 320), std::max(placement.height, 240), title.c_str(), nullptr,
                             nullptr);
  if (!window_) throw Error("The desktop opens no window (" + lastGlfwError() + ").");
  if (placement.x && placement.y && onSomeMonitor(*placement.x, *placement.y))
    glfwSetWindowPos(window_, *placement.x, *placement.y);
  glfwSetWindowUserPointer(window_, this);
  listen(window_);
  glfwShowWindow(window_);
}

Display::~Display() { glfwDestroyWindow(window_); }

void Display::handleEvents(std::optional<double> seconds) {
  if (!seconds)
    glfwWaitEvents();
  else if (*seconds > 0)
    glfwWaitEventsTimeout(*seconds);
  else
    glfwPollEvents();
}

void Display::wake() { glfwPostEmptyEvent(); }

bool Display::closing() const { return glfwWindowShouldClose(window_) != 0; }

bool Display::minimized() const {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  return width == 0 || height == 0 || glfwGetWindowAttrib(window_, GLFW_ICONIFIED) != 0;
}

float Display::scale() const {
  float x = 1, y = 1;
  glfwGetWindowContentScale(window_, &x, &y);
  return std::max(x, 1.F);
}

float Display::pixelsPerUnit() const {
  int units = 0, pixels = 0;
  glfwGetWindowSize(window_, &units, nullptr);
  glfwGetFramebufferSize(window_, &pixels, nullptr);
  return units > 0 ? static_cast<float>(pixels) / static_cast<float>(units) : 1;
}

Placement Display::placement() const {
  if (glfwGetWindowAttrib(window_, GLFW_MAXIMIZED) != 0 || glfwGetWindowAttrib(window_, GLFW_ICONIFIED) != 0) {
    Placement kept = restored_;
    kept.maximized = glfwGetWindowAttrib(window_, GLFW_MAXIMIZED) != 0;
    return kept;
  }
  Placement found;
  int x = 0, y = 0;
  glfwGetWindowSize(window_, &found.width, &found.height);
  glfwGetWindowPos(window_, &x, &y);
  // A new display is enlarged by the scale.
  const float enlarged = scale() / pixelsPerUnit();
  found.width = static_cast<int>(std::lround(static_cast<float>(found.width) / enlarged));
  found.height = static_cast<int>(std::lround(static_cast<float>(found.height) / enlarged));
  found.x = x;
  found.y = y;
  return found;
}

void Display::resize(int width, int height) { glfwSetWindowSize(window_, width, height); }
void Display::minimize() { glfwIconifyWindow(window_); }
void Display::restore() { glfwRestoreWindow(window_); }
void Display::hide() { glfwHideWindow(window_); }
void Display::title(const std::string& text) { glfwSetWindowTitle(window_, text.c_str()); }

}  // namespace xrds
