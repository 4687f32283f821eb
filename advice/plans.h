#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "advice/render_cost.h"
#include "advice/ways.h"

namespace xrds {

/// What steps take on the user's machine, beside the renders.
struct StepSeconds {
  std::map<std::string, double> models{};  // of the full frame; ways whose model is not here are left out
  std::optional<double> denoiser{};        // of a full-resolution image; empty: there is none, as are its ways
  bool denoiserIsImported = false;         // xrds denoise runs it, else the user does
  std::optional<double> freeGuides{};      // to make clean albedo and normal; empty: ways with them are left out
};

/// A render to make and the way from it to the picture, with what both will take and give.
struct Plan {
  Way way;
  RenderSamples samples;  // 0 where the plan has no such render
  double renderSeconds = 0, afterSeconds = 0;
  double psnr = 0;  // predicted, dB

  double seconds() const { return renderSeconds + afterSeconds; }
};

/// Every plan of counts that are powers of two, as far as each way was measured (and twice as far), for a frame of
/// `pixels` full-resolution pixels, the quickest first, of equally quick ones the best.
std::vector<Plan> plansOf(const SceneFeatures& scene, const std::vector<Way>& ways, const RenderCost& cost,
                          const StepSeconds& steps, size_t pixels);

/// Of plans in the order of their seconds those than which no quicker one is as good.
std::vector<Plan> worthwhile(const std::vector<Plan>& plans);

/// The best plan of at most so many seconds, and the quickest that reaches so many dB; nothing if there is none.
std::optional<Plan> bestWithin(const std::vector<Plan>& plans, double seconds);
std::optional<Plan> quickestReaching(const std::vector<Plan>& plans, double psnr);

}  // namespace xrds
