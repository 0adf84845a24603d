// SPDX-License-Identifier: BSD-3-Clause
// ClassicEngine turns requests into text, in order, and text into answers. It also recovers when an answer is missing.
// It does no I/O and reads no clock: it gets bytes and times, so tests can run it on a virtual clock.
//
//   submit() -> waiting -> transmit() -> in flight -> receive() -> replied -> done
//                  ^                        |  a bad or missing answer: everything in flight is void
//                  +----- fence ------------+  what must not be sent twice ends here
//
// Rules, and why:
// - The protocol has no ids: the n-th reply belongs to the n-th request. A lost request would shift every later answer
//   by one. So answers count only when all requests in flight together were answered (`replied` waits for that). Then
//   the numbers agree.
// - Requests in flight, and their replies, never have more bytes than the device's FIFOs hold (credit), unless one
//   request is alone.
// - Every request ends within (attempts + 1) x timeout after it was made, or after the last answer to another one, plus
//   the time for its bytes. Damaged answers and answered fences do not extend this.
// - After a failure only the fence is sent, until the device has answered it. Everything before that answer is dropped.
// - After a bus timeout, 2012 gateware may stay in its bus cycle. The next access then completes this cycle in the
//   cycle's direction. So a word that is known to answer is read before the next access can be such a write. An answer
//   that such a cycle may have spoiled is not accepted (classic_engine_bus.cpp).
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
  // The longest request is a WSA or RM of 255 addresses of 4 bytes. Several short ones fit together.
  static constexpr std::size_t transmit_bytes_max = 8192;

  explicit ClassicEngine(const EngineSettings& settings) noexcept;

  void configure(const Configuration& configuration) noexcept override;
  // The device's last CNF. Empty if it has no RLC or was not asked.
  [[nodiscard]] const std::optional<Configuration>& reported() const noexcept { return reported_; }
  // False after the device has shown that it has no checksums ("lite" datalink).
  [[nodiscard]] bool checksums() const noexcept { return !plain_fence_; }
  // The device is known to have none of the defects of 2012.
  void expect_corrected_gateware() noexcept { corrected_ = true; }
  // Whether publishes were requested with a checksum. Publishes of the other form are then refused.
  void expect_checked_publishes(bool checked) noexcept { publishes_checked_ = checked; }

  void submit(Exchange& exchange, std::uint64_t now_ns) noexcept override;
  void receive(std::span<const std::uint8_t> bytes, std::uint64_t now_ns) noexcept override;
  [[nodiscard]] std::span<const std::uint8_t> transmit(std::uint64_t now_ns) noexcept override;
  void sent(std::size_t bytes) noexcept override;
  void advance(std::uint64_t now_ns) noexcept override;
  [[nodiscard]] std::uint64_t next_deadline_ns() const noexcept override;
  // If one of them was already sent, all requests in flight become void.
  void abandon(std::span<Exchange> exchanges, std::uint64_t now_ns) noexcept override;
  void withdraw(std::span<Exchange> exchanges, std::uint64_t now_ns) noexcept override;
  void end(Status status, std::uint64_t now_ns) noexcept override;
  void cut(Status status, std::uint64_t now_ns) noexcept override;
  void forget(Status status) noexcept override;

 private:
  enum class State : std::uint8_t { ready, fence_due, fencing };
  struct Sink;  // called by the decoder

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
  ExchangeList in_flight_;            // first the requests with a reply, then those that wait for one
  Exchange* oldest_ = nullptr;        // the first one in in_flight_ that waits for an answer
  std::uint32_t batch_ = 0;           // number of requests in in_flight_
  std::uint32_t request_credit_ = 0;  // bytes of the waiting requests, in each direction
  std::uint32_t reply_credit_ = 0;

  std::uint64_t oldest_since_ns_ = 0;
  std::uint64_t fence_deadline_ns_ = 0;
  std::uint32_t fences_sent_ = 0;  // fences sent since the last one that was answered
  // how many of those were given up early, because a datalink error may have removed them
  std::uint32_t fences_hastened_ = 0;
  bool fence_hastened_ = false;
  bool fence_unanswered_ = false;  // the last fence was not answered in its full time
  bool publishes_checked_ = false;
  std::uint8_t fence_code_ = 0;      // the last ?xx received while fencing
  std::uint32_t late_refusals_ = 0;  // answers to surplus fences that may still come
  bool plain_fence_;

  enum class StrayCycle : std::uint8_t { none, read, write };
  StrayCycle stray_cycle_ = StrayCycle::none;      // the bus cycle that may still be open at the device
  std::optional<std::uint32_t> harmless_address_;  // the address of a word that answered a repeatable read
  Exchange freeing_;                               // the request that reads this word
  bool corrected_ = false;

  std::uint64_t position_ = 0;  // bytes given to the driver so far
  std::size_t pending_begin_ = 0;
  std::size_t pending_end_ = 0;
  std::array<std::uint8_t, transmit_bytes_max> pending_;
};

}  // namespace unitylink
