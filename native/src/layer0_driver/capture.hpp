// SPDX-License-Identifier: BSD-3-Clause
// Records the bytes on the wire in a pcapng file. Each transfer is one packet, with its time (ns) and direction.
// Wireshark and `unitylink decode` can read the file.
//
// Source of the block layouts: IETF draft-ietf-opsawg-pcapng. The link type is USER0; tools/wireshark/ has a dissector
// for it.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "layer0_driver/status.hpp"

namespace unitylink {

class Capture {
 public:
  enum class Direction : std::uint32_t { received = 1, sent = 2 };  // epb_flags: inbound, outbound

  // Creates the file. It fails if the file exists. `comment` is stored in its head; it is the URL of the link.
  [[nodiscard]] static Outcome create(const std::string& path, std::string_view comment,
                                      std::unique_ptr<Capture>& capture);
  Capture(const Capture&) = delete;
  Capture& operator=(const Capture&) = delete;
  ~Capture();

  // The time for add(): ns since 1970.
  [[nodiscard]] static std::uint64_t now_ns() noexcept;
  // Any thread may call, so packets may be slightly out of order. Bytes are buffered. They are written to the file
  // within a quarter of a second if more follow, else at close().
  void add(std::uint64_t time_ns, Direction direction, std::span<const std::uint8_t> bytes) noexcept;
  void close() noexcept;
  // True if no byte was recorded yet.
  [[nodiscard]] bool empty() const noexcept;
  // Closes, and deletes the file if create() made it.
  void discard() noexcept;
  // For a forked child: drops what is buffered, because the parent writes it.
  void disown() noexcept;
  // Why the file ended before the link did, or empty. What was written before is valid.
  [[nodiscard]] std::string failure() const;

 private:
  Capture(int descriptor, std::string path, bool made);
  void flush() noexcept;

  mutable std::mutex mutex_;
  int descriptor_;
  std::string path_;
  bool made_, empty_ = true;
  int error_ = 0;
  std::uint64_t flushed_ns_ = 0;
  std::vector<std::uint8_t> buffer_;
};

}  // namespace unitylink
