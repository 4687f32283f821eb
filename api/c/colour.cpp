// The colours of a render's two images.
#include "api/colour.h"

#include "api/c/images.h"
#include "api/c/result.h"
#include "api/finite_image.h"
#include "image/repair.h"
#include "xrds/merged_colour.h"

using namespace xrds::c;

namespace {

/// Two colours of one frame, as they are merged: what is not finite is filled from its neighbours, and what is negative
/// is 0, of `full` where it is read.
class BothColours {
 public:
  BothColours(const XrdsImage* lowImage, const XrdsImage* fullImage)
      : givenLow_(required(lowImage, "low"), "low-resolution"),
        givenFull_(required(fullImage, "full"), "full-resolution"),
        low_(xrds::imageOf(givenLow_.view())),
        full_(givenFull_.view(), xrds::PixelKind::radiance) {
    xrds::repairRadiance(low_);
  }
  xrds::PixelView low() const {
    return {low_.pixels.data(), static_cast<uint32_t>(low_.width), static_cast<uint32_t>(low_.height), 3};
  }
  const xrds::PixelView& full() const { return full_.view(); }

 private:
  const ReadImage givenLow_, givenFull_;
  xrds::Image low_;
  const xrds::FiniteImage full_;
};

void writeColour(const XrdsImage& image, const std::vector<float>& pixels) {
  for (uint32_t c = 0; c < 3; ++c) writeChannel(image, c, &pixels[c], 3);
}

void checkSameSize(const XrdsImage& image, const XrdsImage& as, const char* what, const char* other) {
  checkImage(image, what, 3);
  if (image.width != as.width || image.height != as.height)
    throw xrds::InvalidArgument(std::string("The ") + what + " image must have the size of the " + other + " one.");
}

}  // namespace

XrdsResult xrdsMergeColour(const XrdsImage* low, const XrdsImage* full, double lowSamples, double fullSamples,
                           const XrdsImage* merged) {
  return guarded([&] {
    const BothColours colours(low, full);
    checkSameSize(required(merged, "merged"), *low, "merged", "low-resolution");
    const bool known = lowSamples != 0 || fullSamples != 0;
    const double share = known ? xrds::fullShare({lowSamples, fullSamples}, full->width / low->width)
                               : xrds::shareByNoise(colours.low(), colours.full());
    const std::vector<float> pixels = xrds::mergedByShare(colours.low(), colours.full(), share);
    const std::vector<float> alpha = low->channels[3] ? readChannel(*low, 3) : std::vector<float>();
    writeColour(*merged, pixels);
    if (merged->channels[3]) {
      const float opaque = 1;
      writeChannel(*merged, 3, alpha.empty() ? &opaque : alpha.data(), alpha.empty() ? 0 : 1);
    }
    return XRDS_OK;
  });
}

XrdsResult xrdsCompareColour(const XrdsImage* low, const XrdsImage* full, double* difference) {
  return guarded([&] {
    const BothColours colours(low, full);
    required(difference, "difference") = xrds::differenceOf(colours.low(), colours.full());
    return XRDS_OK;
  });
}

XrdsResult xrdsEstimateFullShare(const XrdsImage* low, const XrdsImage* full, double* share) {
  return guarded([&] {
    const BothColours colours(low, full);
    required(share, "share") = xrds::shareByNoise(colours.low(), colours.full());
    return XRDS_OK;
  });
}

XrdsResult xrdsMergeByShare(const XrdsImage* low, const XrdsImage* full, double share, const XrdsImage* merged) {
  return guarded([&] {
    const BothColours colours(low, full);
    checkSameSize(required(merged, "merged"), *low, "merged", "low-resolution");
    if (!(share >= 0 && share <= 1))
      throw xrds::InvalidArgument("The share is " + std::to_string(share) + ", expected a number from 0 to 1.");
    writeColour(*merged, xrds::mergedByShare(colours.low(), colours.full(), share));
    return XRDS_OK;
  });
}

XrdsResult xrdsLevelColour(const XrdsImage* full, const XrdsImage* merged, const XrdsImage* levelled) {
  return guarded([&] {
    const BothColours colours(merged, full);
    checkSameSize(required(levelled, "levelled"), *full, "levelled", "full-resolution");
    writeColour(*levelled, xrds::atLevelOf(colours.full(), colours.low()));
    return XRDS_OK;
  });
}
