// SPDX-License-Identifier: BSD-3-Clause
// Robot time: the time of all virtual boards of a process, and of the links to them. It follows real time, but waits
// for the slowest board. Or it stands still, and a program advances it in steps (lockstep.hpp).
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <vector>

namespace unitylink {

// Real time in ns, from the same clock as Python's time.monotonic().
[[nodiscard]] std::uint64_t real_ns() noexcept;

class TimeConflict : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Any thread may call it. Robot time never goes back.
class RobotTime {
 public:
  static constexpr std::uint64_t idle = std::numeric_limits<std::uint64_t>::max();
  // A board may be late by so much and still catch up. With several boards, they may be apart by lag_together_ns only.
  static constexpr std::uint64_t lag_alone_ns = 100'000'000;
  static constexpr std::uint64_t lag_together_ns = 5'000'000;
  // If a board makes no progress for so long in real time, nobody waits for it any longer: its plant hangs, or is in a
  // debugger.
  static constexpr std::uint64_t patience_ns = 1'000'000'000;

  // Each board has one of these for its whole life.
  class Follower {
   public:
    explicit Follower(RobotTime& time);
    ~Follower();
    Follower(const Follower&) = delete;
    Follower& operator=(const Follower&) = delete;

    // The board says when its next work is due. `idle`: it has none.
    void due(std::uint64_t robot_ns) noexcept;

   private:
    friend class RobotTime;
    RobotTime& time_;
    std::uint64_t due_ns_ = idle;
    std::uint64_t late_since_ns_ = 0;  // in real time; 0: it is not late
  };

  // The robot time of this process.
  [[nodiscard]] static RobotTime& here();

  [[nodiscard]] std::uint64_t now_ns() noexcept { return in_steps_ ? last_ns_.load() : now_ns(real_ns()); }
  [[nodiscard]] std::uint64_t now_ns(std::uint64_t real) noexcept;

  // Each board says how its time goes, before it starts and after it has ended. Throws TimeConflict if there are boards
  // of the other kind. With the first board in steps, robot time begins at `stepped_start_ns`, so that each run is the
  // same. Behind the last one it is real time again.
  static constexpr std::uint64_t stepped_start_ns = 1'000'000'000;
  void claim(bool in_steps);
  void release(bool in_steps) noexcept;
  [[nodiscard]] bool in_steps() const noexcept { return in_steps_; }
  void step_to(std::uint64_t robot_ns) noexcept;

 private:
  std::mutex mutex_;
  std::vector<Follower*> followers_;
  std::uint64_t slip_ns_ = 0;  // how far robot time is behind real time
  std::atomic<std::uint64_t> last_ns_ = 0;
  std::atomic<bool> in_steps_ = false;
  unsigned boards_ = 0;  // that have claimed it
};

}  // namespace unitylink
