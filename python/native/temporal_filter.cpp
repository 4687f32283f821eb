#include "python/native/temporal_filter.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/vector.h>

#include <vector>

#include "python/native/device.h"
#include "python/native/image.h"

namespace xrds::python {
namespace {

using namespace nb::literals;
using Numbers = nb::ndarray<float, nb::c_contig, nb::device::cpu>;

/// A frame as Python gives it: images and, without gaps, numbers. What is not there is None.
struct Frame {
  const Image *colour = nullptr, *fullColour = nullptr, *albedo = nullptr, *normal = nullptr;
  std::optional<Numbers> depth, toPrevious, toNext, lowCounts, fullCounts;
};

float* numbersOf(const std::optional<Numbers>& numbers) { return numbers ? numbers->data() : nullptr; }

XrdsTemporalFrame viewOf(const Frame& frame) {
  XrdsTemporalFrame view = xrdsTemporalFrameDefault();
  view.colour = frame.colour->view();
  if (frame.fullColour) view.fullColour = frame.fullColour->view();
  if (frame.albedo) view.albedo = frame.albedo->view();
  if (frame.normal) view.normal = frame.normal->view();
  view.depth = numbersOf(frame.depth);
  view.toPrevious = numbersOf(frame.toPrevious);
  view.toNext = numbersOf(frame.toNext);
  view.lowCounts = numbersOf(frame.lowCounts);
  view.fullCounts = numbersOf(frame.fullCounts);
  return view;
}

std::vector<XrdsTemporalFrame> viewsOf(const std::vector<const Frame*>& frames) {
  std::vector<XrdsTemporalFrame> views;
  for (const Frame* frame : frames) views.push_back(viewOf(*frame));
  return views;
}

class TemporalFilter {
 public:
  TemporalFilter(Device& device, uint32_t width, uint32_t height, uint32_t scale) {
    XrdsDevice* const onDevice = device.handle();
    Call call;
    call.run([&] { return xrdsCreateTemporalFilter(onDevice, width, height, scale, &handle_); });
  }
  ~TemporalFilter() { close(); }
  TemporalFilter(const TemporalFilter&) = delete;
  TemporalFilter& operator=(const TemporalFilter&) = delete;
  void close() {
    if (handle_)
      Call::close(closeHandle<XrdsTemporalFilter, xrdsDestroyTemporalFilter>, std::exchange(handle_, nullptr));
  }
  void run(const Frame& present, const std::vector<const Frame*>& before, const std::vector<const Frame*>& after,
           const Frame& merged) {
    const XrdsTemporalFrame now = viewOf(present), result = viewOf(merged);
    const std::vector<XrdsTemporalFrame> past = viewsOf(before), future = viewsOf(after);
    XrdsTemporalFilter* const filter = opened(handle_, "temporal filter");
    Call call;
    call.run([&] {
      return xrdsMergeFrames(filter, &now, past.data(), static_cast<uint32_t>(past.size()), future.data(),
                             static_cast<uint32_t>(future.size()), &result);
    });
  }
  uint64_t deviceBytes() const { return xrdsGetTemporalDeviceBytes(handle_); }

 private:
  XrdsTemporalFilter* handle_ = nullptr;
};

}  // namespace

void bindTemporalFilter(nb::module_& module) {
  nb::class_<Frame>(module, "TemporalFrame")
      .def(
          "__init__",
          [](Frame* made, const Image* colour, const Image* fullColour, const Image* albedo, const Image* normal,
             const std::optional<Numbers>& depth, const std::optional<Numbers>& toPrevious,
             const std::optional<Numbers>& toNext, const std::optional<Numbers>& lowCounts,
             const std::optional<Numbers>& fullCounts) {
            new (made) Frame{colour, fullColour, albedo, normal, depth, toPrevious, toNext, lowCounts, fullCounts};
          },
          "colour"_a, "full_colour"_a.none(), "albedo"_a.none(), "normal"_a.none(), "depth"_a.none(),
          "to_previous"_a.none(), "to_next"_a.none(), "low_counts"_a.none(), "full_counts"_a.none(),
          nb::keep_alive<1, 2>(), nb::keep_alive<1, 3>(), nb::keep_alive<1, 4>(), nb::keep_alive<1, 5>());
  nb::class_<TemporalFilter>(module, "TemporalFilter")
      .def(nb::init<Device&, uint32_t, uint32_t, uint32_t>(), "device"_a, "width"_a, "height"_a, "scale"_a)
      .def("run", &TemporalFilter::run, "present"_a, "before"_a, "after"_a, "merged"_a)
      .def("close", &TemporalFilter::close)
      .def_prop_ro("device_bytes", &TemporalFilter::deviceBytes);
}

}  // namespace xrds::python
