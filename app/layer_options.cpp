#include "app/layer_options.h"

#include <CLI/CLI.hpp>
#include <string>

#include "app/frame_layers.h"
#include "xrds/auxiliary_input.h"

namespace xrds {

void addLayerOptions(CLI::App& verb, AovRequest& layers) {
  verb.add_option("--color,--colour", layers.names[AovRole::kColor], "Layer to take as colour")->type_name("LAYER");
  for (const AuxiliaryInput& input : kAuxiliaryInputs)
    if (input.name != kFullColour.name)
      verb.add_option("--" + std::string(input.name), layers.names[roleOf(input.name)],
                      "Layer to take as " + std::string(input.meaning))
          ->type_name("LAYER");
}

void addLights(CLI::App& verb, std::string& lights, const std::string& help) {
  const auto isRequest = [](const std::string& text) {
    return layerRequest(text).any() ? "" : "expected all, or names with commas";
  };
  verb.add_option("--layers", lights, help)->type_name("all|NAME,NAME")->check(CLI::Validator(isRequest, ""));
}

}  // namespace xrds
