#pragma once

#include "viewer/tracer/scene.h"

namespace xrds {

/// A study under a ceiling lamp: checkered floor, brick wall, books, a picture, a metal, a rough metal and a glass
/// body.
TraceScene makeRoom();

/// Trees, tufts and stones in hundreds of copies on a meadow with a path, under sun and sky.
TraceScene makeGarden();

/// Metal of every roughness and glass on a printed table under an evening sky.
TraceScene makeSpheres();

}  // namespace xrds
