#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "xrds/error.h"
#include "xrds/export.h"
#include "xrds/tiling.h"

namespace xrds {

/// A trained network, checked to be complete. Immutable: may be shared between threads.
class XRDS_API Model {
 public:
  /// Reads a safetensors model file. Throws Error if it is no complete, finite model of a known architecture.
  explicit Model(const std::filesystem::path& file);
  /// A model without a network, the rivals to beat: base "bicubic" (no auxiliary image), "demodulated" (albedo, normal)
  /// or "guided" (albedo, normal); transfer "log1p" or "none". Throws Error for any other name.
  static Model untrained(uint32_t scale, const std::string& base, const std::string& transfer = "log1p");
  ~Model();
  Model(Model&&) noexcept;
  Model& operator=(Model&&) noexcept;

  uint32_t scale() const;
  /// The images that go with the colour, in the order in which Upscaler::run takes them: names of kAuxiliaryInputs, of
  /// which "depth" is as relativeDepth() makes it.
  const std::vector<std::string>& auxiliaryInputs() const;
  const std::map<std::string, std::string>& metadata() const;
  /// Of the file's bytes, as 16 hexadecimal digits.
  std::string hash() const;
  std::string whyNeverSkipped() const;  // as the end of a sentence; empty if SkipOptions::bound may be set

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
  /// The tiles of an output of that size; memoryBytes 0 sets no limit here. Throws Error as cost() does, or if no tiles
  /// fit.
  Tiling tiling(uint32_t outputWidth, uint32_t outputHeight, bool fp16, const TileOptions& options,
                const std::string& kernelFamily = "tile") const;

 private:
  friend class Upscaler;
  friend struct Tuning;
  struct State;
  explicit Model(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace xrds
