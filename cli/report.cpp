#include "cli/report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "app/failing_with.h"
#include "cli/progress.h"
#include "image/compose.h"
#include "image/metrics/metrics.h"
#include "image/png_write.h"
#include "xrds/path_text.h"

namespace xrds {
namespace {

struct OperatorSum {
  double microseconds = 0;
  uint64_t multiplyAdds = 0, bytes = 0;
  int dispatches = 0;
};

void printRow(const char* name, const OperatorSum& sum, double total) {
  std::printf(
      "%-34s %5d %10.2f %6.1f %% %9.1f %9.1f %10.1f\n", name, sum.dispatches, sum.microseconds / 1e3,
      100 * sum.microseconds / total, 2e-3 * static_cast<double>(sum.multiplyAdds) / std::max(1e-9, sum.microseconds),
      1e-3 * static_cast<double>(sum.bytes) / std::max(1e-9, sum.microseconds), static_cast<double>(sum.bytes) / 1e6);
}

Image crop(const Image& image, int x, int y, int width, int height) {
  Image part(width, height, image.channels);
  for (int row = 0; row < height; ++row)
    std::copy_n(&image.pixels[image.index(x, y + row)], size_t(width) * image.channels,
                &part.pixels[part.index(0, row)]);
  return part;
}

}  // namespace

void printProfile(const std::vector<Upscaler::ProfileRow>& rows) {
  if (rows.empty()) {
    std::printf("profile: the device has no timestamps\n");
    return;
  }
  std::map<std::string, OperatorSum> sums;
  double total = 0;
  for (const auto& row : rows) {
    OperatorSum& sum = sums[row.program];
    sum.microseconds += row.microseconds;
    sum.multiplyAdds += row.multiplyAdds;
    sum.bytes += row.bytes;
    ++sum.dispatches;
    total += row.microseconds;
  }
  std::vector<std::pair<std::string, OperatorSum>> sorted(sums.begin(), sums.end());
  std::sort(sorted.begin(), sorted.end(),
            [](const auto& a, const auto& b) { return a.second.microseconds > b.second.microseconds; });
  std::printf("%-34s %5s %10s %8s %9s %9s %10s\n", "operator", "runs", "ms", "share", "GFLOP/s", "GB/s", "MB bound");
  for (const auto& [name, sum] : sorted) printRow(name.c_str(), sum, total);
  std::vector<Upscaler::ProfileRow> slowest = rows;
  std::sort(slowest.begin(), slowest.end(),
            [](const auto& a, const auto& b) { return a.microseconds > b.microseconds; });
  slowest.resize(std::min<size_t>(10, slowest.size()));
  std::printf("\nslowest dispatches\n");
  for (const auto& row : slowest)
    printRow(row.label.c_str(), {row.microseconds, row.multiplyAdds, row.bytes, 1}, total);
  std::printf("%-34s %5zu %10.2f\n\n", "all", rows.size(), total / 1e3);
}

std::vector<Upscaler::CheckRow> checkOnCrop(Device& device, const Model& model, const Frame& frame,
                                            const Upscaler::Options& options) {
  constexpr int kSide = 16;
  const int scale = static_cast<int>(model.scale());
  const Image& colour = frame.colour();
  const int width = std::min(kSide, colour.width), height = std::min(kSide, colour.height);
  const int x = (colour.width - width) / 2, y = (colour.height - height) / 2;
  const Image part = crop(colour, x, y, width, height);
  std::vector<Image> auxiliary;
  for (const Image& image : frame.auxiliary())
    auxiliary.push_back(crop(image, scale * x, scale * y, scale * width, scale * height));
  return Upscaler::check(device, model, viewOf(part), viewsOf(auxiliary), options);
}

int firstDivergent(const std::vector<Upscaler::CheckRow>& rows) {
  const auto first = std::find_if(rows.begin(), rows.end(), [](const auto& row) { return !row.withinBound; });
  return first == rows.end() ? -1 : static_cast<int>(first - rows.begin());
}

void printCheck(const std::vector<Upscaler::CheckRow>& rows) {
  double worst = 0;
  for (const auto& row : rows) {
    worst = std::max(worst, row.relativeRms);
    if (!row.withinBound)
      std::printf("%s: relative RMS error %.3g%s\n", row.label.c_str(), row.relativeRms,
                  row.finite ? "" : ", not finite");
  }
  if (firstDivergent(rows) < 0)
    std::printf("check: all %zu operators agree with the reference, largest relative RMS error %.3g\n", rows.size(),
                worst);
}

Image runBaseline(Device& device, const Baseline& baseline, const Image& colour, const std::vector<Image>& auxiliary,
                  int scale) {
  const Model model = Model::untrained(static_cast<uint32_t>(scale), baseline.base, baseline.transfer);
  Upscaler upscaler(device, model, static_cast<uint32_t>(colour.width), static_cast<uint32_t>(colour.height),
                    {.exposure = baseline.exposure, .tiles = baseline.tiles});
  Image result(colour.width * scale, colour.height * scale, 3);
  upscaler.run(viewOf(colour), viewsOf(auxiliary), result.pixels, [](double) { return !interrupted(); });
  stopIfInterrupted();
  return result;
}

Image readFullSize(const std::string& path, const std::string& what, int width, int height) {
  const ExrFile file = readExrHeader(pathOf(path));
  Image image = readLayer(file, findAov(file, AovRole::kColor, "", ""));
  if (image.width != width || image.height != height)
    throw Error("The " + what + " '" + path + "' is " + std::to_string(image.width) + " x " +
                std::to_string(image.height) + " pixels, expected the result's " + std::to_string(width) + " x " +
                std::to_string(height) + ".");
  const auto finite = [](float value) { return std::isfinite(value); };
  if (!std::all_of(image.pixels.begin(), image.pixels.end(), finite))
    throw Error("The " + what + " '" + path + "' has pixels that are not finite: repair it first.");
  return image;
}

Image readReference(const std::string& path, int width, int height) {
  return readFullSize(path, "reference", width, height);
}

void writeSideBySide(Device& device, const Frame& frame, const Image& result, const std::optional<Image>& reference,
                     const std::string& pngPath) {
  const int scale = result.width / frame.colour().width;
  std::vector<Image> images{
      enlargeNearest(frame.colour(), scale),
      failingWith(ExitCode::device, [&] { return runBaseline(device, {"bicubic"}, frame.colour(), {}, scale); }),
      result};
  if (reference) images.push_back(*reference);
  failingWith(ExitCode::output, [&] { writePng(pathOf(pngPath), sideBySide(images, 4)); });
}

std::vector<MeasuredImage> measureWithBaselines(Device& device, const Frame& frame, const Image& result,
                                                const Image& reference) {
  std::vector<MeasuredImage> measured;
  const auto add = [&](const char* name, const char* base, const std::vector<Image>& auxiliary) {
    const int scale = result.width / frame.colour().width;
    measured.push_back({name, measure(runBaseline(device, {base}, frame.colour(), auxiliary, scale), reference)});
  };
  add("bicubic", "bicubic", {});
  if (frame.inputs().size() >= 2 && frame.inputs()[0] == "albedo" && frame.inputs()[1] == "normal") {
    const std::vector<Image> both{frame.auxiliary()[0], frame.auxiliary()[1]};
    add("demodulated bicubic", "demodulated", both);
    add("guided", "guided", both);
  }
  measured.push_back({"xrds", measure(result, reference)});
  return measured;
}

void printMeasured(const std::vector<MeasuredImage>& images) {
  if (images.empty()) return;
  std::printf("%-22s %9s %10s %14s %8s\n", "against the reference", "PSNR dB", "RelMSE", "trimmed RelMSE", "FLIP");
  for (const auto& [name, metrics] : images)
    std::printf("%-22s %9.3f %10.5f %14.5f %8.4f\n", name.c_str(), metrics.psnr, metrics.relMse, metrics.relMseTrimmed,
                metrics.flip);
}

}  // namespace xrds
