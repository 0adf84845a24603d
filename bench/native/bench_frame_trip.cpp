// SPDX-License-Identifier: BSD-3-Clause
// The shortest possible time of a framed request. It sends the same bytes as a link, but makes each frame before the
// clock starts. Then it blocks in read until the reply is complete.
//   bench_frame_trip --said HEX --descriptor N
// `--said` is all that a link has sent to its device, from HELLO to the request that is measured. This program sends
// the same to another device, in another session. Then it repeats the last request with the next ids. For each line
// "COUNT" on standard input it makes COUNT round trips, and prints their times in ns on one line.
#include <chrono>
#include <optional>
#include <vector>

#include "endpoint.hpp"
#include "layer1_stream/frame_decoder.hpp"
#include "layer1_stream/frame_encoder.hpp"
#include "round_trip.hpp"

namespace {

namespace protocol = unitylink::protocol;
using unitylink::bench::stop;

struct Said {
  std::uint8_t kind = 0;
  std::vector<std::uint8_t> payload;
};

// The frames in the bytes of one direction.
class Frames {
 public:
  explicit Frames(unitylink::FrameKey key = {}) { decoder_.set_key(key); }
  std::vector<Said> read(std::string_view bytes) {
    said_.clear();
    decoder_.feed({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, *this);
    return said_;
  }
  void on_frame(const unitylink::Frame& frame) {
    said_.push_back({frame.kind, {frame.payload.begin(), frame.payload.end()}});
    // its payload is nonce and epoch; the checks of the next frames need the epoch
    if (frame.kind == protocol::request_kind::open) {
      decoder_.set_key({.epoch = static_cast<std::uint16_t>(frame.payload[2] << 8 | frame.payload[3])});
    }
  }
  void on_discard(unitylink::Discard /*why*/, std::uint8_t kind, std::size_t bytes) {
    if (kind >= protocol::request_kind::hello) {  // not text of the classic protocol
      stop("a frame of " + std::to_string(bytes) + " bytes is damaged");
    }
  }

 private:
  unitylink::FrameDecoder decoder_;
  std::vector<Said> said_;
};

std::string framed(const Said& said, const unitylink::FrameKey& key, std::optional<std::uint16_t> id) {
  std::array<std::uint8_t, unitylink::frame_bytes_max + 1> room{};
  unitylink::FrameEncoder encoder(room, said.kind, key);
  if (id) {
    encoder.word(*id, 2);
  }
  const std::size_t size = encoder.bytes(std::span(said.payload).subspan(id ? 2 : 0)).finish();
  return {reinterpret_cast<const char*>(room.data()), size};
}

// A session on a descriptor. It sends one request after the other, and waits for each answer.
class Session {
 public:
  Session(int descriptor, const std::vector<Said>& said) : descriptor_(descriptor) {
    if (said.size() < 3 || said[0].kind != protocol::request_kind::hello ||
        said[1].kind != protocol::request_kind::open) {
      stop("--said is no HELLO, OPEN and requests");
    }
    const Said greeting = answered(std::string(1, protocol::frame::delimiter) + framed(said[0], {}, {}),
                                   protocol::device_kind::hello, Frames());
    Said open = said[1];
    key_.epoch = static_cast<std::uint16_t>(open.payload[2] << 8 | open.payload[3]);
    std::copy_n(greeting.payload.begin() + 1, 2, open.payload.begin());  // the nonce of this device
    answered(framed(open, {}, {}), protocol::device_kind::open, Frames());
    for (std::size_t index = 2; index + 1 < said.size(); ++index) {
      answered(framed(said[index], key_, next_++), protocol::device_kind::reply, Frames(key_));
    }
    last_ = said.back();
  }

  std::vector<long long> trips(std::size_t count) {
    std::vector<std::string> requests(count);
    for (auto& request : requests) {
      request = framed(last_, key_, next_++);
    }
    std::vector<long long> times(count);
    std::string_view answer;
    for (std::size_t index = 0; index < count; ++index) {
      const auto start = std::chrono::steady_clock::now();
      answer = unitylink::bench::round_trip(descriptor_, requests[index], reply_);
      times[index] = std::chrono::nanoseconds(std::chrono::steady_clock::now() - start).count();
      if (answer.size() != (reply_bytes_ == 0 ? answer.size() : reply_bytes_)) {
        stop("a reply has " + std::to_string(answer.size()) + " bytes, the one before had " +
             std::to_string(reply_bytes_));
      }
      reply_bytes_ = answer.size();
    }
    if (count > 0 && Frames(key_).read(answer).at(0).kind != protocol::device_kind::reply) {
      stop("the device refused the request");
    }
    return times;
  }

  // Prints the bytes of one round trip in each direction, to be compared with those of the link.
  void tell_bytes() {
    trips(1);
    std::printf("%zu %zu\n", framed(last_, key_, 0).size(), reply_bytes_);
    std::fflush(stdout);
  }

 private:
  Said answered(const std::string& request, std::uint8_t kind, Frames frames) {
    const auto said = frames.read(unitylink::bench::round_trip(descriptor_, request, reply_));
    if (said.size() != 1 || said[0].kind != kind) {
      stop("the device does not take what was said");
    }
    return said[0];
  }

  int descriptor_;
  unitylink::FrameKey key_;
  std::uint16_t next_ = 0;
  Said last_;
  std::size_t reply_bytes_ = 0;
  std::array<char, 8192> reply_{};
};

}  // namespace

int main(int count, char** values) {
  const std::span arguments(values, static_cast<std::size_t>(count));
  const std::string said = unitylink::bench::bytes_of(unitylink::bench::argument(arguments, "--said", ""));
  const std::string descriptor = unitylink::bench::argument(arguments, "--descriptor", "");
  if (said.empty() || descriptor.empty()) {
    stop("usage: bench_frame_trip --said HEX --descriptor N");
  }
  const int port = static_cast<int>(unitylink::bench::number("--descriptor", descriptor));
  if (isatty(port) != 0) {
    unitylink::bench::make_raw(port);
  }
  Session session(port, Frames().read(said));
  session.tell_bytes();
  unitylink::bench::answer_counts([&](std::size_t trips) { return session.trips(trips); });
  return 0;
}
