#pragma once

#include <array>
#include <condition_variable>
#include <functional>
#include <future>
#include <map>
#include <thread>

#include "app/network_denoiser.h"
#include "viewer/display/flicker.h"
#include "viewer/live_scene.h"
#include "viewer/moving_sequence.h"
#include "viewer/upscaling/report.h"
#include "viewer/upscaling/stage_times.h"
#include "viewer/upscaling/wanted.h"
#include "viewer/watch.h"

namespace xrds {

/// Upscales on a thread of its own and leaves the results in pictures, on the device.
class Upscaling {
 public:
  /// `changed` is called on the worker's thread whenever there is something new to show. The Vulkan device, the same
  /// one as xrds shares it, pictures and what the callback needs must outlive this.
  Upscaling(VulkanDevice& vulkan, Device& device, Pictures& pictures, std::function<void()> changed);
  ~Upscaling();
  Upscaling(const Upscaling&) = delete;
  Upscaling& operator=(const Upscaling&) = delete;

  /// From another thread: what to do from now on; a run that it makes useless is cancelled.
  void want(const Wanted& wanted);
  /// Writes the output to an EXR file once it is there; how that went is told by Report::notice.
  void save(const std::filesystem::path& path);
  Report report() const;
  /// Shows a failure of the asking thread's, over files, as if it were the worker's.
  void fail(const Failure& failure);
  /// Shows what the asking thread has to tell.
  void note(const std::string& notice);
  /// Cancels everything for good and waits for its end, as long at most: returns false if something that cannot be
  /// cancelled still goes on, such as reading files or measuring. A file that is being saved is waited for.
  bool stop(std::chrono::milliseconds patience);

 private:
  static constexpr const char* kNothingToSave = "There is no picture to save yet.";

  void loop();
  std::optional<Wanted> nextWanted();
  void tellFailure(const Wanted& wanted, const Failure& failure);
  void serve(const Wanted& wanted);
  bool loadWanted(const Wanted& wanted);
  void takeFrame(LoadedFrame frame);
  void trace(const Wanted& wanted);
  void prepare(const Wanted& wanted);
  void showChosen(const Wanted& wanted);
  void upscale(const Wanted& wanted);
  void showFlicker(const Wanted& wanted);
  LoadedFrame loadFrameOf(const Wanted& wanted, const FrameFiles& files);
  NetworkOptions optionsFor(const Wanted& wanted, const Model& model);
  void keepPace();
  void showBaseFirst();
  bool showProgress(double share);
  size_t giveInputs(PreparedNetwork& network);
  void makeBase(Slot slot);
  void showDenoised(const Wanted& wanted);
  void startMetrics();
  void takeMetrics();
  void saveIfAsked();
  std::string savedTo(const std::filesystem::path& path) const;
  void tell(const std::function<void(Report&)>& change);
  void tellPicture(size_t merged);
  bool stopping() const;
  bool outdated() const;
  std::string wantedModel(const Wanted& wanted) const;
  std::string modelWithoutConstant(const Wanted& wanted) const;

  VulkanDevice& vulkan_;
  Device& device_;
  Pictures& pictures_;
  std::function<void()> changed_;

  // Shared with the asking thread.
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  Wanted wanted_;
  uint64_t asked_ = 0;  // counts the changes of wanted_
  std::filesystem::path saveTo_;
  Report report_;
  bool stopping_ = false, ended_ = false, saving_ = false;

  // The worker's own.
  uint64_t serving_ = 0;
  Wanted served_;
  FileWatch watch_;
  std::optional<LoadedFrame> frame_;
  std::unique_ptr<LiveScene> live_;
  bool refining_ = false;  // the live view is not finished
  std::unique_ptr<MovingSequence> moving_;
  std::shared_ptr<const Sequence> constantOf_;  // whose constant input is known
  std::string constant_;
  std::unique_ptr<Flicker> flicker_;
  bool temporal_ = false;          // of what was served last
  FrameSize size_;                 // of the frame or the live view
  NetworkDenoiser denoisers_{{}};  // in front of the network
  std::unique_ptr<PreparedNetwork> network_;
  std::map<Slot, std::unique_ptr<PreparedNetwork>> bases_;
  Image denoised_;              // the full-resolution render, what is in the slot
  uint64_t askedDenoiser_ = 0;  // the frame that it was asked of last
  bool upscaled_ = false;
  std::chrono::steady_clock::time_point lastShown_{};
  uint32_t tilesShown_ = 0;
  uint64_t pace_ = NetworkOptions{}.multiplyAddsAtOnce;  // of this device
  std::chrono::steady_clock::time_point lastPicture_{};
  StageClock clock_;
  std::future<std::vector<ComparedPicture>> measuring_;
  uint64_t measuredFrame_ = 0, frameCount_ = 0;
  bool measured_ = false;
  std::thread thread_;
};

}  // namespace xrds
