#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "xrds/call.h"
#include "xrds/tiling.h"
#include "xrds/xrds_report.h"

namespace xrds {

/// A trained network, checked to be complete. Immutable: may be shared between threads.
class Model {
 public:
  /// Reads a safetensors model file, or a shipped model by its name, as "xrds-x4-compact". Throws Error if it is no
  /// complete, finite model of a known architecture; of an unknown name it lists the shipped models.
  explicit Model(const std::filesystem::path& file);
  /// A model without a network, the rivals to beat: base "bicubic" (no auxiliary image), "demodulated" (albedo, normal)
  /// or "guided" (albedo, normal); transfer "log1p" or "none". Throws Error for any other name.
  static Model untrained(uint32_t scale, const std::string& base, const std::string& transfer = "log1p");

  uint32_t scale() const { return xrdsGetModelScale(handle()); }
  /// The images that go with the colour, in the order in which Upscaler::run takes them: names of kAuxiliaryInputs, of
  /// which "depth" is as relativeDepth() makes it.
  const std::vector<std::string>& auxiliaryInputs() const { return inputs_; }
  const std::map<std::string, std::string>& metadata() const { return metadata_; }
  /// Of the file's bytes, as 16 hexadecimal digits.
  std::string hash() const { return xrdsGetModelHash(handle()); }
  std::string whyNeverSkipped() const {
    return xrdsWhyNeverSkipped(handle());
  }  // as the end of a sentence; empty if SkipOptions::bound may be set

  /// What an output of width x height pixels costs in one piece. `networkMultiplyAdds` is the count of papers: linear
  /// maps and convolutions of the network as it is written, without the token pairs of attention. All else is of what
  /// devices run, which join maps: multiply-adds of maps and, beside them, of token pairs; device memory, of which
  /// `plannedBytes` is the arena, `lowerBoundBytes` the largest set of values alive at once, `unaliasedBytes` the sum
  /// of all.
  struct Cost {
    uint64_t parameters = 0, networkMultiplyAdds = 0;
    uint64_t multiplyAdds = 0, attentionMultiplyAdds = 0;
    uint64_t plannedBytes = 0, lowerBoundBytes = 0, unaliasedBytes = 0, weightBytes = 0;
  };
  /// A pure question, no device needed, only its kernels: one of Device::kernelFamilies(). Throws Error if there is no
  /// such family or no frame of that size.
  Cost cost(uint32_t outputWidth, uint32_t outputHeight, bool fp16, const std::string& kernelFamily = "tile") const;
  /// The tiles of an output of that size; memoryBytes 0 sets no limit here. Throws Error as cost() does, OutOfMemory
  /// if no tiles fit.
  Tiling tiling(uint32_t outputWidth, uint32_t outputHeight, bool fp16, const TileOptions& options,
                const std::string& kernelFamily = "tile") const;

  /// For the functions of the C API; valid as long as the model lives.
  XrdsModel* handle() const { return handle_.get(); }

 private:
  explicit Model(call::Owned<XrdsModel> opened);

  call::Owned<XrdsModel> handle_;
  std::vector<std::string> inputs_;
  std::map<std::string, std::string> metadata_;
};

inline Model::Model(call::Owned<XrdsModel> opened) : handle_(std::move(opened)) {
  for (uint32_t i = 0; const char* input = xrdsGetModelInput(handle(), i); ++i) inputs_.emplace_back(input);
  for (uint32_t i = 0; const char* key = xrdsGetModelMetadataKey(handle(), i); ++i)
    metadata_.emplace(key, xrdsGetModelMetadata(handle(), key));
}

inline Model::Model(const std::filesystem::path& file)
    : Model([&] {
        XrdsModel* opened = nullptr;
        call::check(xrdsOpenModel(call::text(file).c_str(), &opened));
        return call::Owned<XrdsModel>(opened);
      }()) {}

inline Model Model::untrained(uint32_t scale, const std::string& base, const std::string& transfer) {
  XrdsModel* made = nullptr;
  call::check(xrdsCreateUntrainedModel(scale, base.c_str(), transfer.c_str(), &made));
  return Model(call::Owned<XrdsModel>(made));
}

inline Model::Cost Model::cost(uint32_t outputWidth, uint32_t outputHeight, bool fp16,
                               const std::string& kernelFamily) const {
  auto found = call::sized<XrdsModelCost>();
  call::check(xrdsGetModelCost(handle(), outputWidth, outputHeight, fp16, kernelFamily.c_str(), &found));
  return {.parameters = found.parameters,
          .networkMultiplyAdds = found.networkMultiplyAdds,
          .multiplyAdds = found.multiplyAdds,
          .attentionMultiplyAdds = found.attentionMultiplyAdds,
          .plannedBytes = found.plannedBytes,
          .lowerBoundBytes = found.lowerBoundBytes,
          .unaliasedBytes = found.unaliasedBytes,
          .weightBytes = found.weightBytes};
}

inline Tiling Model::tiling(uint32_t outputWidth, uint32_t outputHeight, bool fp16, const TileOptions& options,
                            const std::string& kernelFamily) const {
  XrdsUpscalerOptions asked = xrdsUpscalerOptionsDefault();
  options.fill(asked);
  asked.fp16 = fp16;
  auto found = call::sized<XrdsTiling>();
  call::check(xrdsPlanTiles(handle(), outputWidth, outputHeight, &asked, kernelFamily.c_str(), &found));
  return Tiling::of(found);
}

}  // namespace xrds
