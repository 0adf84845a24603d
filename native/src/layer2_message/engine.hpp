// SPDX-License-Identifier: BSD-3-Clause
// What Link needs of an engine, whichever protocol it speaks: requests in, bytes out; bytes in, verdicts out. Sans I/O:
// it is given bytes and times and gives bytes and verdicts, so that tests can run it on a virtual clock. ClassicEngine
// and FramedEngine speak a protocol; MappedEngine needs none.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "layer1_stream/configuration.hpp"
#include "layer1_stream/crc8.hpp"
#include "layer2_message/exchange.hpp"
#include "layer2_message/publish_ring.hpp"
#include "layer2_message/statistics.hpp"

namespace unitylink {

struct EngineSettings {
  Crc8 sum{};  // of the classic protocol
  // false: the gateware has none, and a '$' may hang it, so that none is ever sent
  bool checksums = true;
  std::uint32_t receive_fifo_bytes = protocol::limits::fifo_bytes_default;   // the device's, for classic requests
  std::uint32_t transmit_fifo_bytes = protocol::limits::fifo_bytes_default;  // the device's, for classic replies
  std::uint32_t window = 64;                                                 // requests in flight together
  std::uint64_t timeout_ns = 100'000'000;
  std::uint64_t byte_time_ns = 0;  // on the wire: long messages are given the time they need
  // the CRC-32C in every frame, where the device knows it: for links that lose order
  bool checked_long = false;
  std::uint64_t seed = 0;  // what the epochs of framed sessions are drawn from
};

class Engine {
 public:
  static constexpr std::uint64_t no_deadline = ~std::uint64_t{0};

  Engine() = default;
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;
  virtual ~Engine() = default;

  // Widths are needed before anything but the request that begins a link is submitted.
  virtual void configure(const Configuration& configuration) noexcept = 0;
  virtual void submit(Exchange& exchange, std::uint64_t now_ns) noexcept = 0;
  virtual void receive(std::span<const std::uint8_t> bytes, std::uint64_t now_ns) noexcept = 0;
  // What is to be sent now; sent() says how much of it has been.
  [[nodiscard]] virtual std::span<const std::uint8_t> transmit(std::uint64_t now_ns) noexcept = 0;
  virtual void sent(std::size_t bytes) noexcept = 0;
  virtual void advance(std::uint64_t now_ns) noexcept = 0;
  [[nodiscard]] virtual std::uint64_t next_deadline_ns() const noexcept = 0;
  // Takes requests back: all of them are done afterwards.
  virtual void abandon(std::span<Exchange> exchanges, std::uint64_t now_ns) noexcept = 0;
  // The gentle form: what is on its way is waited for, at most the usual time, but not sent again.
  virtual void withdraw(std::span<Exchange> exchanges, std::uint64_t now_ns) noexcept = 0;
  // Ends everything, with `status`; writes on their way end unknown. Nothing is accepted any more.
  virtual void end(Status status, std::uint64_t now_ns) noexcept = 0;
  // The line is gone, not for ever: all that is under way ends with `status`, writes of which something has left
  // unknown, and nothing of it is sent again. What is submitted from then on begins anew, on another line.
  virtual void cut(Status status, std::uint64_t now_ns) noexcept = 0;
  // Ends a request that has not been submitted.
  void decline(Exchange& exchange, Status status, std::uint64_t now_ns) noexcept {
    now_ns_ = exchange.begun_ns = now_ns;
    finish(exchange, status);
  }
  // The line comes back: a board that serves another program is asked again later, and is not the end.
  void set_lasting() noexcept { lasting_ = true; }
  // The same as end() without telling anybody: their threads are in another process.
  virtual void forget(Status status) noexcept = 0;

  // Who gets a group's publishes; nullptr: nobody, they are counted as unclaimed.
  virtual void claim(std::uint32_t group, PublishRing* ring) noexcept { rings_[group] = ring; }
  [[nodiscard]] const Configuration& configuration() const noexcept { return configuration_; }
  [[nodiscard]] Statistics& statistics() noexcept { return statistics_; }
  [[nodiscard]] const Statistics& statistics() const noexcept { return statistics_; }
  [[nodiscard]] std::uint64_t last_answer_ns() const noexcept { return last_answer_ns_; }
  [[nodiscard]] std::uint64_t now_ns() const noexcept { return now_ns_; }  // the last time it was given
  [[nodiscard]] std::uint64_t completed() const noexcept { return completed_; }
  [[nodiscard]] std::optional<Status> ended() const noexcept { return ended_; }

 protected:
  void finish(Exchange& exchange, Status status) noexcept {
    exchange.status = status;
    exchange.ended_ns = now_ns_;
    exchange.state_ = Exchange::State::done;
    completed_ += 1;
    if (status != Status::ok && exchange.batch != nullptr) {
      exchange.batch->failed = true;
    }
    if (exchange.on_done != nullptr) {
      exchange.on_done(exchange);
    }
  }

  Configuration configuration_;
  Statistics statistics_;
  std::optional<Status> ended_;
  std::uint64_t now_ns_ = 0;
  std::uint64_t last_answer_ns_ = 0;  // 0: never
  std::uint64_t completed_ = 0;
  std::uint64_t progress_ns_ = 0;  // the last answer to a caller: what waits behind it has its time from then on
  std::uint64_t look_ns_ = 0;      // when the first of those that wait may be late
  bool lasting_ = false;
  std::array<PublishRing*, protocol::limits::groups_max> rings_{};
};

}  // namespace unitylink
