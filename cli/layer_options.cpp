#include "cli/layer_options.h"

#include <string>

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

}  // namespace xrds
