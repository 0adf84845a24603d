// SPDX-License-Identifier: BSD-3-Clause
// What the device does with frames: sessions, requests, posts, publishes. docs/protocol.md describes all of it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "device/bus.hpp"
#include "device/configuration.hpp"
#include "device/framed/control_registers.hpp"
#include "device/framed/dead_man.hpp"
#include "device/framed/frame_request.hpp"
#include "device/framed/reply_cache.hpp"
#include "device/framed/session_offer.hpp"
#include "device/framed/waiting_frames.hpp"
#include "device/physical.hpp"
#include "device/subscription_manager.hpp"
#include "layer1_stream/frame_decoder.hpp"
#include "layer1_stream/frame_encoder.hpp"

namespace unitylink::device {

// Frames are executed while others are received. As many wait as in the gateware, and then the port stalls. A frame is
// executed as a whole at one time, and its answer is sent with one byte per clock. While the answer cannot be sent,
// posts are executed and publishes are skipped. While no frame is in work, the classic side may use the port.
class FramedApplication {
 public:
  // All accesses go through `dead_man`, which may refuse writes.
  FramedApplication(const DeviceConfiguration& configuration, SubscriptionManager& subscriptions, DeadMan& dead_man,
                    PhysicalTransmitter& physical);

  // Takes the next byte of a frame, or a border.
  void take(std::uint8_t byte, Clock now);
  // True: no byte can be taken. Too many frames wait, or one of them changes how the next one is read.
  [[nodiscard]] bool stalled() const noexcept { return paused_ || waiting_.full(); }
  // True: bytes of a frame are being sent.
  [[nodiscard]] bool sending() const noexcept { return sent_ < out_.size(); }

  // When the next step is due. `port_free`: no classic message is being sent.
  [[nodiscard]] Clock next_clock(bool port_free) const noexcept;
  // Does one step. Nothing else happens before `limit`, so all bytes that are sent until then are one step.
  void step(Clock now, bool port_free, Clock limit);

  [[nodiscard]] std::uint16_t offers() const noexcept { return offer_.made(); }
  [[nodiscard]] bool open() const noexcept { return key_.epoch != protocol::frame::open_epoch; }
  void count(std::uint32_t counter) noexcept { registers_.count(counter); }

  // Called by the decoder.
  void on_frame(const Frame& frame);
  void on_discard(Discard why, std::uint8_t kind, std::size_t bytes);

 private:
  using Status = std::uint32_t;  // one of protocol::reply_status

  struct Exchange {
    bool defined = false;
    std::vector<ExchangeWord> outputs;
    std::vector<ExchangeWord> inputs;
  };
  struct Group {
    std::uint16_t sequence = 0;
  };

  // True: the next frame gets no answer, and needs no room for one.
  [[nodiscard]] bool says_nothing() const noexcept;
  void execute();
  void hello(std::span<const std::uint8_t> payload);
  void open_session(std::span<const std::uint8_t> payload);
  void begin_session(const FrameKey& key);
  void post(std::uint8_t kind, std::span<const std::uint8_t> payload);
  void request(std::uint8_t kind, std::span<const std::uint8_t> payload);
  [[nodiscard]] bool built(std::uint32_t operation) const noexcept;
  [[nodiscard]] Status untimely() const noexcept;
  [[nodiscard]] Status refusal(bool repeated) const noexcept;
  [[nodiscard]] Status control_refusal() const noexcept;
  [[nodiscard]] Status perform(bool repeated);
  [[nodiscard]] Status perform_list(bool repeated);
  [[nodiscard]] Status perform_exchange(bool repeated);
  void define_group();
  void write_control();
  [[nodiscard]] std::uint32_t control(std::uint32_t address) noexcept;
  void publish(std::uint32_t group);
  void trip(Clock now);

  [[nodiscard]] Status read(std::uint32_t address, std::uint32_t& value);
  [[nodiscard]] Status write(std::uint32_t address, std::uint32_t value);
  [[nodiscard]] Status access(BusStatus status) noexcept;
  [[nodiscard]] Status write_word(const ListWord& word);

  void put(std::uint32_t value, std::size_t bytes);  // into the current reply
  void reply(Status status, std::span<const std::uint8_t> data);
  void send(std::uint8_t kind, std::span<const std::uint8_t> payload);
  [[nodiscard]] FrameRequest::Widths widths() const noexcept {
    return {configuration_.address_bytes(), configuration_.data_bytes()};
  }

  const DeviceConfiguration& configuration_;
  SubscriptionManager& subscriptions_;
  DeadMan& bus_;
  PhysicalTransmitter& physical_;

  FrameDecoder decoder_;
  FrameKey key_;
  ControlRegisters registers_;
  ReplyCache cache_;
  FrameRequest request_;
  std::vector<Exchange> exchanges_;
  std::vector<Group> groups_;

  Clock at_ = 0;           // time of the current step; time of the last byte sent
  WaitingFrames waiting_;  // frames, or CLOSED, that are not yet executed
  Clock taken_at_ = 0;     // time of the last byte taken
  bool paused_ = false;    // an OPEN or CLOSE waits

  SessionOffer offer_;
  std::uint16_t session_nonce_ = 0;
  bool closed_told_ = false;
  bool publishing_ = false;
  std::uint16_t posts_ = 0;
  std::uint16_t failed_posts_ = 0;
  std::uint16_t first_failed_ = 0;
  Status first_failure_ = 0;

  std::vector<std::uint8_t> data_;  // the data of the current reply, after `posts`
  std::vector<std::uint8_t> payload_;
  std::vector<std::uint8_t> out_;
  std::size_t sent_ = 0;
};

}  // namespace unitylink::device
