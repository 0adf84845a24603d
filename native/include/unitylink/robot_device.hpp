// SPDX-License-Identifier: BSD-3-Clause
//
// A node's requests about the device: its dead-man, its counters, and whether it has lost the written values. Classic
// gateware offers only the last.
#pragma once

#include <unitylink.h>

#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "unitylink/protocol.hpp"

namespace unitylink {

using Facts = std::vector<std::pair<std::string, std::string>>;

// Only one thread may use it at a time.
class Device {
 public:
  // Starts to use a new link. If the device has a dead-man and there is something to make `safe`, the dead-man trips
  // after `silence_s` without a sign of life from this program. A deadman= in the link's URL has priority. False: see
  // ul_last_error_text().
  bool open(ul_link* link, double silence_s, bool safe) {
    link_ = link;
    wanted_s_ = silence_s;
    safe_ = safe;
    framed_ = std::string(ul_protocol(link)) == "framed";
    std::uint32_t features = 0;
    if (framed_ && !control(protocol::control::features, features)) return false;
    has_one_ = (features & protocol::control_value::feature_deadman) != 0;
    return renew();
  }

  // Reads the state of the dead-man, and starts it if it does not run. False: see ul_last_error_text().
  bool renew() {
    std::uint32_t state = 0;
    if (has_one_ && !control(protocol::control::arm, state)) return false;
    tripped_ = (state & tripped_bit) != 0;
    return start();
  }

  bool tripped() const noexcept { return tripped_; }
  // Why nothing makes the outputs safe when the link is lost. Empty if the gateware does.
  const std::string& lacking() const noexcept { return lacking_; }

  // Allows writes again after a trip. False: see ul_last_error_text().
  bool arm() {
    if (!tripped_) return true;
    if (ul_arm(link_, nullptr) != UL_OK) return false;
    tripped_ = false;
    return start();
  }

  // Whether the dead-man has tripped since the last call. A missing answer counts as no, because the link handles it.
  bool has_tripped() {
    std::uint32_t state = 0;
    return lacking_.empty() && !tripped_ && control(protocol::control::arm, state) && (state & tripped_bit) != 0;
  }

  // A number that changes each time the device may have lost the written values.
  std::uint64_t generation() const {
    ul_statistics counted{};
    counted.size = sizeof counted;
    return ul_get_statistics(link_, &counted) == UL_OK ? counted.restarts + counted.reconnections : 0;
  }

  // Adds the state of the dead-man and the device's counters to the diagnostics.
  void tell(Facts& facts) {
    char after[48];
    std::snprintf(after, sizeof after, "trips after %g s", silence_s_);
    facts.emplace_back("dead-man", tripped_           ? "tripped: the outputs are safe, call arm"
                                   : lacking_.empty() ? after
                                                      : lacking_);
    static constexpr const char* names[] = {
        "frames",       "discarded check", "discarded kind",   "discarded session", "discarded stale", "discarded long",
        "duplicates",   "posts",           "posts ahead",      "posts old",         "post errors",     "bus errors",
        "bus timeouts", "publishes",       "publish overruns", "receive overruns",  "refused",         "deadman trips"};
    static_assert(sizeof names / sizeof *names == protocol::control::deadman_trips - protocol::control::frames + 1);
    std::uint32_t address = protocol::control::frames;
    for (const char* name : names) {
      std::uint32_t count = 0;
      if (!framed_ || !control(address++, count)) return;
      facts.emplace_back(std::string("device ") + name, std::to_string(count));
    }
  }

 private:
  static constexpr std::uint32_t tripped_bit = 1, running_bit = 2;

  bool start() {
    std::uint32_t state = 0, ticks = 0;
    lacking_ = has_one_ ? "" : "this gateware has no dead-man";
    if (!has_one_ || tripped_) return true;
    if (!control(protocol::control::arm, state) || !control(protocol::control::deadman_ticks, ticks)) return false;
    const bool running = (state & running_bit) != 0;
    ul_configuration configuration{};
    configuration.size = sizeof configuration;
    ul_get_configuration(link_, &configuration);
    silence_s_ = running ? static_cast<double>(ticks) / static_cast<double>(configuration.base_hz) : wanted_s_;
    lacking_ = silence_s_ <= 0 ? "the dead-man is off" : safe_ ? "" : "the spec gives no SAFE values for a dead-man";
    return running || !lacking_.empty() ||
           ul_set_dead_man(link_, static_cast<std::uint64_t>(1e9 * silence_s_), nullptr) == UL_OK;
  }
  bool control(std::uint32_t address, std::uint32_t& value) {
    return ul_read_control(link_, address, &value, 1, nullptr) == UL_OK;
  }

  ul_link* link_ = nullptr;
  bool framed_ = false, has_one_ = false, tripped_ = false, safe_ = false;
  double wanted_s_ = 0.0, silence_s_ = 0.0;
  std::string lacking_ = "there is no link";
};

}  // namespace unitylink
