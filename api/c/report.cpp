// What there is to know of an upscaler beside its pictures.
#include "api/c/report.h"

#include <cstring>

#include "api/c/handles.h"
#include "api/c/images.h"
#include "api/c/result.h"
#include "api/c/sized.h"

using namespace xrds::c;

namespace {

// Calls `action` with an upscaler that no thread uses.
template <class Action>
XrdsResult withUpscaler(XrdsUpscaler* upscaler, const Action& action) {
  return guarded([&] {
    const auto found = Upscalers::open().opened(upscaler, "upscaler");
    const std::unique_lock lock(found->use, std::try_to_lock);
    if (!lock) return failed(XRDS_ERROR_BUSY, "The upscaler is in use on another thread: ask when its run has ended.");
    action(*found->upscaler);
    return XRDS_OK;
  });
}

void giveTiling(const xrds::Tiling& tiling, XrdsTiling* out) {
  give<XrdsTiling>({.structSize = sizeof(XrdsTiling),
                    .columns = tiling.columns,
                    .rows = tiling.rows,
                    .halo = tiling.halo,
                    .tileWidth = tiling.tileWidth,
                    .tileHeight = tiling.tileHeight,
                    .work = tiling.work,
                    .arenaBytes = tiling.arenaBytes,
                    .weightBytes = tiling.weightBytes},
                   required(out, "tiling"));
}

}  // namespace

void xrds::c::tellProfile(std::span<const Upscaler::ProfileRow> rows, XrdsHearProfile hear, void* user) {
  for (const Upscaler::ProfileRow& row : rows) {
    const XrdsProfileRow told{.structSize = sizeof told,
                              .label = row.label.c_str(),
                              .program = row.program.c_str(),
                              .multiplyAdds = row.multiplyAdds,
                              .bytes = row.bytes,
                              .microseconds = row.microseconds};
    hear(user, &told);
  }
}

XrdsResult xrdsPlanTiles(const XrdsModel* model, uint32_t outputWidth, uint32_t outputHeight,
                         const XrdsUpscalerOptions* options, const char* kernelFamily, XrdsTiling* tiling) {
  return guarded([&] {
    const auto found = Models::open().opened(model, "model");
    const xrds::Upscaler::Options asked = optionsOf(options);
    giveTiling(xrds::planTiles(found->model, outputWidth, outputHeight, asked.fp16, asked.tiles,
                               &required(kernelFamily, "kernelFamily")),
               tiling);
    return XRDS_OK;
  });
}

XrdsResult xrdsPaysToTune(XrdsDevice* device, const XrdsModel* model, uint32_t width, uint32_t height, int32_t fp16,
                          int32_t* pays) {
  return guarded([&] {
    const auto on = Devices::open().opened(device, "device");
    const auto of = Models::open().opened(model, "model");
    const std::lock_guard lock(on->access);
    required(pays, "pays") = xrds::paysToTune(on->gpu, of->model, {height, width}, fp16 != 0);
    return XRDS_OK;
  });
}

XrdsResult xrdsGetTiling(XrdsUpscaler* upscaler, XrdsTiling* tiling) {
  return withUpscaler(upscaler, [&](const xrds::FrameUpscaler& of) { giveTiling(of.tiling(), tiling); });
}

XrdsResult xrdsGetRepairs(XrdsUpscaler* upscaler, XrdsRepairs* repairs) {
  return withUpscaler(upscaler, [&](const xrds::FrameUpscaler& of) {
    const auto found = of.repairs();
    give<XrdsRepairs>({.structSize = sizeof(XrdsRepairs),
                       .colour = found.colour,
                       .auxiliary = found.auxiliary,
                       .output = found.output},
                      required(repairs, "repairs"));
  });
}

XrdsResult xrdsGetSkipMap(XrdsUpscaler* upscaler, XrdsSkipMap* map, uint8_t* windows, size_t capacity) {
  return withUpscaler(upscaler, [&](const xrds::FrameUpscaler& of) {
    const xrds::SkipMap found = of.skipMap();
    if (windows && capacity < found.windows.size())
      throw xrds::InvalidArgument("There is room for " + std::to_string(capacity) + " windows, expected " +
                                  std::to_string(found.windows.size()) + ".");
    give<XrdsSkipMap>({.structSize = sizeof(XrdsSkipMap),
                       .side = found.side,
                       .columns = found.columns,
                       .rows = found.rows,
                       .work = found.work},
                      required(map, "map"));
    for (size_t i = 0; windows && i < found.windows.size(); ++i) windows[i] = static_cast<uint8_t>(found.windows[i]);
  });
}

XrdsResult xrdsGetProfile(XrdsUpscaler* upscaler, XrdsHearProfile hear, void* user) {
  return withUpscaler(upscaler,
                      [&](const xrds::FrameUpscaler& of) { tellProfile(of.profile(), &required(hear, "hear"), user); });
}

XrdsResult xrdsCheckFrame(XrdsDevice* device, const XrdsModel* model, const XrdsImage* colour,
                          const XrdsImage* auxiliary, uint32_t auxiliaryCount, const XrdsUpscalerOptions* options,
                          XrdsHearCheck hear, void* user) {
  return guarded([&] {
    const auto on = Devices::open().opened(device, "device");
    const auto of = Models::open().opened(model, "model");
    required(hear, "hear");
    const ReadImages images(of->inputs(), required(colour, "colour"), auxiliary, auxiliaryCount);
    const std::lock_guard lock(on->access);
    const XrdsDenoisers denoisers = denoisersOf(options);
    const auto rows = xrds::checkFrame(on->gpu, of->model, images.colour.view(), images.views, optionsOf(options),
                                       denoisers.models());
    for (const xrds::Upscaler::CheckRow& row : rows) {
      const XrdsCheckRow told{.structSize = sizeof told,
                              .label = row.label.c_str(),
                              .relativeRms = row.relativeRms,
                              .finite = row.finite,
                              .withinBound = row.withinBound};
      hear(user, &told);
    }
    return XRDS_OK;
  });
}
