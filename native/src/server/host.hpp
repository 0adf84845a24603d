// SPDX-License-Identifier: BSD-3-Clause
// What a session asks of the board behind it. The results are statuses of replies (protocol::reply_status).
#pragma once

#include <cstdint>
#include <span>

#include "layer1_stream/configuration.hpp"
#include "layer2_message/link.hpp"
#include "server/errand.hpp"
#include "server/grant.hpp"

namespace unitylink::server {

// What the board says about itself.
struct Facts {
  Configuration configuration;
  Description description;
  Addresses plain;  // a read of these has no side effect
};

class Host {
 public:
  // No status of a reply: the board did not answer, or the line is gone.
  static constexpr std::uint32_t unanswered = 0xFF;

  [[nodiscard]] virtual const Facts& facts() const noexcept = 0;
  // An empty errand. It belongs to the host, and goes back to it after Session::finish().
  [[nodiscard]] virtual Errand& errand() = 0;
  // Takes an errand back that is not submitted.
  virtual void discard(Errand& errand) = 0;
  // Sends it. Session::finish() follows, but not within this call.
  virtual void submit(Errand& errand) = 0;
  // The client does not wait any more for what it has submitted.
  virtual void abandon(const Session& session) = 0;
  // From now on the session gets these publishes as its group. No addresses: none.
  [[nodiscard]] virtual std::uint32_t define_group(Session& session, std::uint32_t group,
                                                   std::span<const std::uint32_t> addresses, std::uint32_t divisor,
                                                   bool on_event) = 0;
  // The session's dead-man was set, stopped or has ended.
  [[nodiscard]] virtual std::uint32_t set_dead_man() = 0;
  // The session needs the write lease of this address. Session::resume() follows when that is decided.
  virtual void ask_for_lease(Session& session, std::uint32_t address) = 0;
  // The session wants writes to be allowed again, since `age_us`. Session::resume() follows when the board was armed,
  // or was not.
  virtual void ask_to_arm(Session& session, std::uint32_t age_us) = 0;
  // The clock by which clients say when they have asked for that.
  [[nodiscard]] virtual std::uint32_t clock_us() const noexcept = 0;
  // Makes the outputs safe, before anything else is sent to the board.
  virtual void trip() noexcept = 0;
  // Changes whenever the dead-man has tripped.
  [[nodiscard]] virtual std::uint64_t trips() const noexcept = 0;
  // The board has refused a write, because its dead-man has tripped.
  virtual void notice_trip() noexcept = 0;

 protected:
  ~Host() = default;
};

}  // namespace unitylink::server
