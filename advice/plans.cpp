#include "advice/plans.h"

#include <algorithm>
#include <utility>

namespace xrds {
namespace {

constexpr int kMostSamples = 4096;
constexpr double kBeyond = 1;  // octaves of noise over what was measured

bool isMeasured(const Way& way, const SceneFeatures& scene, RenderSamples samples) {
  const double noise = way.noiseLeft(scene, samples);
  return noise >= way.leastNoise - kBeyond && noise <= way.mostNoise + kBeyond;
}

// The counts of a way: powers of two of one render, and of the other what the measured ratios give.
std::vector<RenderSamples> countsOf(const Way& way) {
  std::vector<RenderSamples> counts;
  for (int power = 1; power <= kMostSamples; power *= 2) {
    const double count = power;
    if (way.scale == 1)
      counts.push_back({0, count});
    else if (way.guides == Guides::free)
      counts.push_back({count, 0});
    else
      for (const double ratio : way.ratios) counts.push_back({ratio * count, count});
  }
  return counts;
}

// Of the denoiser's, which takes albedo, normal and colour of a full-resolution image.
double denoisedPixels(const Way& way, double pixels) {
  if (way.model.empty()) return pixels;
  if (!way.denoisesFirst) return 0;
  const double images =
      (way.guides == Guides::free ? 0 : 2) + (way.takesFullColour ? 1 : 0) + 1.0 / (way.scale * way.scale);
  return images * pixels / 3;
}

double renderSeconds(const Way& way, const RenderCost& cost, const StepSeconds& steps, RenderSamples samples,
                     size_t pixels) {
  double seconds = way.guides == Guides::free ? *steps.freeGuides : 0;
  if (samples.low > 0) seconds += cost.seconds(samples.low, pixels / static_cast<size_t>(way.scale * way.scale));
  if (samples.full > 0) seconds += cost.seconds(samples.full, pixels);
  return seconds;
}

bool isPossible(const Way& way, const StepSeconds& steps) {
  return (way.model.empty() || steps.models.contains(way.model)) && (!way.needsDenoiser() || steps.denoiser) &&
         (way.guides == Guides::rendered || steps.freeGuides);
}

}  // namespace

std::vector<Plan> plansOf(const SceneFeatures& scene, const std::vector<Way>& ways, const RenderCost& cost,
                          const StepSeconds& steps, size_t pixels) {
  std::vector<Plan> plans;
  for (const Way& way : ways) {
    if (!isPossible(way, steps)) continue;
    double after = way.model.empty() ? 0 : steps.models.at(way.model);
    if (way.needsDenoiser())
      after += *steps.denoiser * denoisedPixels(way, static_cast<double>(pixels)) / static_cast<double>(pixels);
    for (const RenderSamples samples : countsOf(way))
      if (isMeasured(way, scene, samples))
        plans.push_back(
            {way, samples, renderSeconds(way, cost, steps, samples, pixels), after, way.predictedPsnr(scene, samples)});
  }
  std::sort(plans.begin(), plans.end(), [](const Plan& a, const Plan& b) {
    return std::pair(a.seconds(), -a.psnr) < std::pair(b.seconds(), -b.psnr);
  });
  return plans;
}

std::vector<Plan> worthwhile(const std::vector<Plan>& plans) {
  std::vector<Plan> front;
  for (const Plan& plan : plans)
    if (front.empty() || plan.psnr > front.back().psnr) front.push_back(plan);
  return front;
}

std::optional<Plan> bestWithin(const std::vector<Plan>& plans, double seconds) {
  std::optional<Plan> best;
  for (const Plan& plan : worthwhile(plans))
    if (plan.seconds() <= seconds) best = plan;
  return best;
}

std::optional<Plan> quickestReaching(const std::vector<Plan>& plans, double psnr) {
  for (const Plan& plan : plans)
    if (plan.psnr >= psnr) return plan;
  return {};
}

}  // namespace xrds
