#pragma once

#include <OpenEXR/ImfPixelType.h>

#include "image/exr/file.h"

namespace xrds {

inline ExrPixelType pixelTypeOf(Imf::PixelType type) {
  return type == Imf::HALF ? ExrPixelType::kHalf : type == Imf::FLOAT ? ExrPixelType::kFloat : ExrPixelType::kUint;
}

inline Imf::PixelType imfTypeOf(ExrPixelType type) {
  return type == ExrPixelType::kHalf ? Imf::HALF : type == ExrPixelType::kFloat ? Imf::FLOAT : Imf::UINT;
}

}  // namespace xrds
