// SPDX-License-Identifier: BSD-3-Clause
// The oracle: it compares the writes on the device's bus with the writes that were allowed. Every value is written once
// in a run, so an execution names its request.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace unitylink::faults {

// A requested write.
struct Wish {
  std::uint32_t address = 0;
  std::uint32_t value = 0;
  std::uint64_t number = 0;  // counts the wishes of the client
  std::uint32_t times = 0;   // number of executions
  bool unknown = false;      // the outcome was reported as unknown
};

// A broken promise.
struct Violation {
  std::string text;
  // a wrong value was read, or written instead of another: the effect of a checksum that misses an error
  bool damage = false;
};

// The words of one client, and its wishes in the order in which they must be executed.
class Journal {
 public:
  Journal(std::uint32_t first, std::uint32_t words) : first_(first), truth_(words, 0), told_(words, 0) {}

  [[nodiscard]] std::uint32_t first() const noexcept { return first_; }
  [[nodiscard]] std::uint32_t words() const noexcept { return static_cast<std::uint32_t>(truth_.size()); }
  [[nodiscard]] bool owns(std::uint32_t address) const noexcept { return address - first_ < truth_.size(); }

  enum class Told : std::uint8_t { executed, not_executed, unknown };

  // Adds a write that must be executed after all earlier ones.
  void wish(std::uint32_t address, std::uint32_t value) { wishes_.push_back({address, value, ++number_}); }
  [[nodiscard]] std::size_t wishes() const noexcept { return wishes_.size(); }
  // Reports the outcome of the oldest wish.
  void settle(Told told, const char* status = "");

  // ---- calls from the device's bus
  void on_write(std::uint32_t address, std::uint32_t value);
  void on_reset() noexcept {
    for (std::uint32_t& word : truth_) {
      word = 0;
    }
    disturbed_ = true;
  }

  // The value of this word on the device.
  [[nodiscard]] std::uint32_t truth(std::uint32_t address) const noexcept { return truth_[address - first_]; }
  // Words have changed that the operation did not write. So it cannot know what it reads.
  [[nodiscard]] bool disturbed() const noexcept { return disturbed_; }
  void begin() noexcept { disturbed_ = false; }

  void accuse(std::string text, bool damage = false) { violations_.push_back({std::move(text), damage}); }
  [[nodiscard]] std::vector<Violation>& violations() noexcept { return violations_; }

 private:
  void accuse_write(const char* what, std::uint32_t address, std::uint32_t value, bool damage = false);

  std::uint32_t first_;
  std::vector<std::uint32_t> truth_;
  std::vector<std::uint64_t> told_;  // for each word: the last wish that was reported as executed
  std::uint64_t number_ = 0;
  std::deque<Wish> wishes_;
  std::deque<Wish> past_;  // the last wishes that have ended
  bool disturbed_ = false;
  std::vector<Violation> violations_;
};

}  // namespace unitylink::faults
