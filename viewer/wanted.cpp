#include "viewer/wanted.h"

namespace xrds {

bool samePixels(const AovRequest& a, const AovRequest& b) {
  return a.color == b.color && a.albedo == b.albedo && a.normal == b.normal && a.depth == b.depth;
}

bool Wanted::operator==(const Wanted& other) const {
  return files == other.files && watching == other.watching && inSequence == other.inSequence &&
         folder == other.folder && samePixels(layers, other.layers) && live == other.live && model == other.model &&
         fp16 == other.fp16 && skip.bound() == other.skip.bound() && memoryBytes == other.memoryBytes &&
         slots == other.slots && metrics == other.metrics && reload == other.reload;
}

}  // namespace xrds
