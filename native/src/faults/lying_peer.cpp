// SPDX-License-Identifier: BSD-3-Clause
#include "faults/lying_peer.hpp"

#include <array>
#include <string_view>
#include <utility>

#include "layer1_stream/frame_decoder.hpp"
#include "layer1_stream/frame_encoder.hpp"
#include "layer1_stream/frame_heads.hpp"

namespace unitylink::faults {
namespace {

using namespace protocol;

constexpr std::uint8_t reply_last = device_kind::reply + reply_status::no_group;

LyingPeer::Bytes text(std::string_view line) { return LyingPeer::Bytes(line.begin(), line.end()); }

constexpr std::array refusals{reply_status::behind,     reply_status::order,    reply_status::invalid,
                              reply_status::denied,     reply_status::too_long, reply_status::no_group,
                              reply_status::bad_address};

LyingPeer::Bytes frame_of(std::uint8_t kind, std::span<const std::uint8_t> payload, const FrameKey& key = {}) {
  LyingPeer::Bytes frame(2 * payload.size() + 16, 0);
  frame.resize(FrameEncoder(frame, kind, key).bytes(payload).finish());
  return frame;
}

struct Payload {
  std::vector<std::uint8_t> bytes;
  void on_frame(const Frame& frame) { bytes.assign(frame.payload.begin(), frame.payload.end()); }
  void on_discard(Discard, std::uint8_t, std::size_t) {}
};

std::vector<std::uint8_t> payload_of(const LyingPeer::Bytes& message, const FrameKey& key) {
  FrameDecoder decoder;
  decoder.set_key(key);
  Payload payload;
  static_cast<void>(decoder.take(message, payload));
  return payload.bytes;
}

}  // namespace

bool LyingPeer::ends(std::uint8_t byte) const noexcept {
  return framed_ ? byte == frame::delimiter : byte == static_cast<std::uint8_t>(bytes::line_feed);
}

LyingPeer::Bytes LyingPeer::say(std::uint8_t byte) {
  const bool honest = peer_ == Peer::honest || passed_on_;
  Bytes passed = peer_ == Peer::honest && !passed_on_ ? open_ : Bytes{};
  open_.push_back(byte);
  passed.push_back(byte);
  passed_on_ = honest && !ends(byte);
  if (!ends(byte)) {
    return honest ? passed : Bytes{};
  }
  const Bytes message = std::exchange(open_, {});
  if (framed_ && message[0] == device_kind::open) {
    if (const std::vector<std::uint8_t> payload = payload_of(message, {}); payload.size() == 6) {
      key_.epoch = static_cast<std::uint16_t>(payload[0] << 8 | payload[1]);
    }
  }
  if (honest) {
    return passed;
  }
  Bytes out = message.size() > 1 ? instead(message) : message;
  lies_ += out != message ? 1 : 0;
  return out;
}

LyingPeer::Bytes LyingPeer::heard(std::uint8_t byte) {
  const bool ended = byte == frame::delimiter && heard_ != frame::delimiter;
  heard_ = byte;
  if (!ended || peer_ != Peer::renewing || !framed_ || greeting_.empty()) {
    return {};
  }
  lies_ += 1;
  return greeting();
}

LyingPeer::Bytes LyingPeer::instead(const Bytes& message) {
  if (peer_ == Peer::dead) {
    return {};
  }
  return framed_ ? instead_of_frame(message) : instead_of_line(message);
}

LyingPeer::Bytes LyingPeer::instead_of_frame(const Bytes& message) {
  const std::uint8_t kind = message[0];
  if (kind == device_kind::hello) {
    greeting_ = payload_of(message, key_);
  }
  const bool replies = kind >= device_kind::reply && kind <= reply_last;
  switch (peer_) {
    case Peer::half_dead: return replies ? Bytes{} : message;
    case Peer::closing: return replies ? frame_of(device_kind::closed, {}) : message;
    case Peer::renewing:
      return replies ? frame_of(device_kind::closed, {}) : kind == device_kind::hello ? greeting() : Bytes{};
    case Peer::refusing:
      return replies ? refusal(message, static_cast<std::uint8_t>(refusals[random_() % refusals.size()])) : message;
    case Peer::waiting: return replies ? refusal(message, static_cast<std::uint8_t>(reply_status::order)) : message;
    default: return message;
  }
}

LyingPeer::Bytes LyingPeer::instead_of_line(const Bytes& message) {
  const std::string_view line(reinterpret_cast<const char*>(message.data()), message.size());
  const bool configuration = line.substr(1).starts_with(reply::read_configuration);
  switch (peer_) {
    case Peer::half_dead: return configuration ? message : Bytes{};
    case Peer::closing: return configuration ? message : text("?f4\n");
    case Peer::renewing: return configuration ? text("$CNF:01*00\n") : Bytes{};
    case Peer::refusing: return configuration ? message : text("$S_\n");
    default: return message;
  }
}

// The answer to the same request, but with an error that says that nothing was executed.
LyingPeer::Bytes LyingPeer::refusal(const Bytes& message, std::uint8_t status) {
  const std::vector<std::uint8_t> payload = payload_of(message, key_);
  if (payload.size() < frame_head::reply) {
    return {};
  }
  return frame_of(static_cast<std::uint8_t>(device_kind::reply + status), std::span(payload).first(frame_head::reply),
                  key_);
}

// An answer to HELLO with another nonce each time, and without an open session.
LyingPeer::Bytes LyingPeer::greeting() {
  if (greeting_.size() < 5) {
    return {};
  }
  std::vector<std::uint8_t> payload = greeting_;
  payload[1] = static_cast<std::uint8_t>(random_());
  payload[2] = static_cast<std::uint8_t>(random_());
  payload[3] = payload[4] = 0xFF;
  return frame_of(device_kind::hello, payload);
}

}  // namespace unitylink::faults
