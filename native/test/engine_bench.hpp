// SPDX-License-Identifier: BSD-3-Clause
// An engine on a virtual clock. The test makes its requests, and gives it the device's answers.
#pragma once

#include <doctest/doctest.h>

#include <memory>
#include <string>

#include "decoder_trace.hpp"
#include "layer2_message/classic_engine.hpp"
#include "times.hpp"

namespace unitylink::test {

struct EngineBench {
  explicit EngineBench(std::uint32_t fifo = 16, std::uint32_t window = 64) {
    EngineSettings settings;
    settings.receive_fifo_bytes = settings.transmit_fifo_bytes = fifo;
    settings.window = window;
    engine = std::make_unique<ClassicEngine>(settings);
  }

  // Runs the engine until the device has answered its first fence.
  void begin() {
    Exchange first;
    first.operation = Operation::resynchronise;
    submit(first);
    CHECK(sent() == "!$RLC*9B\n");
    answer("$CNF:01,04,20,02,03e8,02,10,02*a7\n");
    REQUIRE(first.done());
    REQUIRE(first.status == Status::ok);
    REQUIRE(engine->reported());
    engine->configure(*engine->reported());
  }

  void submit(Exchange& exchange) { engine->submit(exchange, now); }
  std::string sent() {
    const auto bytes = engine->transmit(now);
    std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    engine->sent(bytes.size());
    return text;
  }
  void answer(std::string_view text) { engine->receive(bytes_of(text), now); }
  void wait(std::uint64_t ns) {
    now += ns;
    engine->advance(now);
  }

  std::uint64_t now = 1000 * ms;
  std::unique_ptr<ClassicEngine> engine;
};

inline Exchange reading(std::uint32_t address, bool checked = false, bool repeat = true) {
  Exchange exchange;
  exchange.address = address;
  exchange.checked = checked;
  exchange.repeat = repeat;
  exchange.attempts_max = 3;
  return exchange;
}

inline Exchange writing(std::uint32_t address, std::uint32_t value, bool repeat = false) {
  Exchange exchange = reading(address, false, repeat);
  exchange.operation = Operation::write;
  exchange.value = value;
  return exchange;
}

inline constexpr const char* cnf = "$CNF:01,04,20,02,03e8,02,10,02*a7\n";

}  // namespace unitylink::test
