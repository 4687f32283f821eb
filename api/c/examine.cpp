// Whether a device computes what it should, and its fastest kernels.
#include <cstring>

#include "api/c/handles.h"
#include "api/c/result.h"
#include "api/c/sized.h"
#include "api/c/text.h"
#include "api/examination.h"
#include "api/tuning.h"
#include "checks/stress/stress.h"
#include "xrds/stress.h"
#include "xrds/xrds_examine.h"

using namespace xrds::c;

namespace {

xrds::Precision precisionOf(int32_t fp16) { return fp16 ? xrds::Precision::fp16 : xrds::Precision::fp32; }

// Calls `action` with the device, which no other call uses meanwhile.
template <class Action>
XrdsResult withDevice(XrdsDevice* device, const Action& action) {
  return guarded([&] {
    const auto found = Devices::open().opened(device, "device");
    const std::lock_guard lock(found->access);
    action(found->gpu);
    return XRDS_OK;
  });
}

// Lists go to C as pointers, so that a program with an older header finds the next one, whatever the size.
template <class T>
std::vector<const T*> pointersTo(const std::vector<T>& rows) {
  std::vector<const T*> pointers;
  for (const T& row : rows) pointers.push_back(&row);
  return pointers;
}

std::vector<const char*> textsOf(const std::vector<std::string>& texts) {
  std::vector<const char*> pointers;
  for (const std::string& text : texts) pointers.push_back(text.c_str());
  return pointers;
}

void tellTuning(const xrds::Tuning::Report& report, XrdsHearTuning hear, void* user) {
  std::vector<std::vector<const char*>> wrong;
  std::vector<XrdsTunedShape> shapes;
  std::vector<XrdsStruckOff> struckOff;
  for (const xrds::Tuning::Shape& shape : report.shapes) {
    wrong.push_back(textsOf(shape.wrong));
    shapes.push_back({.structSize = sizeof(XrdsTunedShape),
                      .nodes = shape.nodes,
                      .name = shape.name.c_str(),
                      .kernel = shape.kernel.c_str(),
                      .fixed = shape.fixed.c_str(),
                      .seconds = shape.seconds,
                      .fixedSeconds = shape.fixedSeconds,
                      .tried = shape.tried,
                      .wrong = wrong.back().data(),
                      .wrongCount = static_cast<uint32_t>(wrong.back().size())});
  }
  for (const xrds::Tuning::StruckOff& struck : report.struckOff)
    struckOff.push_back({sizeof(XrdsStruckOff), struck.program.c_str(), struck.why.c_str()});
  const auto shapeList = pointersTo(shapes);
  const auto struckList = pointersTo(struckOff);
  const XrdsTuningReport told{.structSize = sizeof told,
                              .taken = report.taken,
                              .normsInLinear = report.normsInLinear,
                              .layersFused = report.layersFused,
                              .seconds = report.seconds,
                              .fixedSeconds = report.fixedSeconds,
                              .tuningSeconds = report.tuningSeconds,
                              .date = report.date,
                              .measured = report.measured,
                              .shapes = shapeList.data(),
                              .struckOff = struckList.data(),
                              .shapeCount = static_cast<uint32_t>(shapes.size()),
                              .struckOffCount = static_cast<uint32_t>(struckOff.size()),
                              .unkept = report.unkept.empty() ? nullptr : report.unkept.c_str()};
  hear(user, &told);
}

XrdsStressRow stressRow(const xrds::StressRow& row, const std::vector<const char*>& promoted) {
  return {.structSize = sizeof(XrdsStressRow),
          .model = row.model.c_str(),
          .weights = row.weights.c_str(),
          .precision = row.precision.c_str(),
          .family = row.family.c_str(),
          .worstInput = row.worstInput.c_str(),
          .firstDegraded = row.firstDegraded.c_str(),
          .promoted = promoted.data(),
          .promotedCount = static_cast<uint32_t>(promoted.size()),
          .bounded = row.bounded,
          .replaysExactly = row.replaysExactly,
          .bandsExactly = row.bandsExactly,
          .tilesExactly = row.tilesExactly,
          .cases = row.cases,
          .nonFiniteOutputs = row.nonFiniteOutputs,
          .casesInParts = row.casesInParts,
          .repairedPixels = row.repairedPixels,
          .lostPixels = row.lostPixels,
          .naturalCases = row.naturalCases,
          .litFromBlack = row.litFromBlack,
          .worstError = row.worstError,
          .worstScaling = row.worstScaling,
          .worstSkip = row.worstSkip};
}

void tellStress(const xrds::StressReport& report, XrdsHearStress hear, void* user) {
  const auto colours = textsOf(report.colours), auxiliaries = textsOf(report.auxiliaries);
  std::vector<std::vector<const char*>> promoted;
  std::vector<XrdsStressRow> rows;
  std::vector<XrdsStressOperator> operators;
  for (const xrds::StressRow& row : report.rows) {
    promoted.push_back(textsOf(row.promoted));
    rows.push_back(stressRow(row, promoted.back()));
  }
  for (const xrds::StressOperator& op : report.operators)
    operators.push_back({sizeof(XrdsStressOperator), op.name.c_str(), op.precision.c_str(), op.family.c_str(),
                         op.where.c_str(), op.worstError, op.budget});
  const auto rowList = pointersTo(rows);
  const auto operatorList = pointersTo(operators);
  const XrdsStressReport told{.structSize = sizeof told,
                              .seed = report.seed,
                              .fp32Bound = report.fp32Bound,
                              .fp16Bound = report.fp16Bound,
                              .fp32ScalingBound = report.fp32ScalingBound,
                              .fp16ScalingBound = report.fp16ScalingBound,
                              .colours = colours.data(),
                              .auxiliaries = auxiliaries.data(),
                              .colourCount = static_cast<uint32_t>(colours.size()),
                              .auxiliaryCount = static_cast<uint32_t>(auxiliaries.size()),
                              .rowCount = static_cast<uint32_t>(rows.size()),
                              .operatorCount = static_cast<uint32_t>(operators.size()),
                              .rows = rowList.data(),
                              .operators = operatorList.data()};
  hear(user, &told);
}

}  // namespace

XrdsResult xrdsGetDeviceCapabilities(XrdsDevice* device, XrdsDeviceCapabilities* capabilities) {
  return withDevice(device, [&](const xrds::Gpu& gpu) {
    const xrds::DeviceCapabilities found = xrds::capabilitiesOf(gpu);
    XrdsDeviceCapabilities out{.structSize = sizeof out,
                               .matrixTrusted = found.matrixTrusted,
                               .subgroupSize = found.subgroupSize,
                               .int64 = found.int64,
                               .timestamps = found.timestamps,
                               .maxBindingBytes = found.maxBindingBytes,
                               .maxTensorTexels = found.maxTensorTexels};
    setText(out.kernelFamily, found.kernelFamily);
    setText(out.matrixUnits, found.matrixUnits);
    give(out, required(capabilities, "capabilities"));
  });
}

XrdsResult xrdsExamineKernels(XrdsDevice* device, int32_t fp16, uint32_t runs, XrdsHearKernel hear, void* user) {
  return withDevice(device, [&](xrds::Gpu& gpu) {
    required(hear, "hear");
    for (const xrds::KernelExamination& kernel : xrds::examineKernels(gpu, precisionOf(fp16), runs)) {
      const XrdsKernelExamination told{.structSize = sizeof told,
                                       .program = kernel.program.c_str(),
                                       .node = kernel.node.c_str(),
                                       .shapes = kernel.shapes.c_str(),
                                       .rms = kernel.rms,
                                       .max = kernel.max,
                                       .rmsBound = kernel.rmsBound,
                                       .maxBound = kernel.maxBound,
                                       .finite = kernel.finite,
                                       .repeatable = kernel.repeatable,
                                       .microseconds = kernel.microseconds};
      hear(user, &told);
    }
  });
}

XrdsResult xrdsExamineKnownFrame(XrdsDevice* device, int32_t fp16, uint32_t runs, XrdsFrameExamination* frame) {
  return withDevice(device, [&](xrds::Gpu& gpu) {
    const xrds::FrameExamination found = xrds::examineKnownFrame(gpu, precisionOf(fp16), runs);
    give<XrdsFrameExamination>({.structSize = sizeof(XrdsFrameExamination),
                                .width = found.width,
                                .height = found.height,
                                .finite = found.finite,
                                .repeatable = found.repeatable,
                                .rms = found.rms,
                                .rmsBound = found.rmsBound,
                                .microseconds = found.microseconds},
                               required(frame, "frame"));
  });
}

XrdsResult xrdsTune(XrdsDevice* device, const XrdsModel* model, uint32_t width, uint32_t height,
                    const XrdsTuningOptions* options, XrdsHearTuning hear, void* user) {
  return withDevice(device, [&](xrds::Gpu& gpu) {
    const auto of = Models::open().opened(model, "model");
    required(hear, "hear");
    const XrdsTuningOptions given = options ? taken(*options) : XrdsTuningOptions{};
    xrds::Tuning::Options asked{.fp16 = given.fp16 != 0, .label = textOf(given.label), .anew = given.anew != 0};
    if (given.progress)
      asked.progress = [&](double share, const std::string& text) {
        return given.progress(given.user, share, text.c_str()) != 0;
      };
    tellTuning(xrds::tuneFor(gpu, of->model, width, height, asked), hear, user);
  });
}

XrdsResult xrdsGetTuning(XrdsDevice* device, const XrdsModel* model, uint32_t width, uint32_t height, int32_t fp16,
                         XrdsHearTuning hear, void* user) {
  return withDevice(device, [&](const xrds::Gpu& gpu) {
    const auto of = Models::open().opened(model, "model");
    required(hear, "hear");
    if (const auto known = xrds::tuningFor(gpu, of->model, width, height, fp16 != 0)) tellTuning(*known, hear, user);
  });
}

XrdsResult xrdsDescribeTuning(XrdsDevice* device, XrdsMessage hear, void* user) {
  return withDevice(device, [&](const xrds::Gpu& gpu) {
    required(hear, "hear");
    for (const std::string& line : xrds::tuningSummary(gpu)) hear(user, line.c_str());
  });
}

XrdsStressOptions xrdsStressOptionsDefault() {
  return {.structSize = sizeof(XrdsStressOptions), .randomModels = 1, .seed = 1};
}

XrdsResult xrdsStress(XrdsDevice* device, const XrdsStressOptions* options, XrdsHearStress hear, void* user) {
  return withDevice(device, [&](xrds::Gpu& gpu) {
    required(hear, "hear");
    const XrdsStressOptions usual = xrdsStressOptionsDefault(), given = options ? taken(*options, usual) : usual;
    xrds::StressOptions asked{
        .randomModels = given.randomModels != 0, .seed = given.seed, .shortForm = given.shortForm != 0};
    if (given.progress) asked.progress = [&](double share) { return given.progress(given.user, share) != 0; };
    std::vector<xrds::StressModel> models;
    for (uint32_t i = 0; i < given.modelCount; ++i) {
      const std::string name = &required((&required(given.names, "names"))[i], "names");
      const XrdsModel* const model = (&required(given.models, "models"))[i];
      if (!model)
        throw xrds::InvalidArgument("Model '" + name + "' of a stress run is a null pointer, expected a model.");
      models.push_back({name, Models::open().opened(model, "model")->model, true});
    }
    tellStress(xrds::runStress(gpu, models, asked), hear, user);
  });
}
