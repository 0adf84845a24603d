// SPDX-License-Identifier: BSD-3-Clause
// FramedEngine turns requests with ids into frames, and frames into answers. It also recovers when an answer is
// missing. Sans I/O. See docs/protocol.md.
//
//   submit() -> waiting -> transmit() -> a place (id mod window) -> receive() -> done
//                              ^  due again: its timeout, or an answer to a later id
//                              +------------------------------+
//
// Rules, and why:
// - The device remembers the last executed request of each place. So a request may be sent again at any time, and is
//   executed once.
// - A request that is given up (timeout, interruption) leaves its place behind. A SYNC with the same id takes this
//   place over. So a late copy of the request is a repeat for the device, and is never executed.
// - An answer with an error counts only when it has come twice. One of 65,536 damaged answers passes its check, and
//   asking again does no harm. A refused write also leaves its place to a SYNC, and its caller waits for that, because
//   a copy of the write may still be on its way.
// - Every request ends within attempts x timeout after it was made, or after the last answer to one of those before it,
//   whatever the device sends meanwhile. Answers that only keep the engine busy (HELLO, OPEN, CLOSED, answers to its
//   own questions) do not extend this.
// - Some devices send the engine back to the beginning again and again (CLOSED, another nonce, `order`, `behind`). Such
//   a device is asked a few times at once, then with pauses that double up to the timeout. So it cannot make the host
//   fill the line.
// - HELLO and OPEN open a session. The engine asks for it again when the device reports that it has none, or does not
//   answer twice. If the session is then another one, all requests in flight that may have been executed end as
//   unknown. Only reads are sent again, and groups are defined again.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "layer1_stream/frame_decoder.hpp"
#include "layer1_stream/frame_encoder.hpp"
#include "layer2_message/clock_fit.hpp"
#include "layer2_message/engine.hpp"
#include "layer2_message/greeting.hpp"
#include "layer2_message/post_queue.hpp"
#include "layer2_message/server_clock.hpp"

namespace unitylink {

class FramedEngine final : public Engine {
 public:
  static constexpr std::size_t transmit_bytes_max = 16384;
  static constexpr std::uint32_t window_max = 128;
  static constexpr std::uint32_t epochs = 0xFF00;  // FF.. are frames outside sessions
  static constexpr std::uint32_t no_session = 0xFFFF;

  // The device may speak only the classic protocol. This is assumed once it has answered the classic question after
  // each of so many HELLOs, and none of the HELLOs. If a line loses every tenth HELLO or answer, one framed device of a
  // million is mistaken for a classic one.
  static constexpr std::uint32_t probes = 8;
  FramedEngine(const EngineSettings& settings, bool probe) noexcept;

  void configure(const Configuration& configuration) noexcept override;
  // The device's last HELLO answer, if there was one.
  [[nodiscard]] const std::optional<Greeting>& greeting() const noexcept { return greeting_; }
  // The clock of the device in the host's time.
  [[nodiscard]] const ClockFit& clock() const noexcept { return clock_; }
  // What is known of the clock of `unitylink serve`, which takes an `arm` with its time. Else nothing is known.
  [[nodiscard]] const ServerClock& server_clock() const noexcept { return server_clock_; }
  void set_clock_hz(double clock_hz) noexcept { clock_.set_nominal_hz(clock_hz); }

  void submit(Exchange& exchange, std::uint64_t now_ns) noexcept override;
  void receive(std::span<const std::uint8_t> bytes, std::uint64_t now_ns) noexcept override;
  [[nodiscard]] std::span<const std::uint8_t> transmit(std::uint64_t now_ns) noexcept override;
  void sent(std::size_t bytes) noexcept override;
  [[nodiscard]] std::size_t backlog() const noexcept override;
  void advance(std::uint64_t now_ns) noexcept override;
  [[nodiscard]] std::uint64_t next_deadline_ns() const noexcept override;
  void abandon(std::span<Exchange> exchanges, std::uint64_t now_ns) noexcept override;
  void withdraw(std::span<Exchange> exchanges, std::uint64_t now_ns) noexcept override;
  void end(Status status, std::uint64_t now_ns) noexcept override;
  void cut(Status status, std::uint64_t now_ns) noexcept override;
  void forget(Status status) noexcept override;
  void claim(std::uint32_t group, PublishRing* ring) noexcept override;

  // The exchange group is not defined again in the next session.
  void forget_exchange(std::uint32_t group) noexcept { exchange_groups_[group] = {}; }
  // A new session is being set up like the last one. The words of groups are still read.
  [[nodiscard]] bool restoring() const noexcept { return !idle(restoration_); }
  // Makes writes without an answer, 1 to post_words_max of them in one message. False: there is no room until the
  // device has confirmed some. The engine asks it to.
  static constexpr std::size_t post_words_max = 32;  // words that are lost with one message
  [[nodiscard]] bool post(std::span<const Post> words, std::uint64_t now_ns) noexcept;
  [[nodiscard]] const PostQueue& posts() const noexcept { return posts_; }
  // Posts of lost sessions that the device had not confirmed. The call resets the count.
  [[nodiscard]] std::uint64_t take_unknown_posts() noexcept { return std::exchange(unknown_posts_, 0); }
  // The dead-man is to trip, or has: the engine sends no more signs of life for it.
  void stop_signs_of_life() noexcept { deadman_ticks_ = 0; }
  [[nodiscard]] std::uint64_t sessions() const noexcept { return sessions_; }
  [[nodiscard]] std::uint16_t epoch() const noexcept { return decoder_.key().epoch; }

 private:
  // silent: nothing was asked yet. checking: HELLO was sent to see whether the session is still there.
  enum class State : std::uint8_t { silent, greeting, opening, open, checking };
  struct Sink;  // called by the decoder
  // more than HELLO or OPEN and its answer, and what was on the line before
  static constexpr std::size_t greeting_bytes = 128;

  struct Place {
    [[nodiscard]] bool taken_over() const noexcept { return exchange == nullptr || refusal.has_value(); }

    Exchange* exchange = nullptr;  // nullptr in a used place: the request was given up, and a SYNC takes its id over
    bool used = false;
    bool due = false;  // must be sent (again)
    bool barrier = false;
    bool unbound = true;  // its barrier is set when it is next sent
    // a SYNC that takes its id over also waits for its turn, so that no later chained request goes first
    bool chained = false;
    bool doubted = false;  // an answer with an error has come; it counts when it comes again
    // the status for its caller, if a SYNC takes its id over, and shows that it was not executed
    std::optional<Status> refusal;
    std::uint16_t id = 0;
    std::uint16_t post = 0;   // number of posts executed before it, if `barrier`
    std::uint32_t bytes = 0;  // bytes of its frame, for the credit
    std::uint32_t transmissions = 0;
    std::uint64_t first_order = 0;  // numbers of its first and last transmission
    std::uint64_t last_order = 0;
    std::uint64_t first_sent_ns = 0;
    std::uint64_t sent_ns = 0;
    std::uint64_t wait_ns = 0;   // it must be sent again so long after sent_ns
    std::uint64_t limit_ns = 0;  // when it is given up
  };

  struct Group {
    PublishRing* ring = nullptr;
    std::span<const std::uint32_t> addresses;  // owned by the subscription, which exists longer than its claim
    std::uint32_t divisor = 0;
    bool on_event = false;
    std::uint16_t sequence = 0;  // sequence of the next publish
  };

  struct ExchangeGroup {
    std::span<const ExchangeWord> outputs;  // owned by the caller that defined it, kept until it is forgotten
    std::span<const ExchangeWord> inputs;
  };

  // outgoing frames (framed_engine.cpp)
  [[nodiscard]] Place& place_of(std::uint32_t id) noexcept { return places_[id % window_]; }
  [[nodiscard]] bool send_due() noexcept;
  [[nodiscard]] bool send_next() noexcept;
  [[nodiscard]] bool send_request() noexcept;
  [[nodiscard]] std::uint64_t posts_most() const noexcept;
  [[nodiscard]] bool send_post() noexcept;
  [[nodiscard]] std::size_t encode(Place& place) noexcept;
  void commit(Place& place, std::size_t size) noexcept;
  void encode_greeting() noexcept;
  [[nodiscard]] std::span<std::uint8_t> room() noexcept { return std::span(pending_).subspan(pending_end_); }
  void queue(Exchange& exchange, bool first) noexcept;
  void maintain() noexcept;
  [[nodiscard]] bool checked_long() const noexcept {
    return settings_.checked_long && (greeting_->features & protocol::control_value::feature_long_frames) != 0;
  }
  void confirm() noexcept;
  [[nodiscard]] Exchange* idle_confirmation() noexcept;
  [[nodiscard]] bool is_confirmation(const Exchange& exchange) const noexcept {
    return &exchange >= confirmations_.data() && &exchange < confirmations_.data() + confirmations_.size();
  }
  [[nodiscard]] bool idle(const Exchange& exchange) const noexcept;

  // incoming frames (framed_engine_receive.cpp)
  void on_frame(const Frame& frame) noexcept;
  void on_text() noexcept;
  void on_reply(std::uint8_t status, std::span<const std::uint8_t> payload) noexcept;
  void on_publish(std::span<const std::uint8_t> payload) noexcept;
  void on_answer(Place& place, std::uint8_t status, std::span<const std::uint8_t> body) noexcept;
  void on_executed(const Place& place) noexcept;
  void measure(std::uint64_t round_trip_ns) noexcept;
  void ask_again(Place& place) noexcept;
  void ask_in_turn(Place& place) noexcept;
  [[nodiscard]] bool believed(Place& place) noexcept;
  void refuse(Place& place, Status status) noexcept;
  void release(Place& place) noexcept;

  // sessions and time (framed_engine_session.cpp)
  void ask() noexcept;
  void greet() noexcept;
  void on_greeting(const Greeting& told) noexcept;
  void on_opened(std::uint16_t epoch, std::uint32_t clock) noexcept;
  void lose_session() noexcept;
  void forget_session() noexcept;
  void notice_restart(std::uint32_t told_epoch) noexcept;
  void restore() noexcept;
  void expire(Place& place) noexcept;
  void give_up(Place& place) noexcept;
  void refuse() noexcept;
  void end_late() noexcept;
  void finish_all(Status status, std::uint64_t now_ns, bool strict) noexcept;
  [[nodiscard]] std::uint64_t limit_of(const Exchange& exchange) const noexcept;
  [[nodiscard]] std::uint64_t message_allowance_ns() const noexcept;
  [[nodiscard]] bool is_own(const Exchange& exchange) const noexcept {
    return &exchange == &restoration_ || &exchange == &reading_ || is_confirmation(exchange);
  }
  template <class Wanted>
  void take_back(Wanted wanted) noexcept;
  [[nodiscard]] std::uint64_t allowance_ns(std::size_t bytes) const noexcept {
    return 2 * settings_.byte_time_ns * bytes;
  }
  [[nodiscard]] std::uint64_t keep_alive_ns() const noexcept;
  [[nodiscard]] std::uint64_t clock_interval_ns() const noexcept;

  EngineSettings settings_;
  const bool probe_;
  FrameDecoder decoder_;
  State state_ = State::silent;
  bool text_ = false;                // within a line of classic text
  std::size_t text_bytes_ = 0;       // length of this line so far
  std::array<char, 6> text_head_{};  // the first bytes of this line
  std::uint32_t passed_over_ = 0;    // HELLOs without an answer, although the classic question after them was answered
  std::optional<Greeting> greeting_;
  std::uint16_t offered_epoch_;  // requested by OPEN
  bool greeting_due_ = false;    // HELLO or OPEN must be sent, depending on the state
  std::uint64_t greeting_deadline_ns_ = 0;
  std::uint64_t greeting_wait_ns_ = 0;
  std::uint64_t greeting_sent_ns_ = 0;
  std::uint64_t opening_sent_ns_ = 0;   // the first OPEN since the last HELLO answer
  std::uint64_t greeting_from_ns_ = 0;  // HELLO or OPEN is not sent before this time
  std::uint32_t in_vain_ = 0;           // HELLOs and OPENs that the device has caused since it last answered a request
  std::uint32_t openings_ = 0;          // OPENs since the last HELLO answer
  std::uint64_t sessions_ = 0;
  std::uint32_t session_epoch_ = no_session;  // the last epoch that the device reported

  ExchangeList waiting_;
  std::uint32_t window_ = 1;
  std::uint16_t next_id_ = 0;
  std::uint16_t base_id_ = 0;    // the id of the oldest request without an answer, or next_id_
  std::uint32_t due_ = 0;        // number of places that must be sent
  std::uint32_t given_up_ = 0;   // places whose SYNC has no answer yet, and whose caller does not wait any more
  std::uint32_t credit_ = 0;     // bytes of requests in flight
  std::uint32_t in_flight_ = 0;  // number of places in use
  std::uint64_t order_ = 0;      // all transmissions so far
  std::array<Place, window_max> places_;

  std::uint64_t smoothed_ns_ = 0;  // mean round trip; 0: not measured yet
  std::uint64_t variation_ns_ = 0;
  std::uint64_t quickest_ns_ = no_deadline;

  PostQueue posts_;
  std::uint64_t unknown_posts_ = 0;
  std::uint64_t careful_until_ns_ = 0;  // until then only few posts are in flight, because one was lost
  std::uint64_t post_bytes_ = 0;        // bytes of the last post's frame
  std::uint64_t gone_back_order_ = 0;   // value of order_ when the posts were last sent again
  // the engine's own questions about the posts; an answer to a later one shows that an earlier one was lost
  std::array<Exchange, 4> confirmations_;
  std::uint64_t confirming_ = 0;  // posts sent before the last of these
  std::uint64_t confirm_ns_ = no_deadline;

  std::array<Group, protocol::limits::groups_max> groups_;
  std::array<ExchangeGroup, protocol::limits::exchanges_max> exchange_groups_;
  Exchange restoration_;             // the engine's own request that sets up a new session
  std::uint32_t restored_ = 0;       // number of its steps that are done
  std::uint32_t restored_most_ = 0;  // the most steps since a session was last set up completely
  bool publishing_ = false;
  std::uint32_t deadman_ticks_ = 0;

  ServerClock server_clock_;
  ClockFit clock_;
  Exchange reading_;  // the engine's own reading of the device's clock
  std::array<std::uint32_t, 2> read_clock_{};
  std::uint64_t clock_due_ns_ = no_deadline;
  std::uint64_t last_sent_ns_ = 0;

  std::size_t pending_begin_ = 0;
  std::size_t pending_end_ = 0;
  std::array<std::uint8_t, transmit_bytes_max> pending_;
};

}  // namespace unitylink
