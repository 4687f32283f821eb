#include "image/frame_fit.h"

namespace xrds {
namespace {

bool isWholeMultiple(const Box& low, const Box& high) {
  return high.width() > low.width() && high.width() % low.width() == 0 &&
         high.width() / low.width() * low.height() == high.height();
}

}  // namespace

FrameFit fitFrame(const ExrPart& color, const ExrPart& auxiliary) {
  const bool shared = color.displayWindow == auxiliary.displayWindow;
  const bool bySize = shared && isWholeMultiple(color.dataWindow, auxiliary.dataWindow);
  FrameFit fit;
  fit.scale = bySize ? scaleBetween(color.dataWindow, auxiliary.dataWindow)
                     : scaleBetween(color.displayWindow, auxiliary.displayWindow);
  fit.dataWindow = scaledBox(color.dataWindow, fit.scale);
  const bool displaysAuxiliary = bySize && auxiliary.displayWindow == auxiliary.dataWindow;
  fit.displayWindow = displaysAuxiliary ? auxiliary.displayWindow : scaledBox(color.displayWindow, fit.scale);
  return fit;
}

}  // namespace xrds
