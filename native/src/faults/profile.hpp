// SPDX-License-Identifier: BSD-3-Clause
// The faults of a wire, and how often they come.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace unitylink::faults {

// Each number is a chance, per byte or per message.
struct WireFaults {
  // for each byte:
  double flip = 0;   // one to three of its bits are wrong
  double burst = 0;  // a burst of 4 to 64 wrong bits begins in it
  double lose_byte = 0;
  double double_byte = 0;
  double swap_bytes = 0;  // with the next byte
  double insert_byte = 0;
  // for each message:
  double lose = 0;            // all of it is lost
  double repeat = 0;          // it comes twice
  double cut = 0;             // only its first part comes
  double late = 0;            // it and all later ones come late
  std::uint64_t late_ns = 0;  // latest
  double overtake = 0;        // it comes late, and later ones do not wait for it (datagrams)

  // Bytes change, so a checksum must detect it.
  [[nodiscard]] bool damages() const noexcept {
    return flip + burst + lose_byte + double_byte + swap_bytes + insert_byte > 0;
  }
  [[nodiscard]] bool any() const noexcept { return damages() || lose + repeat + cut + late + overtake > 0; }
};

// The behaviour of the device. All except `dead` answer HELLO, OPEN and the classic question, unless stated otherwise.
enum class Peer : std::uint8_t {
  honest,
  dead,       // silent
  half_dead,  // silent to all other requests
  closing,    // CLOSED instead of each answer; classic: a line error
  renewing,   // another nonce after each message, and no session; classic: a damaged configuration
  refusing,   // errors instead of answers, another one each time; classic: damaged answers
  waiting,    // `order` instead of each answer: an earlier request is missing; classic: honest
};

struct Profile {
  std::string_view name;
  std::string_view meaning;
  WireFaults wire;  // in both directions
  Peer peer = Peer::honest;
  double reset = 0;  // for each message: the FPGA is reset
  double pause = 0;  // for each message: the host does nothing for up to pause_ns
  std::uint64_t pause_ns = 0;
  bool drawn = false;  // the rates are random for each seed
};

// "mixed" is all faults at once, drawn again for each seed.
[[nodiscard]] const std::vector<Profile>& profiles();
[[nodiscard]] std::optional<Profile> find_profile(std::string_view name);

}  // namespace unitylink::faults
