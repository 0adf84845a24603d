// SPDX-License-Identifier: BSD-3-Clause
// A device, and calls that give it bytes and time. For the tests of the twin.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "device/device.hpp"

namespace unitylink::device::test {

inline DeviceConfiguration bench() {
  DeviceConfiguration configuration;
  configuration.bench_memory = true;
  configuration.bus_error_ranges = {{0xE0, 0xEF}};
  configuration.silent_ranges = {{0xF0, 0xFF}};
  return configuration;
}

struct DeviceBench {
  Device device;
  Clock first_out = never;
  Clock last_out = 0;

  explicit DeviceBench(const DeviceConfiguration& configuration = bench()) : device(configuration) {
    REQUIRE_MESSAGE(configuration.problem().empty(), configuration.problem());
  }

  std::string taken() {
    std::string bytes;
    TimedByte byte;
    while (device.take(byte)) {
      first_out = std::min(first_out, byte.at);
      last_out = byte.at;
      bytes.push_back(static_cast<char>(byte.byte));
    }
    return bytes;
  }

  void put(std::string_view request) {
    for (const char c : request) {
      REQUIRE(device.receive(static_cast<std::uint8_t>(c)));
    }
  }

  // Sends a request, and returns all bytes that arrive within `clocks`.
  std::string ask(std::string_view request, Clock clocks = 20000) {
    put(request);
    return wait(clocks);
  }

  std::string wait(Clock clocks) {
    first_out = never;
    std::string bytes;
    const Clock until = device.clock() + clocks;
    const Clock piece = device.configuration().fifo > 0 ? 8 : 1000;  // so that no output FIFO stays full
    while (device.clock() < until) {
      device.run_until(std::min(until, device.clock() + piece));
      bytes += taken();
    }
    return bytes;
  }
};

}  // namespace unitylink::device::test
