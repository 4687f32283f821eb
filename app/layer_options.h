#pragma once

#include <string>

#include "image/layers/aov.h"

namespace CLI {
class App;
}

namespace xrds {

/// Declares --color and an option for each kind of auxiliary image, which choose layers.
void addLayerOptions(CLI::App& verb, AovRequest& layers);

/// Declares --layers, which takes what layerRequest() reads.
void addLights(CLI::App& verb, std::string& lights, const std::string& help);

}  // namespace xrds
