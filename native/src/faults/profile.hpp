// SPDX-License-Identifier: BSD-3-Clause
// Which faults a wire has, and how often.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace unitylink::faults {

// Each is a chance: of a byte, or of a message.
struct WireFaults {
  double flip = 0;            // of a byte: one to three of its bits are wrong
  double burst = 0;           // of a byte: a burst of 4 to 64 wrong bits begins in it
  double lose_byte = 0;
  double double_byte = 0;
  double swap_bytes = 0;      // with the one behind it
  double insert_byte = 0;
  double lose = 0;            // of a message, whole
  double repeat = 0;          // it comes twice
  double cut = 0;             // only the first part of it comes
  double late = 0;            // it and all behind it come late
  std::uint64_t late_ns = 0;  // at most so late
  double overtake = 0;        // of a message: it comes late, and those behind it do not wait (datagrams)

  // Of bytes, so that a checksum has to notice.
  [[nodiscard]] bool damages() const noexcept { return flip + burst + lose_byte + double_byte + swap_bytes + insert_byte > 0; }
  [[nodiscard]] bool any() const noexcept {
    return damages() || lose + repeat + cut + late + overtake > 0;
  }
};

// What the device is: each but the first answers HELLO, OPEN and the classic question as long as nothing else is said.
enum class Peer : std::uint8_t {
  honest,
  dead,       // silent
  half_dead,  // silent to all other questions
  closing,    // CLOSED in place of each answer; classic: an error of its line
  renewing,   // another nonce behind each message, and no session; classic: a configuration that is damaged
  refusing,   // errors in place of answers, another each time; classic: damaged answers
};

struct Profile {
  std::string_view name;
  std::string_view meaning;
  WireFaults wire;            // both ways
  Peer peer = Peer::honest;
  double reset = 0;           // of a message: the FPGA is reset
  double pause = 0;           // of a message: the host does nothing for up to pause_ns
  std::uint64_t pause_ns = 0;
  bool drawn = false;         // each run draws its own rates
};

// "mixed" is all at once, drawn anew for every seed.
[[nodiscard]] const std::vector<Profile>& profiles();
[[nodiscard]] std::optional<Profile> find_profile(std::string_view name);

}  // namespace unitylink::faults
