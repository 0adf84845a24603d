// SPDX-License-Identifier: BSD-3-Clause
// Hostile frames to the frame decoder, the engine and the twin:  fuzz_frames --seconds N --seed S
// It checks these promises. Chunks give the same events as the whole input. Every request ends, whatever the answers
// are. The device continues to work, and sends a limited number of bytes for each byte that it receives.
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "device/device.hpp"
#include "fuzzing.hpp"
#include "layer1_stream/frame_decoder.hpp"
#include "layer1_stream/frame_encoder.hpp"
#include "layer2_message/framed_engine.hpp"

using namespace unitylink;

namespace {

constexpr const char* program = "fuzz_frames";

using Bytes = std::vector<std::uint8_t>;

// Combines all that the decoder reports into one number.
struct Digest {
  std::uint64_t value = 1469598103934665603u;
  std::uint64_t frames = 0;
  void add(std::uint64_t more) noexcept { value = (value ^ more) * 1099511628211u; }
  void on_frame(const Frame& frame) noexcept {
    ++frames;
    add(frame.kind);
    for (const std::uint8_t byte : frame.payload) {
      add(byte);
    }
  }
  void on_discard(Discard why, std::uint8_t kind, std::size_t bytes) noexcept {
    add(static_cast<std::uint64_t>(why));
    add(kind);
    add(bytes);
  }
};

class Fuzz {
 public:
  explicit Fuzz(std::uint64_t seed) : random_(seed), seed_(seed) {}

  void round() {
    ++rounds;
    const auto epoch = static_cast<std::uint16_t>(random_() % 0xFF00);
    drive_decoder(epoch);
    drive_engine();
    drive_device();
  }

  std::uint64_t rounds = 0, strings = 0, bytes = 0, understood = 0;

 private:
  // A frame with a right check. Its payload may have the form of its kind, or not.
  Bytes frame(bool from_device, std::uint16_t epoch) {
    static constexpr std::uint8_t outside[] = {0x80, 0x81, 0xD0, 0xD1, 0xD3};
    std::uint8_t kind =
        static_cast<std::uint8_t>((from_device ? 0xC0 : 0x80) + random_() % (random_() % 4 == 0 ? 64 : 20));
    if (random_() % 8 == 0) {
      kind = outside[random_() % std::size(outside)];
    }
    Bytes room(1400);
    const bool open = kind == 0x80 || kind == 0x81 || kind == 0xD0 || kind == 0xD1 || kind == 0xD3;
    FrameEncoder encoder(room, kind, open ? FrameKey{} : FrameKey{.epoch = epoch, .always_long = false});
    const std::size_t size = random_() % (random_() % 16 == 0 ? 1000 : random_() % 4 == 0 ? 64 : 14);
    for (std::size_t index = 0; index < size; ++index) {
      encoder.byte(static_cast<std::uint8_t>(random_() % 3 == 0 ? random_() : random_() % 24));
    }
    room.resize(encoder.finish());
    return room;
  }

  Bytes traffic(bool from_device, std::uint16_t epoch) {
    Bytes text;
    for (auto count = random_() % 12; count > 0; --count) {
      if (random_() % 5 == 0) {
        for (auto size = random_() % (random_() % 20 == 0 ? 3000 : 40); size > 0; --size) {
          text.push_back(static_cast<std::uint8_t>(random_() % 6 == 0 ? 0 : random_()));
        }
      } else {
        const Bytes one = frame(from_device, epoch);
        text.insert(text.end(), one.begin(), one.end());
      }
      if (!text.empty() && random_() % 3 == 0) {
        const auto at = static_cast<std::ptrdiff_t>(random_() % text.size());
        switch (random_() % 3) {
          case 0: text[static_cast<std::size_t>(at)] ^= static_cast<std::uint8_t>(1 << random_() % 8); break;
          case 1: text.erase(text.begin() + at); break;
          default: text.insert(text.begin() + at, text[static_cast<std::size_t>(at)]); break;
        }
      }
    }
    ++strings;
    bytes += text.size();
    return text;
  }

  std::span<const std::uint8_t> piece(const Bytes& text, std::size_t at, std::size_t most) {
    return std::span(text).subspan(at, std::min<std::size_t>(text.size() - at, 1 + random_() % most));
  }

  void drive_decoder(std::uint16_t epoch) {
    const Bytes text = traffic(random_() % 2 == 0, epoch);
    const FrameKey key{.epoch = epoch, .always_long = random_() % 8 == 0};
    const std::size_t most = random_() % 4 == 0 ? 250 : frame_payload_max;
    FrameDecoder whole, pieced;
    Digest expected, got;
    for (FrameDecoder* decoder : {&whole, &pieced}) {
      decoder->set_key(key);
      decoder->set_payload_max(most);
    }
    whole.feed(text, expected);
    for (std::size_t at = 0; at < text.size();) {
      const auto chunk = piece(text, at, random_() % 2 == 0 ? 1 : 300);
      pieced.feed(chunk, got);
      at += chunk.size();
    }
    understood += expected.frames;
    if (expected.value != got.value || whole.pending() != pieced.pending()) {
      fuzzing::fail(program, "one chunk and many chunks differ", seed_, rounds, text);
    }
  }

  // Requests to a device that opens a session and then sends anything, with right or wrong checks. All must end.
  void drive_engine() {
    // where the last request was
    auto* const engine =
        &engine_.emplace(EngineSettings{.window = 8, .timeout_ns = 1'000'000, .seed = random_()}, random_() % 2 == 0);
    std::uint32_t read[4]{};
    const std::uint32_t addresses[2]{0x10, 0x11};
    const ListWord steps[2]{{protocol::list_operation::add, 1, 2, 3}, {protocol::list_operation::read, 1, 0, 0}};
    const ExchangeWord words[2]{{0x10, 2}, {0x11, 1}};
    Exchange exchanges[8];
    for (Exchange& exchange : exchanges) {
      exchange.attempts_max = 2;
    }
    exchanges[1].operation = Operation::write;
    exchanges[2].operation = Operation::read_many;
    exchanges[2].addresses = addresses;
    exchanges[2].values = std::span(read).first(2);
    exchanges[3].operation = Operation::list;
    exchanges[3].steps = steps;
    exchanges[3].values = std::span(read).subspan(2, 1);
    exchanges[4].operation = Operation::define_exchange;
    exchanges[5].operation = Operation::exchange;
    for (Exchange* exchange : {&exchanges[4], &exchanges[5]}) {
      exchange->outputs = std::span(words).first(1);
      exchange->inputs = words;
    }
    exchanges[5].write_values = std::span(addresses).first(1);
    exchanges[5].values = std::span(read).first(2);
    exchanges[6].operation = Operation::synchronise;
    exchanges[7].operation = Operation::read_control;
    exchanges[7].values = read;
    std::uint64_t now = 1;
    for (Exchange& exchange : exchanges) {
      engine->submit(exchange, now);
    }
    const Post post[2]{{1, 2}, {3, 4}};
    static_cast<void>(engine->post(post, now));
    Bytes text = greeting();
    std::size_t at = 0;
    bool opened = false;
    for (int step = 0;; ++step) {
      engine->advance(now);
      const auto out = engine->transmit(now);
      if (!opened && at == text.size() && engine->sessions() == 0 && offered(out)) {
        opened = true;
        const Bytes answer = opening();
        text.insert(text.end(), answer.begin(), answer.end());
        const Bytes more = traffic(true, epoch_);
        text.insert(text.end(), more.begin(), more.end());
      }
      engine->sent(out.size());
      bool over = true;
      for (const Exchange& exchange : exchanges) {
        over = over && exchange.done();
      }
      if (over && at == text.size()) {
        break;
      }
      if (step > 20'000) {
        fuzzing::fail(program, "a request did not end", seed_, rounds, text);
      }
      if (at < text.size()) {
        const auto chunk = piece(text, at, 64);
        engine->receive(chunk, now);
        at += chunk.size();
      } else {
        const std::uint64_t due = engine->next_deadline_ns();
        if (due == Engine::no_deadline) {
          fuzzing::fail(program, "a request waits for nothing", seed_, rounds, text);
        }
        now = std::max(now + 1, due);
      }
    }
    engine->end(Status::closed, now);
  }

  Bytes greeting() {
    Bytes room(64);
    FrameEncoder encoder(room, protocol::device_kind::hello, {});
    encoder.word(1, 1)
        .word(7, 2)
        .word(0xFFFF, 2)
        .word(1, 1)
        .word(4, 1)
        .word(512, 2)
        .word(250, 2)
        .word(250, 2)
        .word(8, 1)
        .word(16, 1);
    encoder.word(0x3F, 2).word(0, 4).word(0, 4);
    room.resize(encoder.finish());
    return room;
  }

  // Takes the epoch of an OPEN among the bytes that are sent.
  bool offered(std::span<const std::uint8_t> out) {
    struct Finder {
      std::uint16_t* epoch;
      bool found = false;
      void on_frame(const Frame& frame) noexcept {
        if (frame.kind == protocol::request_kind::open && frame.payload.size() == 5) {
          *epoch = static_cast<std::uint16_t>(frame.payload[2] << 8 | frame.payload[3]);
          found = true;
        }
      }
      void on_discard(Discard, std::uint8_t, std::size_t) noexcept {}
    } finder{&epoch_};
    FrameDecoder decoder;
    decoder.feed(out, finder);
    return finder.found;
  }

  Bytes opening() {
    Bytes room(32);
    FrameEncoder encoder(room, protocol::device_kind::open, {});
    encoder.word(epoch_, 2).word(0, 4);
    room.resize(encoder.finish());
    return room;
  }

  // A device in a session gets any bytes. Afterwards it must answer a question. For each byte that it gets, it may send
  // at most what its buffers hold. The device is used for several rounds, because making one takes longer than a round.
  // So its state after one round is the beginning of the next.
  void drive_device() {
    if (device_ == nullptr || random_() % 200 == 0) {
      device_ = std::make_unique<device::Device>(device::DeviceConfiguration{});
    }
    const Bytes hello{0x00, 0x80, 0x03, 0x01, 0x01, 0xFA, 0x92, 0x83, 0x00};
    epoch_ = static_cast<std::uint16_t>(random_() % 0xFF00);
    tell(open_with(nonce_of(tell(hello))));
    const Bytes text = traffic(false, epoch_);
    if (tell(text).size() > (text.size() + 64) * 1024) {
      fuzzing::fail(program, "a device that talks without end", seed_, rounds, text);
    }
    tell({0x00, 0x00});
    if (!nonce_of(tell(hello))) {
      fuzzing::fail(program, "a device that answers no more", seed_, rounds, text);
    }
  }

  Bytes open_with(std::optional<std::uint16_t> nonce) const {
    Bytes open(64);
    open[0] = 0;
    FrameEncoder encoder(std::span<std::uint8_t>(open).subspan(1), protocol::request_kind::open, {});
    open.resize(1 + encoder.word(nonce.value_or(0), 2).word(epoch_, 2).word(0, 1).finish());
    return open;
  }

  // The nonce in the answer to HELLO, if the device has sent one.
  static std::optional<std::uint16_t> nonce_of(const Bytes& said) {
    struct Finder {
      std::optional<std::uint16_t> nonce;
      void on_frame(const Frame& frame) noexcept {
        if (frame.kind == protocol::device_kind::hello && frame.payload.size() > 3) {
          nonce = static_cast<std::uint16_t>(frame.payload[1] << 8 | frame.payload[2]);
        }
      }
      void on_discard(Discard, std::uint8_t, std::size_t) noexcept {}
    } finder;
    FrameDecoder decoder;
    decoder.feed(said, finder);
    return finder.nonce;
  }

  Bytes tell(const Bytes& text) {
    Bytes said;
    device::TimedByte byte;
    for (const std::uint8_t one : text) {
      static_cast<void>(device_->receive(one));
      device_->run_until(device_->clock() + 1 + random_() % 50);
      while (device_->take(byte)) {
        said.push_back(byte.byte);
      }
    }
    device_->run_until(device_->clock() + 100'000);
    while (device_->take(byte)) {
      said.push_back(byte.byte);
    }
    return said;
  }

  std::unique_ptr<device::Device> device_;
  std::optional<FramedEngine> engine_;
  std::mt19937_64 random_;
  std::uint64_t seed_;
  std::uint16_t epoch_ = 0;
};

}  // namespace

int main(int count, char** arguments) { return fuzzing::run<Fuzz>(program, "whole frames", count, arguments); }
