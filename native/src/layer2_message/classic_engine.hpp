// SPDX-License-Identifier: BSD-3-Clause
// ClassicEngine: requests in order to text, text to answers, and what to do when an answer does not come. Sans I/O: it is given bytes and
// times and gives bytes and verdicts, so that tests can run it on a virtual clock.
//
//   submit() -> waiting -> transmit() -> in flight -> receive() -> replied -> done
//                  ^                        |  a bad or missing answer: everything in flight is void
//                  +----- fence ------------+  what must not be sent twice ends here
//
// Rules, and why:
// - The protocol has no ids: the n-th reply belongs to the n-th request. A request that vanished would shift every later answer by one, so
//   answers count only when all that was in flight together has been answered (`replied` waits for that); then the numbers agree.
// - Requests in flight never hold more bytes, either way, than the device's FIFOs (credit), unless one is alone.
// - Every request ends: (attempts + 1) x timeout after it was made, or after the last answer to another one, and the time that its bytes take;
//   damaged answers and fences that come through do not put that off.
// - After a void nothing is sent but the fence, until the device has answered it. All that comes before that answer is dropped.
// - After a bus timeout 2012 gateware may stay in its bus cycle, which the next access then completes in its own direction. A word
//   that is known to answer is read before that can be a write, and no answer is believed that such a cycle may have spoiled
//   (classic_engine_bus.cpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "layer1_stream/classic_decoder.hpp"
#include "layer1_stream/configuration.hpp"
#include "layer2_message/engine.hpp"

namespace unitylink {

class ClassicEngine final : public Engine {
 public:
  // The longest request is a WSA or RM of 255 addresses of 4 bytes; several short ones fit together.
  static constexpr std::size_t transmit_bytes_max = 8192;

  explicit ClassicEngine(const EngineSettings& settings) noexcept;

  void configure(const Configuration& configuration) noexcept override;
  // The device's last CNF; nothing when it has no RLC or has not been asked.
  [[nodiscard]] const std::optional<Configuration>& reported() const noexcept { return reported_; }
  // False once the device has shown that it has no checksums ("lite" datalink).
  [[nodiscard]] bool checksums() const noexcept { return !plain_fence_; }
  // The device is known to have none of the defects of 2012.
  void expect_corrected_gateware() noexcept { corrected_ = true; }
  // Whether publishes were asked for with a checksum; the other kind is then refused.
  void expect_checked_publishes(bool checked) noexcept { publishes_checked_ = checked; }

  void submit(Exchange& exchange, std::uint64_t now_ns) noexcept override;
  void receive(std::span<const std::uint8_t> bytes, std::uint64_t now_ns) noexcept override;
  [[nodiscard]] std::span<const std::uint8_t> transmit(std::uint64_t now_ns) noexcept override;
  void sent(std::size_t bytes) noexcept override;
  void advance(std::uint64_t now_ns) noexcept override;
  [[nodiscard]] std::uint64_t next_deadline_ns() const noexcept override;
  // If one of them was on its way, all that is becomes void.
  void abandon(std::span<Exchange> exchanges, std::uint64_t now_ns) noexcept override;
  void withdraw(std::span<Exchange> exchanges, std::uint64_t now_ns) noexcept override;
  void end(Status status, std::uint64_t now_ns) noexcept override;
  void cut(Status status, std::uint64_t now_ns) noexcept override;
  void forget(Status status) noexcept override;

 private:
  enum class State : std::uint8_t { ready, fence_due, fencing };
  struct Sink;  // what the decoder calls

  void on_message(const Message& message) noexcept;
  void on_publish(const Publish& publish) noexcept;
  void on_reply(const Message& message) noexcept;
  void on_application_error(Exchange& exchange, const Message& message) noexcept;
  void on_fence_answer(const Message& message) noexcept;
  void on_datalink_error(std::uint8_t code) noexcept;
  void on_bad_reply() noexcept;
  [[nodiscard]] bool take_data(Exchange& exchange, const Message& message) noexcept;
  void replied(Exchange& exchange, Status status) noexcept;
  void drop(Status status, std::uint64_t now_ns) noexcept;
  void finish_all(Status status, std::uint64_t now_ns, bool strict) noexcept;
  void settle_batch() noexcept;
  void void_in_flight(Status why, std::uint8_t datalink_code) noexcept;
  static void keep_cause(Exchange& exchange, std::uint8_t datalink_code) noexcept;
  void blame(std::uint8_t datalink_code) noexcept;
  [[nodiscard]] static Status silence_of(const Exchange& exchange) noexcept;
  void fence_passed() noexcept;
  void fence_failed() noexcept;
  void hasten_fence() noexcept;
  void on_bus_answer(Exchange& exchange, bool done) noexcept;
  void on_bus_timeout(Exchange& exchange) noexcept;
  [[nodiscard]] bool wants_bus_freed() const noexcept;
  void free_bus() noexcept;
  void prepare(Exchange& exchange) noexcept;
  [[nodiscard]] bool admits(const Exchange& exchange) const noexcept;
  void encode(Exchange& exchange) noexcept;
  void encode_fence() noexcept;
  [[nodiscard]] std::uint64_t allowance_ns(const Exchange& exchange) const noexcept;
  [[nodiscard]] std::uint64_t limit_of(const Exchange& exchange) const noexcept;
  void put_back(ExchangeList& again) noexcept;
  void end_late() noexcept;

  EngineSettings settings_;
  ClassicDecoder decoder_;
  std::optional<Configuration> reported_;
  State state_ = State::fence_due;

  ExchangeList waiting_;
  ExchangeList in_flight_;           // first the replied ones, then those whose answer is awaited
  Exchange* oldest_ = nullptr;       // the first awaited one of in_flight_
  std::uint32_t batch_ = 0;          // how many are in in_flight_
  std::uint32_t request_credit_ = 0; // bytes of awaited ones, each way
  std::uint32_t reply_credit_ = 0;

  std::uint64_t oldest_since_ns_ = 0;
  std::uint64_t fence_deadline_ns_ = 0;
  std::uint32_t fences_sent_ = 0;     // since the last answered one
  std::uint32_t fences_hastened_ = 0; // of those, given up early because a datalink error may have swallowed them
  bool fence_hastened_ = false;
  bool fence_unanswered_ = false;     // the last one was, for all its time
  bool publishes_checked_ = false;
  std::uint8_t fence_code_ = 0;       // the last ?xx heard while fencing
  std::uint32_t late_refusals_ = 0;   // answers to surplus fences that may still come
  bool plain_fence_;

  enum class StrayCycle : std::uint8_t { none, read, write };
  StrayCycle stray_cycle_ = StrayCycle::none;      // what the device's bus may still be doing
  std::optional<std::uint32_t> harmless_address_;  // a word that has answered a read which may be repeated
  Exchange freeing_;                               // reads it
  bool corrected_ = false;

  std::uint64_t position_ = 0;        // bytes ever handed to the driver
  std::size_t pending_begin_ = 0;
  std::size_t pending_end_ = 0;
  std::array<std::uint8_t, transmit_bytes_max> pending_;
};

}  // namespace unitylink
