#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "shaders/common/transfer.h"

namespace xrds {

/// The image that the network's output is added to (none: the paper).
enum class BaseImage : uint8_t { none, bicubic, demodulated, guided };

/// What the B blocks of a group are: the paper's dense Swin blocks, plain Swin blocks, or dense convolutions.
enum class BlockKind : uint8_t { rdst, rstb, rdb };

/// How a group joins colour and auxiliary features: by the cross module XM, or by a 1x1 convolution of both.
enum class CrossKind : uint8_t { attention, concat };

/// What is taken of the change that a network makes in a colour that was denoised before, percent: of d to y',
/// y = d + darker / 100 min(y' - d, 0) + brighter / 100 max(y' - d, 0), in linear radiance.
struct Restraint {
  uint32_t darker = 100, brighter = 100;
  bool isAny() const { return darker < 100 || brighter < 100; }
};

/// How frames that are no multiple of the window are padded: to whole windows by edge replication or by reflection, or
/// their rows alone to whole windows, by edge replication.
enum class Padding : uint8_t { edge, reflection, columns };

using Metadata = std::map<std::string, std::string>;

/// Every symbol of a network, as the metadata of a model file states it. The letters are Hou & Liu's; what another
/// architecture does not have says so: no inputs, no kernels, no base image.
struct NetworkConfig {
  uint32_t scale = 4;                                      // s
  uint32_t channels = 64;                                  // C
  uint32_t auxChannels = 32;                               // Ca
  std::vector<std::string> auxInputs{"albedo", "normal"};  // three channels each
  uint32_t groups = 3;                                     // N; 0: no network, the base image alone
  uint32_t blocks = 5;                                     // B
  uint32_t window = 8;                                     // w
  uint32_t headChannels = 32;                              // d
  Transfer transfer = Transfer::log1p;
  BaseImage base = BaseImage::guided;
  BlockKind block = BlockKind::rdst;
  CrossKind cross = CrossKind::attention;
  uint32_t kernels = 0;        // side of the learned kernels, 0 or 5
  bool auxSkip = false;        // H_N is fed to the output convolution
  uint32_t auxKernels = 0;     // side of the learned kernels that filter the auxiliary images; 0, 3 or 5
  uint32_t colourKernels = 0;  // the same of those that filter the full-resolution colour
  uint32_t prefilter = 0;      // levels of the filter of the low-resolution colour, 0 to 3
  uint32_t outputSide = 3;     // of the output convolution, 3 or 1
  Padding padding = Padding::edge;
  Restraint restraint{};                      // of a model that may stand behind a denoiser
  bool behindDenoiser = false;                // whether it does: no field of the file
  std::string architecture = "xrds";          // see network/architecture.h
  std::map<std::string, uint32_t> symbols{};  // numbers that only this architecture has

  uint32_t auxWidth() const { return 3 * static_cast<uint32_t>(auxInputs.size()); }  // A
  /// Channels of the raw output: the residual, the logits of the kernels, those of the auxiliary images' kernels, those
  /// of the full-resolution colour's kernels and, last, of its share.
  uint32_t outputWidth() const {
    return firstColourLogit() + colourKernels * colourKernels + (colourKernels > 0 ? 1 : 0);
  }
  uint32_t firstAuxLogit() const { return 3 + kernels * kernels; }
  uint32_t firstColourLogit() const { return firstAuxLogit() + auxKernels * auxKernels; }
  uint32_t prefilterLogits() const { return 25 * prefilter; }
  uint32_t symbol(const std::string& name) const;  // of symbols; 0: not there
  uint32_t steps() const;                          // n = log2 s
  int auxOffset(std::string_view name) const;      // first channel of that input; -1: the model has none
  std::vector<size_t> radianceInputs() const;      // which of auxInputs are radiance
  bool demodulates() const { return base == BaseImage::demodulated || base == BaseImage::guided; }
  /// Whether tiles, which begin at windows, begin at multiples of four pixels too: Conv3x3::inFours.
  bool mayRoundInFours() const { return window % 4 == 0; }
};

/// Reads the fields of a model file's metadata, as its architecture has them. Throws Error that names a missing or bad
/// field, or a combination that makes no network.
NetworkConfig parseConfig(const Metadata& metadata);

/// The metadata fields that describe the network, parseConfig's inverse.
Metadata describe(const NetworkConfig& config);

}  // namespace xrds
