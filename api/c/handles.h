#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <unordered_map>

#include "api/device.h"
#include "api/frame_upscaler.h"
#include "api/model.h"
#include "xrds/xrds.h"

/// A device, which one thread at a time may use.
struct XrdsDevice {
  XrdsDevice(xrds::Gpu opened, XrdsPreparation hear, void* user)
      : gpu(std::move(opened)), preparation(hear), preparationUser(user) {}
  xrds::Gpu gpu;
  const XrdsPreparation preparation;  // may be null
  void* const preparationUser;
  std::mutex access;
};

struct XrdsModel {
  explicit XrdsModel(xrds::NetworkModel read);
  const xrds::NetworkModel model;
  const std::string hash, whyNeverSkipped;
  const std::vector<std::string>& inputs() const { return model.config().auxInputs; }
  uint32_t scale() const { return model.config().scale; }
};

/// Models that the options of an upscaler name; null where they name none.
struct XrdsDenoisers {
  std::shared_ptr<XrdsModel> colour, albedo, normal;
  xrds::DenoisingModels models() const;
};

/// An upscaler with what it needs alive. `use` is held by the thread that runs it, `device->access` as well.
struct XrdsUpscaler {
  XrdsUpscaler(std::shared_ptr<XrdsDevice> device, std::shared_ptr<XrdsModel> model, XrdsDenoisers denoisers,
               uint32_t width, uint32_t height, const xrds::Upscaler::Options& options);
  ~XrdsUpscaler();
  /// What upscales an alpha, made when it is first asked for; `device->access` must be held.
  xrds::FrameUpscaler& alphaUpscaler();
  /// Keeps what it is asked for while a thread runs it. `use` must be held.
  void note();

  const std::shared_ptr<XrdsDevice> device;
  const std::shared_ptr<XrdsModel> model;
  const XrdsDenoisers denoisers;
  const uint32_t width, height;
  const xrds::TileOptions tiles;
  std::optional<xrds::FrameUpscaler> upscaler;
  std::optional<xrds::NetworkModel> alphaModel;
  std::optional<xrds::FrameUpscaler> alpha;
  std::mutex use;
  std::atomic<float> exposure = 0;        // as note() found it
  std::atomic<uint64_t> deviceBytes = 0;  // the same
};

namespace xrds::c {

/// The open handles of one kind: what is not among them is refused. One table a kind and process, as handles are C's.
template <class T>
class Handles {
 public:
  static Handles& open() {
    static Handles handles;
    return handles;
  }
  T* add(std::shared_ptr<T> object) {
    const std::lock_guard lock(access_);
    T* const handle = object.get();
    objects_[handle] = std::move(object);
    return handle;
  }
  /// Null if it is not open.
  std::shared_ptr<T> find(const T* handle) const {
    const std::lock_guard lock(access_);
    const auto found = objects_.find(handle);
    return found == objects_.end() ? nullptr : found->second;
  }
  /// What was open, to be given up outside of the table's lock.
  std::shared_ptr<T> remove(const T* handle) {
    const std::lock_guard lock(access_);
    const auto node = objects_.extract(handle);
    return node.empty() ? nullptr : node.mapped();
  }
  /// Throws InvalidArgument, which calls the handle `what`, if it is not open.
  std::shared_ptr<T> opened(const T* handle, const char* what) const {
    if (auto object = find(handle)) return object;
    throw InvalidArgument(std::string("The ") + what +
                          (handle ? " is not open: it was closed, or is no handle at all." : " is a null pointer."));
  }

 private:
  mutable std::mutex access_;
  std::unordered_map<const T*, std::shared_ptr<T>> objects_;
};

/// What a caller has given; null: the defaults. Throws InvalidArgument if it cannot be.
Device::Options optionsOf(const XrdsDeviceOptions& given);
Upscaler::Options optionsOf(const XrdsUpscalerOptions* given);
XrdsDenoisers denoisersOf(const XrdsUpscalerOptions* given);
/// Text and paths of the C API, which are UTF-8.
inline std::string textOf(const char* words) { return words ? words : ""; }
inline std::filesystem::path pathOf(const char* words) { return xrds::pathOf(textOf(words)); }

using Devices = Handles<XrdsDevice>;
using Models = Handles<XrdsModel>;
using Upscalers = Handles<XrdsUpscaler>;

}  // namespace xrds::c
