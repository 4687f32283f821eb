#pragma once

#include <memory>

#include "frames/frame_runner.h"
#include "network/network_model.h"
#include "xrds/upscaler.h"

namespace xrds {

/// How a frame is made ready on a device: kernels, memory and tiles.

/// The options of its sessions, with the kernels that a tuning found.
SessionOptions sessionOptions(const Gpu& gpu, const NetworkModel& model, FrameShape frame,
                              const Upscaler::Options& options);

/// Upscaler::paysToTune().
bool tuningPays(const Gpu& gpu, const NetworkModel& model, FrameShape frame, Precision precision);

/// Tunes the kernels where the options ask for that, before the frame holds any memory of the device. A frame that the
/// memory refuses is refused at once. Throws Error.
void tuneIfAsked(Gpu& gpu, const NetworkModel& model, FrameShape frame, const Upscaler::Options& options);

/// The device memory that a frame may take, bytes.
uint64_t memoryOf(const Gpu& gpu, const TileOptions& options);

/// The tiles of the frame, `of` its sessions' options, `sharers` as in MemoryLimits. Throws Error if the memory has no
/// room for the smallest.
Tiling tilingIn(uint64_t memory, const Gpu& gpu, const NetworkModel& model, FrameShape frame,
                const Upscaler::Options& options, const SessionOptions& of, uint32_t sharers = 1);

/// What runs it so. Throws OutOfMemory if the device has less memory than it says.
std::unique_ptr<FrameRunner> runnerOf(Gpu& gpu, const NetworkModel& model, FrameShape frame,
                                      const Upscaler::Options& options, const SessionOptions& of, const Tiling& tiling);

}  // namespace xrds
