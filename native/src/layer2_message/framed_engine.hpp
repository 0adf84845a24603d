// SPDX-License-Identifier: BSD-3-Clause
// FramedEngine: requests with ids to frames, frames to answers, and what to do when an answer does not come. Sans I/O. docs/protocol.md.
//
//   submit() -> waiting -> transmit() -> a place (id mod window) -> receive() -> done
//                              ^  due again: its timeout, or an answer to a later id
//                              +------------------------------+
//
// Rules, and why:
// - The device keeps what it executed last in each place, so a request may be sent again as often as need be: it is executed once.
// - Who gives a request up (timeout, interruption) leaves its place behind: a SYNC of the same id takes it over, so that the request, should
//   it still be on its way, is a repeat for the device and never executed late.
// - An answer that tells of an error counts when it has come twice: one of 65,536 damaged ones passes its check, and asking again does no harm.
//   A write that is refused leaves its place to a SYNC, too, and its caller waits for that: a copy of it may be under way.
// - Every request ends: attempts x timeout after it was made, or after the last answer to one of those before it, whatever the device says
//   meanwhile. What only keeps the engine busy (HELLO, OPEN, CLOSED, answers to its own questions) puts that off by nothing.
// - A device that sends the engine back to the beginning again and again (CLOSED, another nonce, `order`, `behind`) is asked some times at once, then
//   with pauses that double up to the timeout: it cannot make the host fill the line.
// - A session is opened by HELLO and OPEN. It is asked for again when the device says that it has none, or twice nothing. If it is another
//   one then, all that was in flight and may have been executed ends unknown. Nothing is replayed but reads; groups are defined anew.
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

namespace unitylink {

class FramedEngine final : public Engine {
 public:
  static constexpr std::size_t transmit_bytes_max = 16384;
  static constexpr std::uint32_t window_max = 128;
  static constexpr std::uint32_t epochs = 0xFF00;  // FF.. are frames outside sessions
  static constexpr std::uint32_t no_session = 0xFFFF;

  // The device may be one of the classic protocol: it is when it has answered the classic question behind each of so many HELLOs, and none of these.
  // Of HELLOs and their answers a line may lose every tenth; then one device with frames of a million is taken for the other.
  static constexpr std::uint32_t probes = 8;
  FramedEngine(const EngineSettings& settings, bool probe) noexcept;

  void configure(const Configuration& configuration) noexcept override;
  // What the device last said; nothing before it has.
  [[nodiscard]] const std::optional<Greeting>& greeting() const noexcept { return greeting_; }
  // The clock of the device in the host's time.
  [[nodiscard]] const ClockFit& clock() const noexcept { return clock_; }
  void set_clock_hz(double clock_hz) noexcept { clock_.set_nominal_hz(clock_hz); }

  void submit(Exchange& exchange, std::uint64_t now_ns) noexcept override;
  void receive(std::span<const std::uint8_t> bytes, std::uint64_t now_ns) noexcept override;
  [[nodiscard]] std::span<const std::uint8_t> transmit(std::uint64_t now_ns) noexcept override;
  void sent(std::size_t bytes) noexcept override;
  void advance(std::uint64_t now_ns) noexcept override;
  [[nodiscard]] std::uint64_t next_deadline_ns() const noexcept override;
  void abandon(std::span<Exchange> exchanges, std::uint64_t now_ns) noexcept override;
  void withdraw(std::span<Exchange> exchanges, std::uint64_t now_ns) noexcept override;
  void end(Status status, std::uint64_t now_ns) noexcept override;
  void cut(Status status, std::uint64_t now_ns) noexcept override;
  void forget(Status status) noexcept override;
  void claim(std::uint32_t group, PublishRing* ring) noexcept override;

  // An exchange group is not defined again in the next session.
  void forget_exchange(std::uint32_t group) noexcept { exchange_groups_[group] = {}; }
  // A new session is being set up as the last one was: what groups consist of is still read.
  [[nodiscard]] bool restoring() const noexcept { return !idle(restoration_); }
  // Writes without an answer, 1 to post_words_max of them in one message. False: no room until the device has confirmed some; it is asked to.
  static constexpr std::size_t post_words_max = 32;  // what is lost with one message
  [[nodiscard]] bool post(std::span<const Post> words, std::uint64_t now_ns) noexcept;
  [[nodiscard]] const PostQueue& posts() const noexcept { return posts_; }
  // Posts of sessions that were lost before the device had confirmed them; asking forgets them.
  [[nodiscard]] std::uint64_t take_unknown_posts() noexcept { return std::exchange(unknown_posts_, 0); }
  [[nodiscard]] std::uint64_t sessions() const noexcept { return sessions_; }
  [[nodiscard]] std::uint16_t epoch() const noexcept { return decoder_.key().epoch; }

 private:
  // silent: nobody has asked yet. checking: HELLO has been sent to see whether the session is still there.
  enum class State : std::uint8_t { silent, greeting, opening, open, checking };
  struct Sink;  // what the decoder calls
  static constexpr std::size_t greeting_bytes = 128;  // HELLO or OPEN and its answer, and what stood on the line before

  struct Place {
    [[nodiscard]] bool taken_over() const noexcept { return exchange == nullptr || refusal.has_value(); }

    Exchange* exchange = nullptr;     // nullptr while used: given up; a SYNC takes the id over
    bool used = false;
    bool due = false;                 // to be sent (again)
    bool barrier = false;
    bool unbound = true;              // its barrier is to be set at the next sending
    bool chained = false;             // a SYNC that takes its id over waits for its turn likewise: what is chained behind it must not go first
    bool doubted = false;             // an answer that tells of an error has come; it counts when it comes again
    std::optional<Status> refusal;    // what its caller is told if the SYNC that takes its id over shows that it was not executed
    std::uint16_t id = 0;
    std::uint16_t post = 0;           // executed before it, if `barrier`
    std::uint32_t bytes = 0;          // of its frame, against the credit
    std::uint32_t transmissions = 0;
    std::uint64_t first_order = 0;    // of all transmissions, its first and last
    std::uint64_t last_order = 0;
    std::uint64_t first_sent_ns = 0;
    std::uint64_t sent_ns = 0;
    std::uint64_t wait_ns = 0;        // from sent_ns until it is due
    std::uint64_t limit_ns = 0;       // when it is given up
  };

  struct Group {
    PublishRing* ring = nullptr;
    std::span<const std::uint32_t> addresses;  // the subscription's, which outlives its claim
    std::uint32_t divisor = 0;
    bool on_event = false;
    std::uint16_t sequence = 0;       // of the next publish
  };

  struct ExchangeGroup {
    std::span<const ExchangeWord> outputs;  // of who defined it, to be kept until it is forgotten
    std::span<const ExchangeWord> inputs;
  };

  // what goes out (framed_engine.cpp)
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

  // what comes in (framed_engine_receive.cpp)
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
  void on_opened(std::uint16_t epoch) noexcept;
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
  [[nodiscard]] std::uint64_t allowance_ns(std::size_t bytes) const noexcept { return 2 * settings_.byte_time_ns * bytes; }
  [[nodiscard]] std::uint64_t keep_alive_ns() const noexcept;
  [[nodiscard]] std::uint64_t clock_interval_ns() const noexcept;

  EngineSettings settings_;
  const bool probe_;
  FrameDecoder decoder_;
  State state_ = State::silent;
  bool text_ = false;                   // within a classic line
  std::size_t text_bytes_ = 0;          // of it so far
  std::array<char, 4> text_head_{};     // its first bytes
  std::uint32_t passed_over_ = 0;       // HELLOs that were not answered while the classic question behind them was
  std::optional<Greeting> greeting_;
  std::uint16_t offered_epoch_;         // that OPEN has asked for
  bool greeting_due_ = false;           // HELLO or OPEN, by the state
  std::uint64_t greeting_deadline_ns_ = 0;
  std::uint64_t greeting_wait_ns_ = 0;
  std::uint64_t greeting_sent_ns_ = 0;
  std::uint64_t greeting_from_ns_ = 0;  // not sent before
  std::uint32_t in_vain_ = 0;           // HELLOs and OPENs that the device has brought about since it last answered a request
  std::uint32_t openings_ = 0;           // OPENs since the last HELLO answer
  std::uint64_t sessions_ = 0;
  std::uint32_t session_epoch_ = no_session;  // that the device was last heard to have

  ExchangeList waiting_;
  std::uint32_t window_ = 1;
  std::uint16_t next_id_ = 0;
  std::uint16_t base_id_ = 0;           // the oldest that is not answered, or next_id_
  std::uint32_t due_ = 0;               // places that are due
  std::uint32_t given_up_ = 0;          // places whose SYNC has not been answered, and whose caller does not wait for that
  std::uint32_t credit_ = 0;            // bytes of requests in flight
  std::uint32_t in_flight_ = 0;         // requests: places that are used
  std::uint64_t order_ = 0;             // transmissions so far
  std::array<Place, window_max> places_;

  std::uint64_t smoothed_ns_ = 0;       // round trip, 0: none measured
  std::uint64_t variation_ns_ = 0;
  std::uint64_t quickest_ns_ = no_deadline;

  PostQueue posts_;
  std::uint64_t unknown_posts_ = 0;
  std::uint64_t careful_until_ns_ = 0;  // only few posts in flight before: one was lost
  std::uint64_t post_bytes_ = 0;        // of the last one's frame
  std::uint64_t gone_back_order_ = 0;   // transmissions when the posts were last begun again
  std::array<Exchange, 4> confirmations_;  // the engine's own questions how far the posts have come: the next one's answer shows that one's is lost
  std::uint64_t confirming_ = 0;        // posts sent before the last of these
  std::uint64_t confirm_ns_ = no_deadline;

  std::array<Group, protocol::limits::groups_max> groups_;
  std::array<ExchangeGroup, protocol::limits::exchanges_max> exchange_groups_;
  Exchange restoration_;                // the engine's own request that sets a new session up
  std::uint32_t restored_ = 0;          // steps of it that are done
  std::uint32_t restored_most_ = 0;     // since a session was last set up whole
  bool publishing_ = false;
  std::uint32_t deadman_ticks_ = 0;

  ClockFit clock_;
  Exchange reading_;                    // the engine's own reading of the device's clock
  std::array<std::uint32_t, 2> read_clock_{};
  std::uint64_t clock_due_ns_ = no_deadline;
  std::uint64_t last_sent_ns_ = 0;

  std::size_t pending_begin_ = 0;
  std::size_t pending_end_ = 0;
  std::array<std::uint8_t, transmit_bytes_max> pending_;
};

}  // namespace unitylink
