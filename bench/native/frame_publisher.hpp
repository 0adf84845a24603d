// SPDX-License-Identifier: BSD-3-Clause
// A stream of framed publishes that can be checked: word i of message n is n + i. The twin answers sessions and
// requests. Its own publishes have a period of many days, so the client receives only this stream.
#pragma once

#include <array>
#include <cstdint>
#include <ctime>
#include <memory>
#include <string>
#include <string_view>

#include "device/device.hpp"
#include "layer1_stream/frame_decoder.hpp"
#include "layer1_stream/frame_encoder.hpp"
#include "unitylink/protocol.hpp"

namespace unitylink::bench {

class FramePublisher {
 public:
  explicit FramePublisher(std::uint32_t words) : words_(words) { reset(); }

  // One publish has group, sequence, clock and words.
  [[nodiscard]] std::size_t publish_bytes() const { return frame_bytes(7 + 4 * words_); }

  void reset() {
    device::DeviceConfiguration configuration;
    configuration.address_bits = 16;
    configuration.group_size = words_;
    clock_hz_ = configuration.clock_hz;
    device_ = std::make_unique<device::Device>(configuration);
    started_ns_ = now_ns();
    decoder_ = {};
    group_words_ = sequence_ = 0;
    enabled_ = false;
  }

  void receive(std::string_view bytes, std::string& out) {
    decoder_.feed(std::span(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()), *this);
    device_->run_until(std::max(device_->clock(), clock()));
    for (const char byte : bytes) {
      while (!device_->receive(static_cast<std::uint8_t>(byte))) {
        device_->run_until(device_->clock() + 1);
      }
    }
    while (!device_->input_empty()) {
      device_->run_until(device_->clock() + 100);
    }
    device_->run_until(device_->clock() + answer_clocks);
    device::TimedByte answer;
    while (device_->take(answer)) {
      out.push_back(static_cast<char>(answer.byte));
    }
  }

  [[nodiscard]] bool publishing() const { return enabled_ && group_words_ == words_; }

  void publish(std::size_t count, std::string& out) {
    const auto time = static_cast<std::uint32_t>(clock());
    std::array<std::uint8_t, frame_bytes_max + 1> frame{};
    for (; count > 0; --count, ++sequence_) {
      FrameEncoder encoder(frame, static_cast<std::uint8_t>(protocol::device_kind::publish), decoder_.key());
      encoder.word(group_, 1).word(sequence_, 2).word(time, 4);
      for (std::uint32_t word = 0; word < words_; ++word) {
        encoder.word(sequence_ + word, 4);
      }
      out.append(reinterpret_cast<const char*>(frame.data()), encoder.finish());
    }
  }

  // ---- called by the decoder of the client's bytes

  void on_frame(const Frame& frame) {
    namespace kind = protocol::request_kind;
    const std::uint32_t plain = frame.kind & ~(protocol::frame::chained_bit | protocol::frame::barrier_bit);
    const std::uint8_t* const at = frame.payload.data() + ((frame.kind & protocol::frame::barrier_bit) != 0 ? 4 : 2);
    if (frame.kind == kind::open) {
      decoder_.set_key(
          {.epoch = static_cast<std::uint16_t>(frame.payload[2] << 8 | frame.payload[3]), .always_long = false});
    } else if (plain == kind::define_group) {
      group_ = at[0];
      group_words_ = at[6];
    } else if (plain == kind::write_control && (at[0] << 8 | at[1]) == protocol::control::publish) {
      enabled_ = at[5] != 0;
    }
  }
  void on_discard(Discard, std::uint8_t, std::size_t) {}

 private:
  static constexpr device::Clock answer_clocks = 20'000;

  static std::uint64_t now_ns() {
    timespec time{};
    clock_gettime(CLOCK_MONOTONIC, &time);
    return static_cast<std::uint64_t>(time.tv_sec) * 1'000'000'000u + static_cast<std::uint64_t>(time.tv_nsec);
  }
  [[nodiscard]] device::Clock clock() const { return (now_ns() - started_ns_) * (clock_hz_ / 1'000'000u) / 1000u; }

  std::uint32_t words_;
  std::uint32_t clock_hz_ = 0;
  std::uint64_t started_ns_ = 0;
  std::unique_ptr<device::Device> device_;
  FrameDecoder decoder_;
  std::uint32_t group_ = 0;
  std::uint32_t group_words_ = 0;
  std::uint32_t sequence_ = 0;
  bool enabled_ = false;
};

}  // namespace unitylink::bench
