#include "cli/bench/skip_report.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/listed.h"
#include "app/skip_bound.h"
#include "cli/bench/quantile.h"
#include "cli/json_text.h"
#include "cli/table.h"

namespace xrds {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::pair<const char*, const char*> kDefinitions[] = {
    {"skipped", "the share of the windows that were interpolated without the network"},
    {"work", "pixels computed, with the surroundings that are needed, over pixels of the frame"},
    {"secondsOff",
     "without skipping, a number for each pair of runs, from the upload of the images to the download of "
     "the result; with cpuTime what all threads of the process took of the cores"},
    {"seconds", "the same with skipping"},
    {"faster", "the median over the pairs of secondsOff over seconds"},
    {"psnrOff", "without skipping, against the reference, dB; psnr is that with skipping"},
    {"largestChange",
     "root mean square over the pixels and channels of a window of the change of log(1 + exposure radiance), the "
     "largest of the windows that were skipped, and of the others"},
    {"cost", "time with skipping over that without, of all pairs of the scenes in which nothing was skipped"},
};

// The first of each pair over the second.
std::vector<double> ratios(const std::vector<double>& first, const std::vector<double>& second) {
  std::vector<double> result;
  for (size_t i = 0; i < first.size(); ++i) result.push_back(first[i] / second[i]);
  return result;
}

double skippedShare(const SkipMeasurement& made) { return made.map.share(SkipMap::Window::interpolated); }
double faster(const SkipMeasurement& made) { return median(ratios(made.secondsOff, made.seconds)); }

double largestChange(const SkipReport& report) {
  double largest = 0;
  for (const SkipMeasurement& made : report.scenes)
    largest = std::max({largest, made.change.interpolated, made.change.computed});
  return largest;
}

double boundOf(const SkipReport& report) { return static_cast<double>(parseSkip(report.skip)); }

// What skipping costs where it does not find a window to skip: of each pair the time with it over that without.
std::vector<double> costs(const SkipReport& report) {
  std::vector<double> slower;
  for (const SkipMeasurement& made : report.scenes) {
    if (made.map.work != 1) continue;
    const std::vector<double> pairs = ratios(made.seconds, made.secondsOff);
    slower.insert(slower.end(), pairs.begin(), pairs.end());
  }
  return slower;
}

std::vector<Row> rowsOf(const SkipReport& report) {
  std::vector<Row> rows{
      {"scene", "skipped", "work", "s off", "s skip", "faster", "PSNR off", "change dB", "skipped windows", "others"}};
  for (const SkipMeasurement& made : report.scenes)
    rows.push_back({made.scene, text("%.1f %%", 100 * skippedShare(made)), text("%.1f %%", 100 * made.map.work),
                    text("%.3f", median(made.secondsOff)), text("%.3f", median(made.seconds)),
                    text("%.3f", faster(made)), text("%.3f", made.psnrOff), text("%+.4f", made.psnr - made.psnrOff),
                    text("%.5f", made.change.interpolated), text("%.5f", made.change.computed)});
  return rows;
}

Json jsonOf(const SkipMeasurement& made) {
  return {{"name", made.scene},
          {"windows", made.map.windows.size()},
          {"skipped", skippedShare(made)},
          {"work", made.map.work},
          {"secondsOff", made.secondsOff},
          {"seconds", made.seconds},
          {"medianSecondsOff", median(made.secondsOff)},
          {"medianSeconds", median(made.seconds)},
          {"faster", faster(made)},
          {"psnrOff", made.psnrOff},
          {"psnr", made.psnr},
          {"largestChange", {{"skipped", made.change.interpolated}, {"others", made.change.computed}}}};
}

}  // namespace

std::string plainText(const SkipReport& report) {
  const double worst = largestChange(report), bound = boundOf(report);
  std::string lines = report.run.folder + ", --skip " + report.skip + " (bound " + text("%g", bound) + "), model " +
                      report.run.model + " (" + report.run.precision + "), " + report.run.device.name + ": median of " +
                      counted(report.runs, "pair") + " of runs" + (report.cpuTime ? ", CPU time" : "") + "\n\n" +
                      aligned(rowsOf(report)) + "\nLargest change of a window " + text("%.5f", worst) + ": the bound " +
                      (worst <= bound ? "holds" : "does not hold") + ".\n";
  if (const std::vector<double> slower = costs(report); !slower.empty())
    lines += "Where nothing is skipped: " + counted(slower.size(), "pair") +
             " of runs, time with --skip over that without: median " + text("%.4f", median(slower)) + ", quartiles " +
             text("%.4f", quantile(slower, 0.25)) + " and " + text("%.4f", quantile(slower, 0.75)) + ".\n";
  return lines;
}

std::string markdownText(const SkipReport& report) { return markdown(rowsOf(report)); }

std::string jsonText(const SkipReport& report) {
  Json json = jsonOf(report.run, kDefinitions);
  json["runs"] = report.runs;
  json["cpuTime"] = report.cpuTime;
  json["bound"] = boundOf(report);
  json["scenes"] = Json::array();
  for (const SkipMeasurement& made : report.scenes) json["scenes"].push_back(jsonOf(made));
  json["largestChange"] = largestChange(report);
  if (const std::vector<double> slower = costs(report); !slower.empty())
    json["cost"] = {{"pairs", slower.size()},
                    {"median", median(slower)},
                    {"lowerQuartile", quantile(slower, 0.25)},
                    {"upperQuartile", quantile(slower, 0.75)}};
  return textOf(json);
}

}  // namespace xrds
