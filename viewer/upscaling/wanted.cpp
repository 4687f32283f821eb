#include "viewer/upscaling/wanted.h"

#include <algorithm>
#include <iterator>

namespace xrds {

bool samePixels(const AovRequest& a, const AovRequest& b) {
  const AovRole roles[] = {AovRole::kColor,   AovRole::kAlbedo, AovRole::kNormal,   AovRole::kDepth,
                           AovRole::kDiffuse, AovRole::kGlossy, AovRole::kFullColor};
  return std::all_of(std::begin(roles), std::end(roles),
                     [&](AovRole role) { return a.nameOf(role) == b.nameOf(role); });
}

bool Wanted::operator==(const Wanted& other) const {
  return files == other.files && watching == other.watching && sequence == other.sequence && number == other.number &&
         temporal == other.temporal && folder == other.folder && samePixels(layers, other.layers) &&
         merge.never == other.merge.never && live == other.live && model == other.model && fp16 == other.fp16 &&
         denoiseFirst == other.denoiseFirst && cleanGuides == other.cleanGuides && skip.bound() == other.skip.bound() &&
         exposure == other.exposure && ensemble == other.ensemble && wrap == other.wrap &&
         memoryBytes == other.memoryBytes && exactTiles == other.exactTiles && temporalRadius == other.temporalRadius &&
         motion == other.motion && slots == other.slots && metrics == other.metrics && reload == other.reload;
}

}  // namespace xrds
