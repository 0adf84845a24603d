// SPDX-License-Identifier: BSD-3-Clause
// The application layer: executes requests on the bus and answers them. Between requests it publishes groups.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "device/bus.hpp"
#include "device/configuration.hpp"
#include "device/datalink_receiver.hpp"
#include "device/datalink_transmitter.hpp"
#include "device/subscription_manager.hpp"

namespace unitylink::device {

// One state machine, as in the gateware. It does one thing at a time. It chooses between a request and a publish only
// between messages. Its clock is the time of the next step, and it stops while the transmit FIFO is full.
class Application {
 public:
  Application(const DeviceConfiguration& configuration, DatalinkReceiver& receiver, SubscriptionManager& subscriptions,
              DatalinkTransmitter& transmitter, Bus& bus);

  [[nodiscard]] Clock next_clock() const noexcept;
  void step(Clock now);
  [[nodiscard]] bool idle() const noexcept { return state_ == State::idle; }
  // `to_session`: a framed session is open. Publishes then belong to it, and classic messages that would change
  // something are refused.
  void yield(bool to_session) noexcept { yielding_ = to_session; }

 private:
  enum class State : std::uint8_t { idle, emit, single_access, block_access };

  // The data bytes of the current request, and the clock cycles that it takes to read them.
  struct Cursor {
    std::span<const std::uint8_t> data;
    Clock clocks = 0;
    bool take(std::uint32_t bytes, std::uint32_t& value) noexcept;
  };

  [[nodiscard]] Clock request_clock() const noexcept;
  [[nodiscard]] Clock publish_clock() const noexcept;
  [[nodiscard]] bool held() const noexcept;

  void begin_request();
  void decide(const Message& message);
  void begin_publish(std::uint32_t group);
  void execute(std::string_view command, Cursor& cursor);
  void read_configuration();
  void write_event_mask(Cursor& cursor);
  void write_group_addresses(std::uint32_t group, Cursor& cursor);
  void read_group(std::uint32_t group);
  void access_single();
  void access_block();
  void next_block_word();
  void emit();
  void finish();

  void head(char c) { pending_.push_back({Word::Kind::head, static_cast<std::uint8_t>(c), 0}); }
  void tail() { pending_.push_back({Word::Kind::tail, 0, 0}); }
  void letters(std::string_view text);
  void mark(char c) { pending_.push_back({Word::Kind::mark, static_cast<std::uint8_t>(c), 0}); }
  void value(std::uint32_t value, std::uint32_t bytes);
  void success(std::string_view reply);  // `reply` is the whole reply, because it has no data
  void refuse(std::string_view error);
  // refuses a request with missing bytes, unless it is still open and they may arrive
  void refuse_missing(std::string_view error);
  bool refuse_access(BusStatus status, std::string_view error);
  void schedule_access(std::uint32_t address, State state);

  static constexpr std::size_t never_held = ~std::size_t{0};

  const DeviceConfiguration& configuration_;
  DatalinkReceiver& receiver_;
  SubscriptionManager& subscriptions_;
  DatalinkTransmitter& transmitter_;
  Bus& bus_;

  State state_ = State::idle;
  State after_emit_ = State::idle;
  Clock at_ = 0;        // when the next step is due, or when the machine became idle
  Clock decision_ = 0;  // clock of the decode in progress
  bool yielding_ = false;
  bool blocked_ = false;  // waits for room in the transmit FIFO
  bool request_ = false;  // the message in hand is a request, not a publish
  bool checked_publish_ = false;
  bool write_ = false;
  std::uint32_t address_ = 0;
  std::uint32_t write_value_ = 0;
  std::vector<Word> pending_;  // words that go into the transmit FIFO
  std::size_t sent_ = 0;
  std::size_t held_from_ = never_held;    // words from this one on wait for the end of the request
  std::vector<std::uint32_t> addresses_;  // addresses of the block that is read now
  std::size_t next_address_ = 0;
  std::uint32_t group_ = 0;        // the published group
  std::uint32_t block_words_ = 0;  // requested words; more than the addresses if the request was cut short
};

}  // namespace unitylink::device
