// SPDX-License-Identifier: BSD-3-Clause
// What concerns the outputs of the board: the dead-man that its clients share, and the groups that it publishes.
//
// Each client may have a dead-man. The server watches each by the frames of its own client, so no client keeps
// another's awake. If one trips, the board's trips. The board has one dead-man, with the shortest limit of all, that of
// the server's own link included. It watches the server: if the server ends or hangs, it trips by itself.
#include <algorithm>
#include <new>
#include <span>
#include <utility>

#include "server/board_client.hpp"

namespace unitylink::server {

namespace status = protocol::reply_status;

namespace {

constexpr std::uint32_t unknown_ticks = 0xFFFFFFFF;  // arming starts the dead-man with its last limit

std::uint32_t status_of_outcome(const Outcome& outcome) noexcept {
  switch (outcome.status) {
    case Status::ok: return status::ok;
    case Status::denied: return status::denied;
    case Status::mismatch: return status::no_group;
    case Status::range:
    case Status::protocol_error: return status::invalid;
    default: return Host::unanswered;
  }
}

}  // namespace

std::uint32_t BoardServer::define_group(Session& session, std::uint32_t group, std::span<const std::uint32_t> addresses,
                                        std::uint32_t divisor, bool on_event) {
  make_safe();
  fan_out_.remove({&session, group});
  if (addresses.empty() || (divisor == 0 && !on_event)) {
    return status::ok;
  }
  FanOut::Definition definition{{addresses.begin(), addresses.end()}, divisor, on_event, std::nullopt};
  if (on_event) {
    definition.group = group;
  }
  return status_of_outcome(fan_out_.add({&session, group}, std::move(definition)));
}

std::uint32_t BoardServer::set_dead_man() {
  std::uint32_t least = own_ticks_;
  for (const auto& client : clients_) {
    const std::uint32_t ticks = client->gone ? 0 : client->session.dead_man_ticks();
    least = ticks > 0 && (least == 0 || ticks < least) ? ticks : least;
  }
  if (least == board_ticks_) {
    return status::ok;
  }
  Link& link = upstream_.link();
  const double ticks = least == 0 ? 0 : static_cast<double>(least) - 0.5;  // it is rounded up
  const Outcome outcome =
      at_board([&] { return link.set_dead_man(ticks / static_cast<double>(facts_.configuration.base_hz), {}); });
  if (outcome.ok()) {
    board_ticks_ = least;
  } else if (outcome.status == Status::denied) {
    notice_trip();
  }
  return status_of_outcome(outcome);
}

Outcome BoardServer::trip(const RequestOptions& how) {
  tripping_ += 1;
  Outcome outcome = upstream_.link().trip(how);
  if (outcome.ok()) {
    tripped_now_ = true;  // the thread of the server notices it before it obeys any order, such as to arm
    wake();
  }
  tripping_ -= 1;
  return outcome;
}

Outcome BoardServer::arm(const RequestOptions& how) {
  return ordered([&how](BoardServer& self) { return self.arm_board(how); });
}

Outcome BoardServer::subscribe(const SubscriptionRequest& request, std::uint32_t& id) {
  if (request.verify) {  // by this thread: that of the server waits for no address that does not answer
    if (Outcome outcome = upstream_.link().verify(request.addresses); !outcome.ok()) {
      return outcome;
    }
  }
  return ordered([&](BoardServer& self) {
    return self.fan_out_.listen(
        {{request.addresses.begin(), request.addresses.end()}, request.divisor, request.on_event, request.group},
        request.ring, id);
  });
}

Outcome BoardServer::unsubscribe(std::uint32_t id) {
  const Outcome outcome = ordered([id](BoardServer& self) { return self.fan_out_.hush(id); });
  return outcome.status == Status::closed ? upstream_.link().unsubscribe(id) : outcome;
}

// Another thread wants something of the board, and waits for it.
Outcome BoardServer::ordered(std::function<Outcome(BoardServer&)> act) {
  Order order{.act = std::move(act)};
  std::unique_lock lock(mutex_);
  if (over_) {
    return {Status::closed, "the server has ended"};
  }
  orders_.push_back(&order);
  wake();
  obeyed_.wait(lock, [&order] { return order.outcome.has_value(); });
  return std::move(*order.outcome);
}

void BoardServer::obey(bool ending) {
  if (tripped_now_.exchange(false)) {
    notice_trip();
  }
  for (Order* const order : std::exchange(orders_, {})) {
    try {
      order->outcome = ending ? Outcome(Status::closed, "the server has ended") : order->act(*this);
    } catch (const std::bad_alloc&) {  // of a large ring: the other clients go on
      order->outcome = Outcome(Status::range, "there is not enough memory for it");
    }
    obeyed_.notify_all();  // the next one may wait for the board
  }
}

Outcome BoardServer::arm_board(const RequestOptions& how) {
  Link& link = upstream_.link();
  std::uint32_t state = 0;
  Outcome outcome = at_board([&] { return link.read_control(protocol::control::arm, std::span(&state, 1), how); });
  if (outcome.ok() && (state & 1) != 0) {
    notice_trip();  // it tripped by itself: the dead-men of the clients end with that
  }
  if (outcome.ok()) {
    outcome = at_board([&] { return link.arm(how); });
  }
  if (outcome.ok() && (tripping_ > 0 || tripped_now_)) {  // nobody knows which of both came last to the board
    trip_wanted_ = true;
    make_safe();
    return {Status::denied, "the device was stopped while it was armed"};
  }
  if (outcome.ok()) {
    tripped_ = false;
    generation_ = link.generation();  // arming may have begun another session, which is no restart
    board_ticks_ = unknown_ticks;
    for (const auto& client : clients_) {
      client->session.wake_dead_man(link.now_ns());
    }
    if (set_dead_man() == Host::unanswered) {
      return {Status::timeout, "the device was armed, but did not confirm the limit of its dead-man"};
    }
  }
  return outcome;
}

void BoardServer::notice_trip() noexcept {
  if (std::exchange(tripped_, true)) {
    return;
  }
  report_.trips += 1;
  board_ticks_ = 0;
  upstream_.link().rest_dead_man(own_ticks_);
  for (const auto& client : clients_) {
    client->session.rest_dead_man(upstream_.link().now_ns());
  }
}

void BoardServer::look_at_dead_men() {
  const std::uint64_t now = upstream_.link().now_ns();
  for (const auto& client : clients_) {
    if (client->session.dead_man_due_ns() <= now) {
      trip_wanted_ = true;
      tell({.client = client->id, .kind = News::Kind::silent, .address = 0});
    }
  }
}

void BoardServer::make_safe() {
  if (!trip_wanted_.exchange(false)) {
    return;
  }
  const Outcome outcome = at_board([this] { return upstream_.link().trip({}); });
  if (outcome.status != Status::mismatch) {  // after any other failure the board's own dead-man trips
    notice_trip();
  }
}

}  // namespace unitylink::server
