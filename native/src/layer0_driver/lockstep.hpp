// SPDX-License-Identifier: BSD-3-Clause
// Robot time in steps: boards and links of a process run in the thread of a program that waits, and only as far as it
// waits. So the same calls give the same bytes, and time is as fast as the machine.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <poll.h>
#include <span>
#include <vector>

namespace unitylink {

class Lockstep {
 public:
  // A virtual board, or a link to one.
  class Member {
   public:
    Member() = default;
    Member(const Member&) = delete;
    Member& operator=(const Member&) = delete;
    virtual ~Member() = default;
    // When it has work without input, in robot time. RobotTime::idle: never.
    [[nodiscard]] virtual std::uint64_t due_ns() noexcept = 0;
    // Takes what has come in.
    virtual void take_in() noexcept = 0;
    // Does what is due, and lets robot time advance with it (RobotTime::step_to), at most to `until_ns`. Ends as soon
    // as the others may have got something. Then it returns true.
    virtual bool work(std::uint64_t until_ns) noexcept = 0;
  };

  [[nodiscard]] static Lockstep& here();

  // A member belongs to it from join() to leave(). leave() waits for the work of the member, unless this work calls it.
  void join(Member& member);
  void leave(Member& member);

  // Lets robot time advance until a descriptor of `waiting` is ready, or to `until_ns`. Returns what poll() returns.
  // `self`, a member, works in the meantime by itself. Only one thread at a time advances.
  int advance(std::uint64_t until_ns, std::span<pollfd> waiting, const Member* self) noexcept;

 private:
  void all_take_in(const Member* self) noexcept;
  [[nodiscard]] bool work(std::uint64_t until_ns, const Member* self) noexcept;
  [[nodiscard]] bool is_idle(const Member* self) noexcept;

  std::recursive_mutex mutex_;  // a plant may close its own board
  std::vector<Member*> members_;
  std::uint64_t changes_ = 0;  // of members_
};

}  // namespace unitylink
