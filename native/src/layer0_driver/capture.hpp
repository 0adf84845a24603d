// SPDX-License-Identifier: BSD-3-Clause
// What went over the wire, in a pcapng file: a packet a transfer, with its time (ns) and direction. Wireshark and
// `unitylink decode` read it.
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

  // Makes the file; refuses one that is there. `comment` goes into its head: the URL of the link.
  [[nodiscard]] static Outcome create(const std::string& path, std::string_view comment,
                                      std::unique_ptr<Capture>& capture);
  Capture(const Capture&) = delete;
  Capture& operator=(const Capture&) = delete;
  ~Capture();

  // When something happens now, for add(); ns since 1970.
  [[nodiscard]] static std::uint64_t now_ns() noexcept;
  // From any thread, so not always in the order of the times. Bytes are buffered, and in the file a quarter of a second
  // later at the latest if more follow, else at close().
  void add(std::uint64_t time_ns, Direction direction, std::span<const std::uint8_t> bytes) noexcept;
  void close() noexcept;
  // Whether no byte went over the wire yet; and: closes, and takes the file away where create() made it.
  [[nodiscard]] bool empty() const noexcept;
  void discard() noexcept;
  // In a forked child: what is buffered is the parent's to write.
  void disown() noexcept;
  // Empty, or why the file ends before the link did. What it holds until then is whole.
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
