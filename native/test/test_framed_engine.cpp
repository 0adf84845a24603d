// SPDX-License-Identifier: BSD-3-Clause
// FramedEngine and the twin. The test is the wire between them: it carries, delays, doubles or drops each frame.
#include <doctest/doctest.h>

#include <array>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "device/device.hpp"
#include "engine_bench.hpp"
#include "layer1_stream/frame_encoder.hpp"
#include "layer2_message/framed_engine.hpp"

using namespace unitylink;
using unitylink::test::ms;
using unitylink::test::reading;
using unitylink::test::writing;

namespace {

using Sent = std::vector<std::uint8_t>;  // a frame with its border

struct Wire {
  Wire() {
    engine.configure({.address_bytes = 2, .data_bytes = 4});
    reset();
  }

  void reset() {
    device::DeviceConfiguration configuration;
    configuration.address_bits = 16;
    device = std::make_unique<device::Device>(configuration);
    device->bus().observe([this](std::uint32_t, std::uint32_t value) { written.push_back(value); });
  }

  // The frames that the engine sends now.
  std::vector<Sent> sent() {
    std::vector<Sent> frames;
    for (auto bytes = engine.transmit(now); !bytes.empty(); bytes = engine.transmit(now)) {
      for (const std::uint8_t byte : bytes) {
        open.push_back(byte);
        if (byte == 0 && open.size() > 1) {
          frames.push_back(std::exchange(open, {}));
        } else if (byte == 0) {
          open.clear();
        }
      }
      engine.sent(bytes.size());
    }
    return frames;
  }
  // Gives a frame to the device, and returns its answer.
  Sent carry(const Sent& frame) {
    static_cast<void>(device->receive(0));  // ends an incomplete frame, if there is one
    for (const std::uint8_t byte : frame) {
      static_cast<void>(device->receive(byte));
    }
    device->run_until(device->clock() + 10'000);
    Sent answer;
    device::TimedByte timed;
    while (device->take(timed)) {
      answer.push_back(timed.byte);
    }
    return answer;
  }
  void answer(const Sent& frame) { engine.receive(frame, now); }
  // Carries all frames both ways until the engine sends no more.
  void settle() {
    for (auto frames = sent(); !frames.empty(); frames = sent()) {
      for (const Sent& frame : frames) {
        answer(carry(frame));
      }
    }
  }
  void wait(std::uint64_t ns) {
    now += ns;
    engine.advance(now);
  }
  void submit(Exchange& exchange) { engine.submit(exchange, now); }
  // An answer that did not come from the device.
  Sent forged(std::uint32_t status, std::uint32_t id) const {
    Sent frame(32);
    frame.resize(
        FrameEncoder(frame, static_cast<std::uint8_t>(protocol::device_kind::reply + status), {.epoch = engine.epoch()})
            .word(id, 2)
            .word(0, 2)
            .finish());
    return frame;
  }

  std::uint64_t now = 1000 * ms;
  FramedEngine engine{EngineSettings{}, false};
  std::unique_ptr<device::Device> device;
  std::vector<std::uint32_t> written;
  Sent open;
};

struct Chain {
  explicit Chain(Wire& wire) {
    for (Exchange* exchange : {&first, &second}) {
      exchange->batch = &batch;
      exchange->attempts_max = 1;
      exchange->timeout_ns = 20 * ms;
    }
    second.chained = true;
    second.attempts_max = 10;
    wire.submit(first);
    wire.submit(second);
  }
  Batch batch;
  Exchange first = writing(0x10, 1);
  Exchange second = writing(0x11, 2);
};

}  // namespace

TEST_CASE("sessions behind each other have epochs of their own") {
  Wire wire;
  std::set<std::uint16_t> epochs;
  constexpr std::size_t sessions = 2000;
  for (std::size_t session = 0; session < sessions; ++session) {
    Exchange exchange = reading(1);
    wire.submit(exchange);
    wire.settle();
    REQUIRE(exchange.done());
    REQUIRE(exchange.status == Status::ok);
    epochs.insert(wire.engine.epoch());
    wire.reset();
  }
  CHECK(epochs.size() == sessions);
}

TEST_CASE("an error counts when it has come twice") {
  Wire wire;
  Exchange opening = reading(1);
  wire.submit(opening);
  wire.settle();
  Exchange write = writing(0x10, 7);
  wire.submit(write);
  const Sent request = wire.sent().at(0);
  const std::uint32_t id = 1;
  wire.answer(wire.forged(protocol::reply_status::invalid, id));
  wire.answer(wire.forged(protocol::reply_status::invalid, id));  // a copy of it, before the request was repeated
  CHECK(!write.done());
  CHECK((wire.sent() == std::vector<Sent>{request}));
  SUBCASE("a false one is not believed") {
    wire.answer(wire.carry(request));
    REQUIRE(write.done());
    CHECK(write.status == Status::ok);
    CHECK(write.error.empty());
    CHECK((wire.written == std::vector<std::uint32_t>{7}));
  }
  SUBCASE("of a write that was not executed a SYNC takes the id over first") {
    wire.answer(wire.forged(protocol::reply_status::invalid, id));
    CHECK(!write.done());
    wire.settle();
    CHECK(write.status == Status::protocol_error);
    CHECK(write.error == "invalid");
    static_cast<void>(wire.carry(request));  // late
    CHECK(wire.written.empty());
  }
  SUBCASE("a write whose copy was executed meanwhile is told as done") {
    wire.answer(wire.forged(protocol::reply_status::invalid, id));
    static_cast<void>(wire.carry(request));
    wire.settle();
    CHECK(write.status == Status::ok);
    CHECK((wire.written == std::vector<std::uint32_t>{7}));
  }
}

TEST_CASE("what is chained behind a failed request is told as not sent when it can no more be executed") {
  Wire wire;
  Exchange opening = reading(1);
  wire.submit(opening);
  wire.settle();
  Chain chain(wire);
  const auto frames = wire.sent();
  REQUIRE(frames.size() == 2);
  const Sent refusal = wire.carry(frames[1]);  // the first is lost
  for (int turn = 0; turn < 100 && !chain.first.done(); ++turn) {
    wire.wait(10 * ms);
    for (const Sent& frame : wire.sent()) {  // lost too, except for the question whether the session still exists
      if (frame[0] == protocol::request_kind::hello) {
        wire.answer(wire.carry(frame));
      }
    }
  }
  REQUIRE(chain.first.status == Status::unknown);
  wire.answer(refusal);
  CHECK(!chain.second.done());
  const auto last = wire.sent();  // the SYNCs that take their ids over
  REQUIRE(!last.empty());
  std::vector<Sent> answers;
  SUBCASE("it was not executed") {
    for (int turn = 0; turn < 100 && !chain.second.done(); ++turn) {
      wire.wait(10 * ms);
      wire.settle();
    }
    CHECK(chain.second.status == Status::cancelled);
    static_cast<void>(wire.carry(frames[0]));
    static_cast<void>(wire.carry(frames[1]));
    CHECK(wire.written.empty());
  }
  SUBCASE("a late copy was, once a SYNC stood in the first one's place") {
    for (const Sent& frame : last) {
      answers.push_back(wire.carry(frame));
      static_cast<void>(wire.carry(frames[1]));
    }
    for (const Sent& answer : answers) {
      wire.answer(answer);
    }
    CHECK((wire.written == std::vector<std::uint32_t>{2}));
    CHECK(chain.second.status == Status::ok);
  }
}

TEST_CASE("a request whose long answer was lost is given up, and the session goes on") {
  Wire wire;
  Exchange opening = reading(1);
  wire.submit(opening);
  wire.settle();
  const std::array<std::uint32_t, 10> addresses{1, 3, 5, 7, 9, 11, 13, 15, 17, 19};
  std::array<std::uint32_t, 10> words{};
  Exchange list = reading(0);
  list.operation = Operation::read_many;
  list.addresses = addresses;
  list.values = words;
  list.attempts_max = 1;
  list.timeout_ns = 20 * ms;
  wire.submit(list);
  for (int turn = 0; turn < 100 && !list.done(); ++turn) {
    for (const Sent& frame : wire.sent()) {
      const Sent answer = wire.carry(frame);
      if (frame[0] == protocol::request_kind::hello) {
        wire.answer(answer);
      }
    }
    wire.wait(10 * ms);
  }
  REQUIRE(list.status == Status::timeout);
  Exchange next = reading(1);
  next.operation = Operation::write;
  wire.submit(next);
  for (int turn = 0; turn < 100 && !next.done(); ++turn) {
    wire.settle();
    wire.wait(10 * ms);
  }
  CHECK(next.status == Status::ok);
}

TEST_CASE("no copy of a write is sent from the moment on at which it expires") {
  Wire wire;
  Exchange opening = reading(1);
  wire.submit(opening);
  wire.settle();
  Exchange write = writing(0x10, 7);
  write.attempts_max = 10;
  write.expires_ns = wire.now + 20 * ms;
  wire.submit(write);
  std::vector<std::uint32_t> executed;
  Status status = Status::unknown;

  SUBCASE("it is sent in time") {
    wire.now += 20 * ms - 1;
    wire.settle();
    status = Status::ok;
    executed = {7};
  }
  SUBCASE("it was not sent before") {
    wire.now += 20 * ms;  // its thread was held up, and sends before it looks for what is late
    wire.settle();
    status = Status::timeout;
    CHECK(!write.sent);
  }
  SUBCASE("its first copy was lost, and the line takes no other one until later") {
    REQUIRE(wire.sent().size() == 1);
    wire.wait(15 * ms);
    wire.now += 5 * ms;
    wire.settle();
  }
  SUBCASE("two copies were lost") {
    REQUIRE(wire.sent().size() == 1);
    wire.wait(15 * ms);
    REQUIRE(wire.sent().size() == 1);
    wire.wait(5 * ms);
    wire.settle();
  }
  REQUIRE(write.done());
  CHECK(write.status == status);
  CHECK(wire.written == executed);
  Exchange next = writing(0x10, 8);
  wire.submit(next);
  wire.settle();
  executed.push_back(8);
  CHECK(next.status == Status::ok);
  CHECK(wire.written == executed);
}
