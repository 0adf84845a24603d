// SPDX-License-Identifier: BSD-3-Clause
// The interface between Link and its engine. The engine turns requests into bytes, and received bytes into results. It
// does no I/O and reads no clock: it gets bytes and times from its caller, so tests can run it on a virtual clock.
// ClassicEngine and FramedEngine each speak a protocol. MappedEngine needs none.
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
  Crc8 sum{};  // the checksum of the classic protocol
  // false: the gateware has no checksums. A '$' could hang it, so none is ever sent
  bool checksums = true;
  std::uint32_t receive_fifo_bytes = protocol::limits::fifo_bytes_default;   // of the device, for classic requests
  std::uint32_t transmit_fifo_bytes = protocol::limits::fifo_bytes_default;  // of the device, for classic replies
  std::uint32_t window = 64;                                                 // most requests in flight
  std::uint64_t timeout_ns = 100'000'000;
  std::uint64_t byte_time_ns = 0;  // on the wire; long messages get more time
  // every frame has the CRC-32C, if the device knows it; for links that lose the order of bytes
  bool checked_long = false;
  std::uint64_t seed = 0;  // for the random epochs of framed sessions
};

// Takes the publishes of all groups as they are, before they become words with a time. Called with the engine's lock
// held.
class PublishTap {
 public:
  // `missing`: publishes of this group that were lost before this one. `clock`: the low half of the device's time.
  virtual void on_publish(std::uint32_t group, std::uint32_t missing, std::uint32_t clock,
                          std::span<const std::uint8_t> words) noexcept = 0;

 protected:
  ~PublishTap() = default;
};

class Engine {
 public:
  static constexpr std::uint64_t no_deadline = ~std::uint64_t{0};

  Engine() = default;
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;
  virtual ~Engine() = default;

  // Gives the widths of the device. Only the request that begins a link (resynchronise) can be submitted before.
  virtual void configure(const Configuration& configuration) noexcept = 0;
  // Takes a request. The caller keeps it, and the buffers that it points to, until it is done.
  virtual void submit(Exchange& exchange, std::uint64_t now_ns) noexcept = 0;
  // Takes bytes from the device.
  virtual void receive(std::span<const std::uint8_t> bytes, std::uint64_t now_ns) noexcept = 0;
  // The bytes to send now. After sending, the caller tells by sent() how many were sent.
  [[nodiscard]] virtual std::span<const std::uint8_t> transmit(std::uint64_t now_ns) noexcept = 0;
  virtual void sent(std::size_t bytes) noexcept = 0;
  // Requests that transmit() has not reached yet.
  [[nodiscard]] virtual std::size_t backlog() const noexcept { return 0; }
  // Does what is due by now, such as timeouts. Call it at next_deadline_ns() at the latest.
  virtual void advance(std::uint64_t now_ns) noexcept = 0;
  [[nodiscard]] virtual std::uint64_t next_deadline_ns() const noexcept = 0;
  // Gives requests up: all of them are done when this returns.
  virtual void abandon(std::span<Exchange> exchanges, std::uint64_t now_ns) noexcept = 0;
  // Gives requests up, but still waits for those that were sent, for the usual time. It sends none of them again.
  virtual void withdraw(std::span<Exchange> exchanges, std::uint64_t now_ns) noexcept = 0;
  // Ends the engine. All requests get `status`, except writes that were sent: their status is unknown. No request is
  // accepted afterwards.
  virtual void end(Status status, std::uint64_t now_ns) noexcept = 0;
  // The line is gone and may come back. All requests get `status`, except writes of which a byte was sent: their status
  // is unknown. None of them is sent again. Later requests go to the new line.
  virtual void cut(Status status, std::uint64_t now_ns) noexcept = 0;
  // Ends a request that was not submitted.
  void decline(Exchange& exchange, Status status, std::uint64_t now_ns) noexcept {
    now_ns_ = exchange.begun_ns = now_ns;
    finish(exchange, status);
  }
  // For a link with reconnect=1. If the board serves another program, the engine asks again later, and does not end.
  void set_lasting() noexcept { lasting_ = true; }
  // For a forked child. Like end(), but calls nobody, because the waiting threads are in the parent.
  virtual void forget(Status status) noexcept = 0;

  // From now on the publishes of the group go into `ring`. nullptr: they are dropped, and counted as unclaimed.
  virtual void claim(std::uint32_t group, PublishRing* ring) noexcept { rings_[group] = ring; }
  // From now on the publishes go to `tap`, too. Framed only.
  void tap(PublishTap* tap) noexcept { tap_ = tap; }
  [[nodiscard]] const Configuration& configuration() const noexcept { return configuration_; }
  [[nodiscard]] Statistics& statistics() noexcept { return statistics_; }
  [[nodiscard]] const Statistics& statistics() const noexcept { return statistics_; }
  [[nodiscard]] std::uint64_t last_answer_ns() const noexcept { return last_answer_ns_; }
  [[nodiscard]] std::uint64_t now_ns() const noexcept { return now_ns_; }  // the time of the last call
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
  std::uint64_t progress_ns_ = 0;  // when a caller was last answered; the time limit of the next request begins here
  std::uint64_t look_ns_ = 0;      // when the first waiting request may be late
  bool lasting_ = false;
  std::array<PublishRing*, protocol::limits::groups_max> rings_{};
  PublishTap* tap_ = nullptr;
};

}  // namespace unitylink
