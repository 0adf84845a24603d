// SPDX-License-Identifier: BSD-3-Clause
// Layer 1 of the framed protocol: which bytes are sent, and which are accepted. Chunks must not matter, and up to three
// flipped bits must never give another frame.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <random>
#include <string>
#include <vector>

#include "decoder_trace.hpp"
#include "layer1_stream/frame_decoder.hpp"
#include "layer1_stream/frame_encoder.hpp"

using namespace unitylink;
using test::bytes_of;
using test::hex_of;
using Bytes = std::vector<std::uint8_t>;

namespace {

constexpr FrameKey key{.epoch = 0x1234, .always_long = false};

Bytes frame_of(std::uint8_t kind, const Bytes& payload, const FrameKey& session = key) {
  Bytes room(frame_bytes_max + 1);
  const std::size_t size = FrameEncoder(room, kind, session).bytes(payload).finish();
  REQUIRE(size > 0);
  CHECK(size <= frame_bytes(payload.size(), session.always_long));
  room.resize(size);
  return room;
}

struct Heard {
  std::vector<std::pair<std::uint8_t, Bytes>> frames;
  std::vector<Discard> discards;
  std::size_t discarded_bytes = 0;
  void on_frame(const Frame& frame) {
    frames.emplace_back(frame.kind, Bytes(frame.payload.begin(), frame.payload.end()));
  }
  void on_discard(Discard why, std::uint8_t, std::size_t bytes) {
    discards.push_back(why);
    discarded_bytes += bytes;
  }
};

Heard heard(const Bytes& wire, const FrameKey& session = key, std::size_t payload_max = frame_payload_max) {
  FrameDecoder decoder;
  decoder.set_key(session);
  decoder.set_payload_max(payload_max);
  Heard sink;
  decoder.feed(wire, sink);
  return sink;
}

Bytes random_payload(std::mt19937& random, std::size_t size, unsigned zeros_of_8) {
  Bytes payload(size);
  for (std::uint8_t& byte : payload) {
    byte = random() % 8 < zeros_of_8 ? 0 : static_cast<std::uint8_t>(random());
  }
  return payload;
}

Bytes joined(std::initializer_list<Bytes> pieces) {
  Bytes whole;
  for (const Bytes& piece : pieces) {
    whole.insert(whole.end(), piece.begin(), piece.end());
  }
  return whole;
}

}  // namespace

TEST_CASE("the CRCs are those of the catalogue, by eight bytes as by one") {
  CHECK(Crc16::of(bytes_of("123456789"), 0xFFFF) == protocol::frame::crc16_check);
  CHECK(Crc32c::of(bytes_of("123456789"), 0xFFFFFFFF) == protocol::frame::crc32_check);
  std::mt19937 random(1);
  for (std::size_t size = 0; size < 64; ++size) {
    const Bytes data = random_payload(random, size, 1);
    const auto start = static_cast<std::uint32_t>(random());
    auto sum16 = static_cast<std::uint16_t>(start);
    std::uint32_t sum32 = start;
    for (const std::uint8_t byte : data) {
      sum16 = Crc16::update(sum16, byte);
      sum32 = Crc32c::update(sum32, byte);
    }
    CHECK(Crc16::of(data, static_cast<std::uint16_t>(start)) == sum16);
    CHECK(Crc32c::of(data, start) == sum32);
  }
}

TEST_CASE("a frame on the wire, byte for byte") {
  // The payload 00 01 00 20 gives an empty block, a block with 01 and a block with 20.
  const Bytes frame = frame_of(protocol::request_kind::read, {0x00, 0x01, 0x00, 0x20});
  CHECK(hex_of(std::span(frame).first(6)) == "820102010220");
  CHECK(frame.size() == 10);  // section 8 of docs/protocol.md
  CHECK(frame.back() == protocol::frame::delimiter);
  const std::uint16_t sum = Crc16::of(std::span(frame).first(6), key.epoch);
  CHECK(frame[6] == (0x80 | (sum & 0x7F)));
  CHECK(frame[7] == (0x80 | (sum >> 7 & 0x7F)));
  CHECK(frame[8] == (0x80 | sum >> 14));
  CHECK(hex_of(frame_of(protocol::request_kind::hello, {1, 1}, {.epoch = 0xBEEF, .always_long = true}))
            .starts_with("80030101"));
  CHECK(frame_of(protocol::request_kind::hello, {1, 1}) ==
        frame_of(protocol::request_kind::hello, {1, 1}, {.epoch = 7, .always_long = true}));
  std::array<std::uint8_t, 8> small{};
  CHECK(FrameEncoder(small, protocol::request_kind::read, key).word(1, 2).word(2, 2).finish() == 0);
  Bytes large(frame_bytes_max + 100);
  CHECK(FrameEncoder(large, protocol::request_kind::list, key).bytes(Bytes(frame_payload_max + 1, 7)).finish() == 0);
}

TEST_CASE("the constant HELLO has none of the bytes that classic gateware would take for a message") {
  const Bytes hello = frame_of(protocol::request_kind::hello, {protocol::frame::version, protocol::frame::version});
  CHECK(std::none_of(hello.begin(), hello.end(), [](std::uint8_t byte) { return byte >= 0x23 && byte <= 0x26; }));
}

TEST_CASE("every payload comes back, of every length around the blocks and the two checks") {
  std::mt19937 random(2);
  std::vector<std::size_t> sizes{frame_payload_max, frame_payload_max - 1, 1016, 1017, 1018};
  for (std::size_t size = 0; size <= 520; ++size) {
    sizes.push_back(size);
  }
  for (const std::size_t size : sizes) {
    for (const bool always_long : {false, true}) {
      for (const unsigned zeros : {0u, 1u, 8u}) {
        const FrameKey session{.epoch = static_cast<std::uint16_t>(random()), .always_long = always_long};
        Bytes payload = random_payload(random, size, zeros);
        if (zeros == 0) {
          std::replace(payload.begin(), payload.end(), std::uint8_t{0}, std::uint8_t{1});
        }
        const Bytes frame = frame_of(0xC0, payload, session);
        CHECK(std::count(frame.begin(), frame.end(), std::uint8_t{0}) == 1);
        const Heard sink = heard(frame, session);
        REQUIRE(sink.frames.size() == 1);
        REQUIRE(sink.frames[0].second == payload);
        REQUIRE(sink.discards.empty());
      }
    }
  }
}

TEST_CASE("a block that is full at the end of the payload may be followed by an empty one") {
  const Bytes payload(254, 0x55);
  for (const bool with_empty_block : {false, true}) {
    Bytes body = joined({{0xC0, 0xFF}, payload, Bytes(with_empty_block ? 1 : 0, 0x01)});
    const FrameCheck check = FrameCheck::of(body, key);
    CHECK(check.size == (with_empty_block ? protocol::frame::crc32_bytes : protocol::frame::crc16_bytes));
    body.insert(body.end(), check.bytes.begin(), check.bytes.begin() + static_cast<std::ptrdiff_t>(check.size));
    body.push_back(0);
    const Heard sink = heard(body);
    REQUIRE(sink.frames.size() == 1);
    CHECK(sink.frames[0].second == payload);
    CHECK((frame_of(0xC0, payload) == body) == !with_empty_block);  // our encoder adds no such block
  }
}

TEST_CASE("chunks do not matter, nor does what stood before a delimiter") {
  std::mt19937 random(3);
  for (int round = 0; round < 200; ++round) {
    Bytes wire;
    std::vector<std::pair<std::uint8_t, Bytes>> said;
    for (int index = 0; index < 8; ++index) {
      if (random() % 3 == 0) {  // garbage, closed by a delimiter
        const Bytes garbage = random_payload(random, random() % 40, 1);
        wire.insert(wire.end(), garbage.begin(), garbage.end());
        wire.push_back(0);
      }
      const Bytes payload = random_payload(random, random() % 600, random() % 4);
      const auto kind = static_cast<std::uint8_t>(0xC0 + random() % 16);
      const Bytes frame = frame_of(kind, payload);
      wire.insert(wire.end(), frame.begin(), frame.end());
      said.emplace_back(kind, payload);
    }
    FrameDecoder decoder;
    decoder.set_key(key);
    Heard sink;
    for (std::size_t at = 0; at < wire.size();) {
      const std::size_t size = std::min<std::size_t>(1 + random() % 97, wire.size() - at);
      decoder.feed(std::span<const std::uint8_t>(wire).subspan(at, size), sink);
      at += size;
    }
    REQUIRE(sink.frames == said);
    REQUIRE(decoder.pending() == 0);
  }
}

TEST_CASE("what is no frame is discarded with a reason, and the next frame stands") {
  const Bytes good = frame_of(0xC0, {1, 2, 3});
  const auto why = [&](const Bytes& wire, std::size_t payload_max = frame_payload_max) {
    const Heard sink = heard(joined({wire, good}), key, payload_max);
    CHECK(sink.frames.size() == 1);
    REQUIRE(sink.discards.size() == 1);
    return sink.discards[0];
  };
  CHECK(why({0xC0, 0}) == Discard::check);
  CHECK(why({0xC0, 0x01, 0x80, 0x80, 0}) == Discard::check);
  CHECK(why(frame_of(0xC0, {1, 2, 3}, {.epoch = 0x1235, .always_long = false})) == Discard::check);  // another session
  CHECK(why(frame_of(0xC0, {1, 2, 3}, {.epoch = key.epoch, .always_long = true})) == Discard::check);
  CHECK(why(Bytes(joined({Bytes(frame_bytes_max + 1, 7), {0}}))) == Discard::too_long);
  CHECK(why(frame_of(0xC0, Bytes(11, 7)), 10) == Discard::too_long);
  CHECK(heard(frame_of(0xC0, Bytes(10, 7)), key, 10).frames.size() == 1);
  const Bytes broken{0xC0, 0x05, 0x01};  // a block of four bytes, but only one follows
  const FrameCheck check = FrameCheck::of(broken, key);
  CHECK(why(joined({broken, {check.bytes[0], check.bytes[1], check.bytes[2], 0}})) == Discard::cobs);
  CHECK(heard({0, 0, 0}).discards.empty());
  // around the length at which the check changes, nothing is accepted
  for (std::size_t used = 256; used <= 266; ++used) {
    const std::size_t body = used - 4;
    Bytes wire(body, 0x11);
    wire.insert(wire.end(), {0x80, 0x80, 0x80, 0x80, 0});
    CHECK(heard(wire).frames.empty());
  }
}

// Whether the payload has a length that its kind can have, with any widths of the device. A frame in a session starts
// the CRC with another value than one outside. So three flipped bits, one of them in the kind, can turn one into the
// other with a right check. Its length is then wrong.
bool has_length_of_kind(const Frame& frame) {
  const std::size_t size = frame.payload.size();
  switch (frame.kind) {
    case protocol::request_kind::hello: return size == 2;
    case protocol::request_kind::open: return size == 5;
    case protocol::device_kind::hello: return size == 25;
    case protocol::device_kind::open: return size == 6;
    case protocol::device_kind::closed: return size == 2;
    case protocol::device_kind::publish: return size >= 8;
    default: return size >= 2;
  }
}

// Each pattern of errors is moved over the frame and the delimiters on both sides. There is a frame before it, and one
// after it.
TEST_CASE("no error of one to three bits makes a frame") {
  std::mt19937 random(4);
  const std::vector<Bytes> frames{
      frame_of(protocol::request_kind::hello, {1, 1}),
      frame_of(0xD3, {0x12, 0x34}),
      frame_of(protocol::request_kind::read, {0x00, 0x07, 0x00, 0x20}),
      frame_of(protocol::request_kind::write, {0x00, 0x08, 0x01, 0x20, 0xDE, 0xAD, 0xBE, 0xEF}),
      frame_of(0xC0, {0x00, 0x07, 0x00, 0x03, 0x00, 0x00, 0x00, 0x00}),
      frame_of(0xC0, {0x00, 0x07, 0x00, 0x00}, {.epoch = key.epoch, .always_long = true}),
      frame_of(0xD2, random_payload(random, 19, 2)),
      frame_of(0xD2, random_payload(random, 26, 1)),  // 32 bytes with its delimiter
  };
  CHECK(frames.back().size() == 32);
  struct Counting {
    const std::array<std::pair<std::uint8_t, std::span<const std::uint8_t>>, 3>& said;
    std::size_t wrong = 0;
    void on_frame(const Frame& frame) {
      wrong += has_length_of_kind(frame) && std::none_of(said.begin(), said.end(), [&](const auto& one) {
                 return one.first == frame.kind && std::ranges::equal(one.second, frame.payload);
               });
    }
    void on_discard(Discard, std::uint8_t, std::size_t) {}
  };
  for (const Bytes& frame : frames) {
    const FrameKey session{.epoch = key.epoch, .always_long = &frame == &frames[5]};
    const Bytes before = frame_of(0xC0, {0, 6, 0, 0}, session);
    const Bytes after = frame_of(0xC1, {0, 9, 0, 0}, session);
    Bytes wire = joined({before, frame, after});
    const Heard whole = heard(wire, session);
    REQUIRE(whole.frames.size() == 3);
    const std::array<std::pair<std::uint8_t, std::span<const std::uint8_t>>, 3> said{
        {{whole.frames[0].first, whole.frames[0].second},
         {whole.frames[1].first, whole.frames[1].second},
         {whole.frames[2].first, whole.frames[2].second}}};
    Counting sink{said};
    FrameDecoder decoder;
    decoder.set_key(session);
    const std::size_t first = 8 * (before.size() - 1);
    const std::size_t last = 8 * (before.size() + frame.size());
    const auto flip = [&](std::size_t bit) {
      wire[bit / 8] = static_cast<std::uint8_t>(wire[bit / 8] ^ 1u << bit % 8);
    };
    const auto listen = [&] {
      decoder.feed(wire, sink);
      decoder.reset();
    };
    for (std::size_t a = first; a < last; ++a) {
      flip(a);
      listen();
      for (std::size_t b = a + 1; b < last; ++b) {
        flip(b);
        listen();
        for (std::size_t c = b + 1; c < last; ++c) {
          flip(c);
          listen();
          flip(c);
        }
        flip(b);
      }
      flip(a);
    }
    CHECK(sink.wrong == 0);
  }
}
