#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>

#include "engine/device.h"

namespace xrds {

/// One device allocation that dispatches read and write: the arena of a session, or its weights. Host access goes
/// straight to memory where the device shares it with the host, else through a staging copy.
class Buffer {
 public:
  /// Throws Error if the device has not that much memory or does not allow an allocation of that size.
  Buffer(Gpu& gpu, uint64_t byteSize);
  ~Buffer();
  Buffer(Buffer&&) noexcept;
  Buffer& operator=(Buffer&&) noexcept;

  uint64_t byteSize() const;
  /// Copies host bytes in; blocks until a later dispatch sees them.
  void upload(uint64_t byteOffset, std::span<const std::byte> bytes);
  /// Copies bytes out, after everything that was run.
  void download(uint64_t byteOffset, std::span<std::byte> bytes) const;
  /// The same for `rowCount` rows of `rowBytes` from byteOffset on, one after the other, without a copy of them all:
  /// `write` and `read` get a row's number and its bytes, in the device's memory where that is shared; they are called
  /// from several threads at once, each for other rows. rowBytes: at most 16 MiB.
  void uploadRows(uint64_t byteOffset, uint64_t rowBytes, uint32_t rowCount,
                  const std::function<void(uint32_t row, std::span<std::byte>)>& write);
  void downloadRows(uint64_t byteOffset, uint64_t rowBytes, uint32_t rowCount,
                    const std::function<void(uint32_t row, std::span<const std::byte>)>& read) const;
  /// Fills the whole buffer with a 32-bit pattern (NaN in tests).
  void fill(uint32_t pattern);

  struct Handles;
  explicit Buffer(std::unique_ptr<Handles> handles);
  const Handles& handles() const { return *handles_; }

 private:
  std::unique_ptr<Handles> handles_;
};

}  // namespace xrds
