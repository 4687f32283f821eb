#include "cli/bench/quality_methods.h"

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "app/models.h"
#include "app/timer.h"
#include "app/upscale_frame.h"
#include "cli/progress.h"

namespace xrds {
namespace {

double deviceSeconds(const Upscaler& upscaler) {
  const auto rows = upscaler.profile();
  return 1e-6 * std::accumulate(rows.begin(), rows.end(), 0.0,
                                [](double sum, const auto& row) { return sum + row.microseconds; });
}

}  // namespace

Image EngineMethod::run(Device& device, const Frame& frame, bool fp16, bool denoised, FrameSeconds& seconds) {
  const auto known = upscalers_.find({frame.width(), frame.height()});
  const bool first = known == upscalers_.end();
  Upscaler& upscaler =
      first ? upscalers_
                  .try_emplace({frame.width(), frame.height()}, device, model_, frame.width(), frame.height(),
                               Upscaler::Options{
                                   .fp16 = fp16, .profile = true, .ensemble = ensemble_, .denoisedColour = denoised})
                  .first->second
            : known->second;
  const int scale = static_cast<int>(model_.scale());
  Image result(frame.colour().width * scale, frame.colour().height * scale, 3);
  for (int pass = first ? 0 : 1; pass < 2; ++pass) {
    const Timer timer;
    upscaleFrame(upscaler, model_, frame, result.pixels, [](double) { return !interrupted(); });
    seconds.wall = timer.seconds();
    stopIfInterrupted();
  }
  seconds.device = ensemble_ * deviceSeconds(upscaler);  // the profile is of the last pass, all do the same
  if (const uint64_t count = upscaler.repairs().output; count > 0)
    std::fprintf(stderr, "xrds: warning: the network of %s gave %llu pixels that were not finite and were left out.\n",
                 name_.c_str(), static_cast<unsigned long long>(count));
  return result;
}

std::vector<EngineMethod> untrainedMethods(int scale) {
  std::vector<EngineMethod> methods;
  for (const char* base : {"bicubic", "demodulated", "guided"})
    if (scale > 1 || std::string(base) == "guided")
      methods.emplace_back(base, Model::untrained(static_cast<uint32_t>(scale), base), false);
  return methods;
}

EngineMethod trainedMethod(const std::string& nameOrFile, int scale, uint32_t ensemble) {
  const std::filesystem::path file = resolveModel(nameOrFile);
  const std::string name = file.stem().string() + (ensemble > 1 ? " ensemble " + std::to_string(ensemble) : "");
  EngineMethod method(name, Model(file), true, ensemble);
  if (method.model().scale() != static_cast<uint32_t>(scale))
    throw Error("Model '" + method.name() + "' upscales by " + std::to_string(method.model().scale()) +
                ", but --scale is " + std::to_string(scale) + ": measure it at its own scale.");
  requireKnownInputs(method.model(), method.name());
  return method;
}

}  // namespace xrds
