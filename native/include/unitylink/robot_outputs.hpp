// SPDX-License-Identifier: BSD-3-Clause
//
// The wanted values of a robot's outputs, and how they are written. Plain words are written in one burst. Memory with a
// commit is written as a whole.
#pragma once

#include <unitylink.h>

#include <time.h>

#include <cstdio>
#include <string>
#include <vector>

#include "unitylink/robot_table.hpp"

namespace unitylink {

// The text of a number in messages.
inline std::string shown(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", number);
  return text;
}

inline double now_s() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Only one thread may use it at a time. A call that returns false gives the reason in `said`, or in
// ul_last_error_text() if `said` is empty.
class Outputs {
 public:
  explicit Outputs(const Table& table) : table_(table), shadow_(table.value_count), known_(table.value_count) {}

  // Starts to use a new link. The values on the device are unknown then.
  void open(ul_link* link) {
    link_ = link;
    std::fill(known_.begin(), known_.end(), false);
  }
  void want(std::size_t value, std::uint64_t raw) noexcept { shadow_[value] = raw; }

  bool write_safe(std::string& said) {
    std::vector<std::uint16_t> changed;
    said = "";
    for (std::size_t i = 0; i < table_.value_count; ++i) {
      const auto& value = table_.values[i];
      if (!value.writable || !encode(value, value.safe, shadow_[i])) continue;
      changed.push_back(static_cast<std::uint16_t>(i));
      said += (said.empty() ? "safe values written: " : ", ") + std::string(value.path);
    }
    if (said.empty()) said = "the spec gives no SAFE values, so its outputs stay as they are";
    if (burst(changed)) return true;
    said = *ul_last_error_text() != 0 ? ul_last_error_text()
                                      : "the network behind the gateware is down, or has dropped the commit";
    return false;
  }
  // Writes the wanted values: plain words in one burst, then for each unit all its outputs and one commit.
  bool burst(const std::vector<std::uint16_t>& changed) {
    std::vector<std::uint16_t> plain;
    for (const auto i : changed) {
      known_[i] = true;
      if (table_.values[i].unit < 0) plain.push_back(i);
    }
    if (!write_words(plain, 0)) return false;
    for (std::size_t unit = 0; unit < table_.unit_count; ++unit) {
      std::vector<std::uint16_t> outputs;
      bool touched = false;
      for (std::size_t i = 0; i < table_.value_count; ++i) {
        if (!table_.values[i].writable || table_.values[i].unit != static_cast<int>(unit)) continue;
        outputs.push_back(static_cast<std::uint16_t>(i));
        touched = touched || std::find(changed.begin(), changed.end(), i) != changed.end();
      }
      if (!touched) continue;
      if (!settle(table_.units[unit], false)) return false;
      // an unknown output is read and written back unchanged, because a running robot must not jump
      for (const auto i : outputs) {
        if (!known_[i] && !read_raw(table_.values[i], shadow_[i])) return false;
        known_[i] = true;
      }
      if (!write_words(outputs, 1) || ul_write(link_, table_.units[unit].commit, 1, nullptr) != UL_OK) return false;
      if (!settle(table_.units[unit], true)) return false;
    }
    return true;
  }
  bool read_raw(const Value& value, std::uint64_t& raw) {
    std::uint32_t words[8] = {};
    std::uint32_t addresses[8] = {};
    for (unsigned part = 0; part < value.words; ++part) addresses[part] = value.address + part;
    if (ul_read_many(link_, addresses, value.words, words, value.words > 1 ? 1 : 0, nullptr) != UL_OK) return false;
    raw = 0;
    for (unsigned part = 0; part < value.words; ++part)
      raw |= static_cast<std::uint64_t>(words[part]) << part * table_.data_bits;
    return true;
  }

 private:
  bool write_words(const std::vector<std::uint16_t>& values, std::int32_t repeat) {
    std::vector<std::uint32_t> addresses, words;
    const std::uint64_t mask = table_.data_bits == 32 ? 0xFFFFFFFFU : (1U << table_.data_bits) - 1U;
    for (const auto i : values) {
      const auto& value = table_.values[i];
      for (unsigned part = 0; part < value.words; ++part) {
        addresses.push_back(value.address + part);
        words.push_back(static_cast<std::uint32_t>(shadow_[i] >> part * table_.data_bits & mask));
      }
    }
    ul_options options{};
    options.size = sizeof options;
    options.checked = -1;
    options.repeat = repeat;
    return addresses.empty() ||
           ul_write_many(link_, addresses.data(), words.data(), addresses.size(), &options) == UL_OK;
  }
  // Waits until no commit is pending. After a commit of our own it checks that the commit was not dropped.
  bool settle(const Unit& unit, bool committed) {
    if (unit.pending == 0) return true;
    for (const double end = now_s() + 0.5; now_s() < end;) {
      std::uint32_t status = 0;
      if (ul_read(link_, unit.commit, &status, nullptr) != UL_OK) return false;
      if ((status & unit.online) == 0 || (status & unit.halted) != 0) return false;
      if ((status & unit.pending) == 0) return !committed || (status & unit.aborted) == 0;
    }
    return false;
  }
  const Table& table_;
  ul_link* link_ = nullptr;
  std::vector<std::uint64_t> shadow_;  // the last wanted value of each output
  std::vector<bool> known_;            // whether that value is known
};

}  // namespace unitylink
