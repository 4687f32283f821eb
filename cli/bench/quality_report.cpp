#include "cli/bench/quality_report.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/listed.h"
#include "cli/bench/quantile.h"
#include "cli/json_text.h"
#include "cli/metric_columns.h"
#include "cli/table.h"
#include "xrds/path_text.h"

namespace xrds {
namespace {

/// The scenes on which a method gains most and least PSNR over guided.
struct Extremes {
  size_t best = 0, worst = 0;
  std::vector<double> gains;
};

// Nothing for guided itself.
std::optional<Extremes> extremesOf(const QualityReport& report, const MethodQuality& method) {
  const MethodQuality* guided = report.guided();
  if (guided == nullptr || guided == &method) return {};
  Extremes found;
  for (size_t i = 0; i < method.scenes.size(); ++i)
    found.gains.push_back(method.scenes[i].metrics.psnr - guided->scenes[i].metrics.psnr);
  const auto [least, most] = std::minmax_element(found.gains.begin(), found.gains.end());
  found.worst = least - found.gains.begin();
  found.best = most - found.gains.begin();
  return found;
}

std::string caption(const QualityReport& report) {
  const QualitySetting& setting = report.setting;
  const auto average = setting.averageSamples();
  bool deviceTime = true;
  for (const MethodQuality& method : report.methods)
    for (const SceneQuality& scene : method.scenes)
      if (scene.seconds && scene.seconds->device <= 0) deviceTime = false;
  const std::filesystem::path folder = pathOf(report.folder);
  return "Scale " + std::to_string(setting.scale) + ", colour at " + std::to_string(setting.colourSamples) +
         " samples a pixel" + (setting.mergesColour ? ", merged with that of the full-resolution render" : "") +
         (setting.denoisedBy.empty() ? "" : ", denoised first by " + setting.denoisedBy) + ", albedo and normal " +
         (setting.auxSamples ? "at " + setting.auxText() + ": average samples " + text("%g", *average) : "converged") +
         ". " + counted(report.sceneNames.size(), "scene") + " of " +
         (folder.has_filename() ? folder : folder.parent_path()).filename().string() +
         (report.skipped.empty() ? "" : ", " + std::to_string(report.skipped.size()) + " skipped for missing files") +
         "; " + report.precision + " on " + report.device + "; seconds: median of the scenes, steady " +
         (deviceTime ? "device" : "wall clock") + " time.";
}

std::vector<Row> sceneRows(const QualityReport& report) {
  std::vector<Row> rows{{"PSNR dB (to guided) / RelMSE"}};
  for (const MethodQuality& method : report.methods) rows[0].push_back(method.name);
  for (size_t i = 0; i < report.sceneNames.size(); ++i) {
    Row& row = rows.emplace_back(Row{report.sceneNames[i]});
    for (const MethodQuality& method : report.methods) {
      const Metrics& metrics = method.scenes[i].metrics;
      const auto extremes = extremesOf(report, method);
      row.push_back(text("%.2f", metrics.psnr) + (extremes ? text(" (%+.2f)", extremes->gains[i]) : "") +
                    text(" / %.4f", metrics.relMse));
    }
  }
  return rows;
}

std::vector<Row> meanRows(const QualityReport& report) {
  std::vector<Row> rows{{"mean"}};
  for (const MetricColumn& column : metricColumns()) rows[0].emplace_back(column.title);
  rows[0].insert(rows[0].begin() + 2, "to guided");
  rows[0].insert(rows[0].end(), {"seconds", "best to guided", "worst to guided"});
  for (const MethodQuality& method : report.methods) {
    const Metrics mean = method.mean();
    Row row{method.name};
    for (const MetricColumn& column : metricColumns()) row.push_back(text(column.format, mean.*column.field));
    const auto extremes = extremesOf(report, method);
    const auto shown = [&](size_t i) { return report.sceneNames[i] + text(" %+.2f", extremes->gains[i]); };
    row.insert(row.begin() + 2, extremes ? text("%+.3f", mean.psnr - report.guided()->mean().psnr) : "-");
    row.push_back(method.medianSeconds() ? text("%.3f", *method.medianSeconds()) : "-");
    row.push_back(extremes ? shown(extremes->best) : "-");
    row.push_back(extremes ? shown(extremes->worst) : "-");
    rows.push_back(std::move(row));
  }
  return rows;
}

nlohmann::ordered_json jsonOf(const QualityReport& report, const MethodQuality& method) {
  nlohmann::ordered_json json{{"name", method.name}};
  if (!method.model.empty()) json["modelHash"] = method.model;
  json["mean"] = jsonOf(method.mean());
  if (method.medianSeconds()) json["medianSeconds"] = *method.medianSeconds();
  const auto extremes = extremesOf(report, method);
  if (extremes) {
    json["psnrToGuided"] = method.mean().psnr - report.guided()->mean().psnr;
    json["best"] = report.sceneNames[extremes->best];
    json["worst"] = report.sceneNames[extremes->worst];
  }
  for (size_t i = 0; i < method.scenes.size(); ++i) {
    auto scene = jsonOf(method.scenes[i].metrics);
    if (extremes) scene["psnrToGuided"] = extremes->gains[i];
    if (const auto& seconds = method.scenes[i].seconds) {
      if (seconds->device > 0) scene["deviceSeconds"] = seconds->device;
      scene["wallSeconds"] = seconds->wall;
    }
    json["scenes"][report.sceneNames[i]] = std::move(scene);
  }
  return json;
}

}  // namespace

Metrics MethodQuality::mean() const {
  Metrics sum;
  for (const MetricColumn& column : metricColumns()) {
    for (const SceneQuality& scene : scenes) sum.*column.field += scene.metrics.*column.field;
    sum.*column.field /= static_cast<double>(scenes.size());
  }
  return sum;
}

std::optional<double> MethodQuality::medianSeconds() const {
  std::vector<double> times;
  for (const SceneQuality& scene : scenes)
    if (scene.seconds) times.push_back(scene.seconds->best());
  if (times.empty()) return {};
  return median(times);
}

const MethodQuality* QualityReport::guided() const {
  const auto found = std::find_if(methods.begin(), methods.end(), [](const auto& m) { return m.name == "guided"; });
  return found == methods.end() ? nullptr : &*found;
}

std::string plainText(const QualityReport& report) {
  return caption(report) + "\n\n" + aligned(sceneRows(report)) + "\n" + aligned(meanRows(report));
}

std::string markdownText(const QualityReport& report) {
  return caption(report) + "\n\n" + markdown(sceneRows(report)) + "\n" + markdown(meanRows(report));
}

std::string jsonText(const QualityReport& report) {
  const QualitySetting& setting = report.setting;
  nlohmann::ordered_json json{{"version", XRDS_VERSION},
                              {"folder", report.folder},
                              {"scale", setting.scale},
                              {"colourSamples", setting.colourSamples},
                              {"mergedColour", setting.mergesColour},
                              {"denoisedBy", nullptr},
                              {"auxSamples", nullptr},
                              {"averageSamples", nullptr},
                              {"precision", report.precision},
                              {"device", report.device},
                              {"definitions", metricDefinitions()},
                              {"skipped", report.skipped},
                              {"methods", nlohmann::ordered_json::array()}};
  if (!setting.denoisedBy.empty()) json["denoisedBy"] = setting.denoisedBy;
  if (setting.auxSamples) json["auxSamples"] = *setting.auxSamples;
  if (const auto average = setting.averageSamples()) json["averageSamples"] = *average;
  for (const MethodQuality& method : report.methods) json["methods"].push_back(jsonOf(report, method));
  return textOf(json);
}

}  // namespace xrds
