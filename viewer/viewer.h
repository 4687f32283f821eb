#pragma once

#include <atomic>
#include <ctime>
#include <memory>

#include "viewer/display/canvas.h"
#include "viewer/display/panel.h"
#include "viewer/orbit.h"
#include "viewer/script.h"
#include "viewer/upscaling/upscaling.h"

namespace xrds {

/// How the viewer is started.
struct ViewerOptions {
  std::vector<std::string> files;  // colour, auxiliary, reference; patterns of a sequence; or one folder to watch
  std::string reference;
  AovRequest layers;
  std::string auxColour = "auto";    // or "never", or a layer
  std::string scene;                 // live: built-in or a file; with a scene there are no files
  std::string liveSize = "128x128";  // of its colour
  std::string samples;               // "N", the most of a pixel of it, or "LOW,HIGH" of two renders
  std::string model, device, precision = kFp32, skip = "off", memory, tiles = "bounded", tune = "auto",
                             temporal = "auto", exposure = "auto";
  std::string motion;                      // a layer; empty: as xrds upscale finds it
  std::optional<uint32_t> temporalRadius;  // none: what suits a frame
  uint32_t ensemble = 1;
  bool watch = false, wrap = false, denoiseFirst = false, cleanGuides = false;  // as Wanted has them
  double framesPerSecond = 24;
  std::string size;        // "WIDTHxHEIGHT"; empty: as it was left
  std::string script;      // file of steps to take
  int frames = 0;          // end after so many upscaled pictures are shown
  std::string screenshot;  // written then
  bool validation = false, statistics = false;
  bool headless = false;  // see viewer/headless.h
};

/// Whether the options ask for merged frames (Wanted::temporal), of a live view or a sequence.
bool isTemporal(const ViewerOptions& options, bool live);

/// What the options ask the worker for, but the source. Throws Failure.
Wanted wantedOf(const ViewerOptions& options);

/// The display and everything on it. Used by the main thread.
class Viewer {
 public:
  /// Throws Failure.
  explicit Viewer(const ViewerOptions& options);
  ~Viewer();
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  /// Returns when the display is closed or the script is finished. Throws Failure if Vulkan fails or complains.
  void run();

  /// Closes the display and cancels what goes on. Returns false if something that cannot be cancelled would keep the
  /// program for longer than a moment: then end the process.
  bool leave();

 private:
  struct AskedScreenshot {
    std::filesystem::path path;  // none: none is asked for
    bool isByKey = false;        // the user is told of a failure, which else ends the viewer
  };
  struct Measured {
    double seconds = 0, slowestTurn = 0, turns = 0;
    uint64_t drawings = 0, turnCount = 0;
  };
  struct Clocked {
    std::chrono::steady_clock::time_point wall{};
    std::clock_t processor = 0;
    uint64_t drawings = 0;
    double turns = 0, longestTurn = 0;  // since then, in seconds
  };
  VulkanOptions vulkanOptions();
  Script::Actions scriptActions();
  void addInputActions(Script::Actions& actions);
  void addWindowActions(Script::Actions& actions);
  void addFileActions(Script::Actions& actions);
  void openAsked(const std::vector<std::string>& files);
  void open(const std::vector<std::string>& files);

  // Events.
  void listen();
  void pressKey(int key, int modifiers);
  void perform(Command command, int digit);
  bool performView(Command command, int digit);
  bool performFrame(Command command);
  bool performLive(Command command);
  void showScene(const std::string& scene);
  void pressButton(int button, bool pressed);
  void moveCursor(double x, double y);
  void turnWheel(double steps);
  void chooseModel(int step);
  void needDrawing(int count = 3) { dirty_ = std::max(dirty_, count); }

  // The turns of the main loop.
  std::optional<double> patience() const;
  void takeTurn();
  void measureTurn(double seconds);
  void advancePlayback();
  void updateWanted();
  bool ready() const;
  void draw();
  void placeViewport();
  void recordProbe(VkCommandBuffer commands);
  void readProbe();
  void saveScreenshot(const AskedScreenshot& asked);
  void printStatistics() const;
  void printReport();
  void printTimes();
  void printClock();

  static constexpr uint64_t kProbeRowBytes = 32;  // two texels of each of three rows

  ViewerOptions options_;
  Wanted wanted_;
  std::atomic<int> complaints_ = 0;  // of the validation layers
  Desktop desktop_;
  DisplayEvents events_;
  VulkanDevice vulkan_;
  Device device_;
  Display display_;
  Swapchain swapchain_;
  Pictures pictures_;
  Canvas canvas_;
  Panel panel_;
  HostBuffer probeBuffer_;
  ViewState view_;
  FileBrowser browser_{[this](const std::vector<std::string>& files) { openAsked(files); }};
  Playback playback_;
  Report report_;
  PixelProbe probe_;
  std::optional<Orbit> orbit_;  // of a live view, once its scene is there
  std::vector<std::string> models_;
  std::atomic<bool> changed_ = true;
  bool quit_ = false, draggingWipe_ = false, draggingPicture_ = false, draggingCamera_ = false;
  double cursorX_ = -1, cursorY_ = -1, drawMilliseconds_ = 0;
  int dirty_ = 3;
  bool touched_ = false;         // the user has chosen something since the start
  uint64_t awaited_ = 0;         // pictures, by the script
  uint32_t awaitedSamples_ = 0;  // 0: all
  AskedScreenshot screenshot_;
  std::chrono::steady_clock::time_point nextFrame_{}, lastBar_{};
  Measured measured_;
  Clocked clocked_;
  std::unique_ptr<Upscaling> upscaling_;
  std::unique_ptr<Script> script_;
};

}  // namespace xrds
