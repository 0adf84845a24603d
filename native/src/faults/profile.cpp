// SPDX-License-Identifier: BSD-3-Clause
#include "faults/profile.hpp"

#include <algorithm>

namespace unitylink::faults {

const std::vector<Profile>& profiles() {
  constexpr std::uint64_t ms = 1'000'000;
  static const std::vector<Profile> all = {
      {.name = "quiet", .meaning = "nothing goes wrong", .wire = {}},
      {.name = "flips", .meaning = "one to three wrong bits in a byte", .wire = {.flip = 0.003}},
      {.name = "bursts", .meaning = "4 to 64 wrong bits in a row", .wire = {.burst = 0.002}},
      {.name = "bytes",
       .meaning = "bytes lost, doubled, inserted, exchanged",
       .wire = {.lose_byte = 0.001, .double_byte = 0.001, .swap_bytes = 0.001, .insert_byte = 0.001}},
      {.name = "loss", .meaning = "1 % of the messages lost", .wire = {.lose = 0.01}},
      {.name = "messages",
       .meaning = "messages lost, doubled, cut",
       .wire = {.lose = 0.05, .repeat = 0.05, .cut = 0.03}},
      {.name = "late", .meaning = "answers after the timeout", .wire = {.late = 0.004, .late_ns = 60 * ms}},
      {.name = "datagrams",
       .meaning = "lost, doubled, and in another order",
       .wire = {.lose = 0.03, .repeat = 0.1, .late_ns = 3 * ms, .overtake = 0.1}},
      {.name = "pauses",
       .meaning = "the host stands still for up to half a second",
       .wire = {.lose = 0.005},
       .pause = 0.0005,
       .pause_ns = 500 * ms},
      {.name = "resets", .meaning = "the FPGA is reset", .wire = {.flip = 0.0005}, .reset = 0.001},
      {.name = "relapses",
       .meaning = "the FPGA is reset while messages are late",
       .wire = {.late = 0.01, .late_ns = 60 * ms, .overtake = 0.05},
       .reset = 0.002},
      {.name = "restarts", .meaning = "the FPGA is reset at every second message", .wire = {}, .reset = 0.5},
      {.name = "dead", .meaning = "the device is silent", .wire = {}, .peer = Peer::dead},
      {.name = "half-dead",
       .meaning = "the device answers HELLO and OPEN, and nothing else",
       .wire = {},
       .peer = Peer::half_dead},
      {.name = "closing",
       .meaning = "each answer is CLOSED, of a session that HELLO says is open",
       .wire = {},
       .peer = Peer::closing},
      {.name = "renewing",
       .meaning = "another nonce behind each message, and no session",
       .wire = {},
       .peer = Peer::renewing},
      {.name = "refusing",
       .meaning = "errors in place of answers, another each time",
       .wire = {},
       .peer = Peer::refusing},
      {.name = "mixed", .meaning = "all of them, drawn for each seed", .wire = {}, .drawn = true},
  };
  return all;
}

std::optional<Profile> find_profile(std::string_view name) {
  const auto found =
      std::find_if(profiles().begin(), profiles().end(), [name](const Profile& p) { return p.name == name; });
  return found == profiles().end() ? std::nullopt : std::optional(*found);
}

}  // namespace unitylink::faults
