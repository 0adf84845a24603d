// SPDX-License-Identifier: BSD-3-Clause
// Robot time in steps: boards and links of a process run in the thread of a program that waits, and only as far as it
// waits. So the same calls give the same bytes, and time is as fast as the machine.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
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
    // When it has work without input, in robot time. RobotTime::idle: never. It is asked again after each work of this
    // member, and after touch().
    [[nodiscard]] virtual std::uint64_t due_ns() noexcept = 0;
    // Takes what has come in.
    virtual void take_in() noexcept = 0;
    // Does what is due, and lets robot time advance with it (RobotTime::step_to), at most to `until_ns`. Ends as soon
    // as others may have got something.
    virtual void work(std::uint64_t until_ns) noexcept = 0;
    // Whether something has come in for it. Only the one who waits is asked.
    [[nodiscard]] virtual bool has_news() noexcept { return false; }

   private:
    friend class Lockstep;
    std::size_t seat_ = no_seat;
    bool touched_ = false;
  };

  [[nodiscard]] static Lockstep& here();

  // A member belongs to it from join() to leave(). leave() waits for the work of the member, unless this work calls it.
  void join(Member& member);
  void leave(Member& member);

  // Something has come in for this member, or its due has changed. Any thread may say so, with any lock of a member
  // held. Without a seat, it means nothing.
  void touch(Member& member) noexcept;

  // Lets robot time advance until `self` has news, a descriptor of `waiting` is ready, or to `until_ns`. Returns what
  // poll() returns: 0 if only the time is over. `self`, a member, works in the meantime by itself; nullptr: none waits.
  // Only one thread at a time advances.
  int advance(std::uint64_t until_ns, std::span<pollfd> waiting, Member* self) noexcept;

 private:
  static constexpr std::size_t no_seat = std::numeric_limits<std::size_t>::max();

  [[nodiscard]] Member* next_touched() noexcept;
  void take_in(const Member* self) noexcept;
  void ask(std::size_t seat) noexcept;
  void work(std::uint64_t until_ns) noexcept;

  std::recursive_mutex mutex_;  // a plant may close its own board
  std::vector<Member*> members_;
  std::vector<std::uint64_t> dues_;  // of each member. One who waits has none here.
  std::uint64_t changes_ = 0;        // of members_
  std::mutex touched_mutex_;         // nothing else is locked while it is held
  std::vector<Member*> touched_;     // with room for all members
  std::atomic<bool> any_touched_ = false;
};

}  // namespace unitylink
