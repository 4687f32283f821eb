#pragma once

#include <CLI/CLI.hpp>

#include "image/aov.h"

namespace xrds {

/// Declares --color and an option for each kind of auxiliary image, which choose layers.
void addLayerOptions(CLI::App& verb, AovRequest& layers);

}  // namespace xrds
