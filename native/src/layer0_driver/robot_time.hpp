// SPDX-License-Identifier: BSD-3-Clause
// The time that the virtual boards of a process, and the links to them, have in common: the real one, but it waits for
// the slowest board.
#pragma once

#include <cstdint>
#include <limits>
#include <mutex>
#include <vector>

namespace unitylink {

// The real time, of the clock that Python's time.monotonic() reads.
[[nodiscard]] std::uint64_t real_ns() noexcept;

// Any thread may call. Never goes back.
class RobotTime {
 public:
  static constexpr std::uint64_t idle = std::numeric_limits<std::uint64_t>::max();
  // How far a board may stay behind and catch up. Where there are others, it is how far they may be apart.
  static constexpr std::uint64_t lag_alone_ns = 100'000'000;
  static constexpr std::uint64_t lag_together_ns = 5'000'000;
  // A board that does not get on for so long of real time is waited for no longer: its plant hangs, or somebody debugs
  // it.
  static constexpr std::uint64_t patience_ns = 1'000'000'000;

  // A board, as long as it lives.
  class Follower {
   public:
    explicit Follower(RobotTime& time);
    ~Follower();
    Follower(const Follower&) = delete;
    Follower& operator=(const Follower&) = delete;

    // What it has still to do is due at `robot_ns`, or nothing is (`idle`).
    void due(std::uint64_t robot_ns) noexcept;

   private:
    friend class RobotTime;
    RobotTime& time_;
    std::uint64_t due_ns_ = idle;
    std::uint64_t late_since_ns_ = 0;  // of real time; 0: it is not late
  };

  // That of this process.
  [[nodiscard]] static RobotTime& here();

  [[nodiscard]] std::uint64_t now_ns() noexcept { return now_ns(real_ns()); }
  [[nodiscard]] std::uint64_t now_ns(std::uint64_t real) noexcept;

 private:
  std::mutex mutex_;
  std::vector<Follower*> followers_;
  std::uint64_t slip_ns_ = 0;  // by which it is behind the real time
  std::uint64_t last_ns_ = 0;
};

}  // namespace unitylink
