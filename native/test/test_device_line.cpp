// SPDX-License-Identifier: BSD-3-Clause
// The physical layer: with a line there are overruns, without one there are none. A host that does not read stops the
// device.
#include "device_bench.hpp"

using namespace unitylink::device;
using unitylink::device::test::bench;
using unitylink::device::test::DeviceBench;

namespace {

std::string repeated(std::string_view text, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) {
    all += text;
  }
  return all;
}

// A line on which replies need more time than requests.
DeviceConfiguration slow_line() {
  DeviceConfiguration configuration = bench();
  configuration.baud_hz = 3'125'000;  // about 3 Mbaud
  configuration.fifo = 16;
  return configuration;
}

}  // namespace

TEST_CASE("with a line every byte takes its time, both ways") {
  DeviceBench device(slow_line());
  CHECK(device.ask("#R:12\n") == "#S_R:40de1212\n");
  CHECK(device.last_out >= (6 + 14) * 160);
  CHECK(device.last_out <= (6 + 14) * 160 + 60);
}

TEST_CASE("a host that keeps to the credit loses nothing, one that does not loses requests and hears of it") {
  const std::string request = "#RM:081011121314151617\n";
  const std::string reply = DeviceBench().ask(request);
  {
    DeviceBench patient(slow_line());
    std::string all;
    for (int i = 0; i < 20; ++i) {
      all += patient.ask(request, 40000);
    }
    CHECK(all == repeated(reply, 20));
    CHECK(patient.device.statistics().overruns == 0);
  }
  DeviceBench hasty(slow_line());
  const std::string all = hasty.ask(repeated(request, 20), 800000);
  CHECK(hasty.device.statistics().overruns > 0);
  CHECK(all.find("?f9\n") != std::string::npos);
  CHECK(std::count(all.begin(), all.end(), 'S') < 20);
}

TEST_CASE("without a line the FIFO takes only what it has room for, and nothing is lost") {
  DeviceConfiguration configuration = bench();
  configuration.fifo = 16;
  DeviceBench device(configuration);
  const std::string requests = repeated("#R:12\n", 50);
  std::string all;
  std::size_t sent = 0;
  while (all.size() < 50 * 14 && device.device.clock() < 100000) {
    while (sent < requests.size() && device.device.receive(static_cast<std::uint8_t>(requests[sent]))) {
      ++sent;
    }
    device.device.run_until(device.device.clock() + 10);
    all += device.taken();
  }
  CHECK(all == repeated("#S_R:40de1212\n", 50));
}

TEST_CASE("a host that does not read stops the device, and nothing is lost once it reads") {
  DeviceConfiguration configuration = bench();
  configuration.fifo = 16;
  DeviceBench device(configuration);
  const std::string requests = repeated("#R:12\n", 10);
  std::size_t sent = 0;
  const auto offer = [&] {
    while (sent < requests.size() && device.device.receive(static_cast<std::uint8_t>(requests[sent]))) {
      ++sent;
    }
  };
  for (int i = 0; i < 500; ++i) {
    offer();
    device.device.run_until(device.device.clock() + 20);
  }
  CHECK(sent < requests.size());  // the device has stopped: all its buffers are full
  CHECK(device.device.next_event() == never);
  std::string all;
  for (int i = 0; i < 1000; ++i) {
    offer();
    all += device.taken();
    device.device.run_until(device.device.clock() + 20);
  }
  CHECK(all == repeated("#S_R:40de1212\n", 10));
}

TEST_CASE("a datalink error flushes the receive FIFO only where the physical layer honours it") {
  for (const bool honour : {false, true}) {
    DeviceConfiguration configuration = bench();
    configuration.honour_flush = honour;
    DeviceBench device(configuration);
    CHECK(device.ask("#R:12\n#R:zz\n#R:12\n") ==
          (honour ? "#S_R:40de1212\n?f3\n" : "#S_R:40de1212\n?f3\n#S_R:40de1212\n"));
  }
}
