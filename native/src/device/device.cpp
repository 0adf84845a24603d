// SPDX-License-Identifier: BSD-3-Clause
#include "device/device.hpp"

#include <algorithm>
#include <utility>

namespace unitylink::device {

Device::Device(const DeviceConfiguration& configuration)
    : configuration_(configuration),
      bus_(configuration_,
           [this](std::uint32_t group, bool high, Clock now) { subscriptions_.set_input(group, high, now); }),
      pins_(configuration_.components, bus_.components()),
      dead_man_(configuration_, bus_),
      master_2012_(bus_, configuration_.data_bits),
      input_(configuration_),
      output_(configuration_),
      receiver_(configuration_),
      transmitter_(configuration_, output_),
      subscriptions_(configuration_),
      application_(configuration_, receiver_, subscriptions_, transmitter_,
                   configuration_.published_2012 ? static_cast<Bus&>(master_2012_) : dead_man_),
      framed_(configuration_, subscriptions_, dead_man_, output_) {
  if (!configuration_.components.empty()) {
    bus_.before_components([this](Clock now) { pins_.advance_turns(now); });
  }
}

bool Device::receive(std::uint8_t byte) noexcept { return input_.offer(byte, clock_); }

void Device::receive_error(std::uint8_t bits) {
  // this gateware answers all received requests before it reports the error
  if (configuration_.published_2012 && receiver_.has_message()) {
    unheard_errors_ |= bits;
    return;
  }
  if ((bits & 7u) != 0 && configuration_.datalink == Datalink::full) {
    report(static_cast<std::uint8_t>(protocol::datalink_error::physical + (bits & 7u)),
           clock_ + timing::physical_error);
  }
}

void Device::set_event(std::uint32_t group, bool high) {
  if (group < configuration_.groups) {
    subscriptions_.set_input(group, high, clock_);
  }
}

void Device::set_events(std::uint32_t mask) {
  for (std::uint32_t group = 0; group < std::min(configuration_.groups, 32u); ++group) {
    set_event(group, (mask >> group & 1u) != 0);
  }
}

void Device::report(std::uint8_t code, Clock at) {
  ++statistics_.datalink_errors;
  receiver_.abandon();
  if (!transmitter_.errors_full()) {
    transmitter_.report(code, at);
  }
  if (configuration_.honour_flush) {
    input_.flush();
  }
}

Clock Device::receiver_clock() const noexcept {
  if (receiver_.stalled() || transmitter_.errors_full() || framed_.stalled()) {
    return never;
  }
  const Clock readable = input_.readable();
  return readable == never ? never : std::max({readable, receiver_ready_, receiver_.room_at()});
}

// One side at a time may send, until its message ends.
Clock Device::application_clock() const noexcept {
  return application_.idle() && framed_.sending() ? never : application_.next_clock();
}

Clock Device::transmitter_clock() const noexcept { return framed_.sending() ? never : transmitter_.next_clock(); }

Clock Device::framed_clock() const noexcept {
  return configuration_.has_framed() ? framed_.next_clock(classic_idle()) : never;
}

// Takes one byte, or inside frames all bytes before `limit`. Such bytes have no other effect until the frame is
// complete.
void Device::take_bytes(Clock limit) {
  Clock now = receiver_clock();
  while (configuration_.has_framed() && splitter_.route(input_.front()) == PortSplitter::Side::framed) {
    const bool border = input_.front() == protocol::frame::delimiter;  // a frame may be complete
    framed_.take(input_.front(), now);
    input_.pop();
    ++statistics_.bytes_received;
    last_activity_ = std::max(last_activity_, now);
    receiver_ready_ = now + 1;
    now = receiver_clock();
    if (border || now >= limit) {
      return;
    }
    clock_ = std::max(clock_, now);
  }
  if (!configuration_.has_classic()) {
    input_.pop();
    return;
  }
  const DatalinkReceiver::Taken taken = receiver_.take(input_.front(), now);
  input_.pop();
  ++statistics_.bytes_received;
  last_activity_ = std::max(last_activity_, now);
  receiver_ready_ = taken.next;
  if (taken.error != 0) {
    report(taken.error, taken.error_at);
    swallow(taken);
  }
}

// After an error of form or checksum, the decoder of 2012 has already taken the next byte, if there was one.
void Device::swallow(const DatalinkReceiver::Taken& failed) {
  namespace error = protocol::datalink_error;
  const bool takes_one_more =
      failed.error == error::format || failed.error == error::odd_digits || failed.error == error::checksum;
  if (configuration_.published_2012 && takes_one_more && input_.readable() <= failed.next) {
    input_.pop();
    ++statistics_.bytes_received;
  }
}

Clock Device::next_event() const noexcept { return std::min({next_beside_frames(), receiver_clock(), framed_clock()}); }

Clock Device::next_beside_frames() const noexcept {
  return std::min({input_.next_arrival(), output_.next_departure(), transmitter_clock(), application_clock(),
                   subscriptions_.next_clock(), bus_.next_clock(), pins_.next_turn()});
}

void Device::run(Clock clock, bool to_output) {
  for (;;) {
    if (to_output) {
      clock = std::min(clock, std::max(clock_, output_.next_output()));
    }
    const Clock beside = next_beside_frames();
    const Clock receiver = receiver_clock();
    const Clock framed = framed_clock();
    const Clock next = std::min({beside, receiver, framed});
    if (next > clock) {
      break;
    }
    clock_ = std::max(clock_, next);
    if (input_.next_arrival() <= next) {
      if (!input_.arrive()) {
        ++statistics_.overruns;
        framed_.count(protocol::control::receive_overruns);
        receive_error(overrun);
      }
    } else if (output_.next_departure() <= next) {
      output_.depart();
    } else if (transmitter_clock() <= next) {
      last_activity_ = std::max(last_activity_, next);
      if (transmitter_.errors_full()) {
        // the receiver could not go on until there was room for its next error
        receiver_ready_ = std::max(receiver_ready_, next);
      }
      transmitter_.step();
    } else if (subscriptions_.next_clock() <= next) {
      subscriptions_.advance(clock_);
    } else if (pins_.next_turn() <= next) {
      pins_.advance_turns(clock_);
    } else if (bus_.next_clock() <= next) {
      bus_.advance(clock_);
    } else if (framed <= next) {
      const bool alone = configuration_.byte_clocks() == 0;  // with a line, each byte leaves at its own time
      framed_.step(clock_, classic_idle(), alone ? std::min({beside, receiver, clock}) : next);
      application_.yield(framed_.open());
    } else if (application_clock() <= next) {
      application_.step(clock_);
      if (unheard_errors_ != 0 && !receiver_.has_message()) {
        receive_error(std::exchange(unheard_errors_, std::uint8_t{0}));
      }
    } else {
      take_bytes(std::min({beside, framed, clock}));
    }
  }
  clock_ = std::max(clock_, clock);
}

bool Device::take(TimedByte& byte) noexcept {
  if (!output_.take(byte, clock_)) {
    return false;
  }
  ++statistics_.bytes_sent;
  return true;
}

}  // namespace unitylink::device
