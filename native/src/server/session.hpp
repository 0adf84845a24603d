// SPDX-License-Identifier: BSD-3-Clause
// One client. To it, the server is a board that speaks the framed protocol (docs/protocol.md). Bytes in, bytes out, and
// errands for the board. No I/O.
//
// Order. A board executes the requests of a client in the order in which they arrive. Here a request that changes
// something waits until all before it are answered, and all after it wait for its answer. Only reads go to the board
// together. So nothing can overtake a write, also on a line that loses messages.
//
// An answer is sent only after the board's own answer. If the board gives none, the client loses its connection. It
// cannot know more than that, and the same happens with a board of its own.
//
// Unlike a board, a session keeps every answer of the window, however long, so a repeat is never executed again.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "device/framed/frame_request.hpp"
#include "layer1_stream/frame_decoder.hpp"
#include "layer1_stream/frame_encoder.hpp"
#include "server/grant.hpp"
#include "server/host.hpp"

namespace unitylink::server {

struct Counters {
  std::uint64_t requests = 0;        // executed, posts included
  std::uint64_t refused = 0;         // not allowed
  std::uint64_t repeats = 0;         // answered from what was kept, or still under way
  std::uint64_t discarded = 0;       // frames that could not be read, or had no session
  std::uint64_t publishes = 0;       // sent
  std::uint64_t publishes_lost = 0;  // left out, because the client does not read fast enough
};

class Session {
 public:
  using Status = std::uint32_t;  // one of protocol::reply_status

  // Clients of the same `user` share his turns.
  Session(Host& host, Grant grant, std::uint16_t seed, std::uint64_t now_ns, std::uint32_t user = 0);

  // Takes bytes of the client. What can be executed at once, is.
  void take(std::span<const std::uint8_t> bytes, std::uint64_t now_ns);
  // False: so much waits to be executed or to be sent that no more bytes are taken for now.
  [[nodiscard]] bool wants_bytes() const noexcept;
  // The board has answered.
  void finish(Errand& errand);
  // A publish of the group. It is left out if the client does not read.
  void publish(std::uint32_t group, std::uint32_t missing, std::uint32_t clock, std::span<const std::uint8_t> words);

  [[nodiscard]] std::uint32_t user() const noexcept { return user_; }
  // The bytes for the client. After sending, the caller tells how many were sent.
  [[nodiscard]] std::span<const std::uint8_t> output() const noexcept { return std::span(out_).subspan(sent_); }
  void sent(std::size_t bytes) noexcept;
  // True: the board has not answered something. The connection must end.
  [[nodiscard]] bool lost() const noexcept { return lost_; }

  [[nodiscard]] bool open() const noexcept { return key_.epoch != protocol::frame::open_epoch; }
  // The dead-man of this client: its limit in ticks (0: none), and when it is over.
  [[nodiscard]] std::uint32_t dead_man_ticks() const noexcept { return dead_man_ticks_; }
  [[nodiscard]] std::uint64_t dead_man_due_ns() const noexcept;
  // The dead-man of the board has tripped, so none runs. One that was not over by itself runs again when the board is
  // armed, whoever does that.
  void rest_dead_man(std::uint64_t now_ns) noexcept;
  void wake_dead_man(std::uint64_t now_ns) noexcept;
  // The time since its last frame.
  [[nodiscard]] std::uint64_t silent_ns(std::uint64_t now_ns) const noexcept {
    return now_ns > fed_ns_ ? now_ns - fed_ns_ : 0;
  }
  void set_grant(Grant grant) { grant_ = std::move(grant); }
  // What a session asks of the one who governs: the write lease of an address, or that writes are allowed again.
  enum class Ask : std::uint8_t { nothing, lease, arm };
  // It was decided. Continues with the request that waits for it: ok, or it is refused with this status.
  void resume(Ask what, Status outcome);
  // Its session was closed, or none was opened. So it leaves in order.
  [[nodiscard]] bool left_in_order() const noexcept { return !open(); }
  [[nodiscard]] const Counters& counters() const noexcept { return counters_; }

  // Called by the decoder.
  void on_frame(const Frame& frame);
  void on_discard(Discard why, std::uint8_t kind, std::size_t bytes);

 private:
  struct Place {
    std::uint16_t id = 0;
    bool empty = true;     // nothing was executed here
    bool running = false;  // the request `running_id` is at the board
    std::uint16_t running_id = 0;
    std::uint8_t status = 0;
    std::vector<std::uint8_t> reply;
  };
  struct ExchangeGroup {
    std::vector<device::ExchangeWord> outputs;
    std::vector<device::ExchangeWord> inputs;
    bool defined = false;
  };

  void hello(std::span<const std::uint8_t> payload);
  void open_session(std::span<const std::uint8_t> payload);
  void begin_session(const FrameKey& key);
  void forget(const FrameKey& key);

  void pump();
  [[nodiscard]] bool start(const Waiting& next);
  void perform(const Waiting& next);
  void perform_here();
  void tell_clock();
  void settle_here(Status outcome);
  void forward(std::uint8_t kind, std::span<const std::uint8_t> body, std::size_t answer_bytes, bool changes);
  [[nodiscard]] bool shareable() const noexcept;
  void forward_exchange();
  [[nodiscard]] bool start_posts();
  void finish_posts(Errand& errand);
  void fail_post(std::uint16_t number, Status why) noexcept;
  [[nodiscard]] Status define_exchange();
  [[nodiscard]] Status write_control();
  void overlay(const Errand& errand, std::span<std::uint8_t> values) const noexcept;
  [[nodiscard]] std::size_t exchange_inputs(const Errand& errand, std::span<std::uint8_t> data) const noexcept;
  // What a client lacks for a request: nothing, a right, what it has asked for and does not get, or an answer.
  enum class Lack : std::uint8_t { nothing, right, refused, answer };
  [[nodiscard]] Lack lack(std::uint32_t address, bool writes);
  [[nodiscard]] Lack lack_to_arm();
  [[nodiscard]] bool arms() const noexcept;
  [[nodiscard]] bool may_ask_to_arm() const noexcept;
  [[nodiscard]] Lack lack();
  [[nodiscard]] bool refuses(Lack lack, Status& why) noexcept;
  [[nodiscard]] bool executed(std::uint16_t id) const noexcept;
  [[nodiscard]] Place& place_of(std::uint16_t id) noexcept { return places_[id & (places_.size() - 1)]; }

  void settle(std::uint16_t id, Status status, std::span<const std::uint8_t> data);
  void reply(std::uint16_t id, Status status, std::span<const std::uint8_t> data);
  void send(std::uint8_t kind, std::span<const std::uint8_t> payload);
  [[nodiscard]] device::FrameRequest::Widths widths() const noexcept;
  [[nodiscard]] std::uint32_t features() const noexcept;
  [[nodiscard]] std::uint32_t exchange_words_most() const noexcept;

  Host& host_;
  Grant grant_;
  std::uint32_t user_;
  Ask asks_ = Ask::nothing;  // what is being decided
  Status refused_ = 0;       // why the request that waits does not get what it has asked for; 0: it does
  bool armed_ = false;       // the request that waits wants to arm, and that was done
  Counters counters_;
  FrameDecoder decoder_;
  FrameKey key_;
  std::uint64_t now_ns_ = 0;

  std::uint16_t nonce_;
  bool offered_ = false;
  std::uint16_t session_nonce_ = 0;
  bool closed_told_ = false;

  std::deque<Waiting> waiting_;
  std::size_t waiting_bytes_ = 0;
  std::vector<Place> places_;
  std::uint32_t running_ = 0;  // errands at the board
  bool alone_ = false;         // one of them changes something
  bool lost_ = false;
  device::FrameRequest request_;

  std::uint16_t posts_ = 0;
  std::uint16_t failed_posts_ = 0;
  std::uint16_t first_failed_ = 0;
  Status first_failure_ = 0;

  static constexpr std::uint32_t exchanges_kept = 4;
  std::vector<ExchangeGroup> exchanges_;
  std::vector<std::uint16_t> sequences_;  // of the next publish of each group
  bool publishing_ = false;
  std::uint32_t dead_man_ticks_ = 0;
  std::uint32_t resting_ticks_ = 0;  // its limit, until the board is armed
  std::uint64_t fed_ns_;             // its last frame
  std::uint64_t trips_ = 0;          // of the board, when the session began

  std::vector<std::uint8_t> payload_;
  std::vector<std::uint8_t> out_;
  std::size_t sent_ = 0;
};

}  // namespace unitylink::server
