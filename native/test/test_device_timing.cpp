// SPDX-License-Identifier: BSD-3-Clause
// Compares the twin's timing with the table of cycles of the 2012 gateware (50 MHz, 8-bit addresses, 32-bit words).
#include "device_bench.hpp"

using namespace unitylink::device;
using unitylink::device::test::bench;
using unitylink::device::test::DeviceBench;

namespace {

struct Row {
  const char* request;
  Clock first_to_last;  // first request byte -> last reply byte
  Clock period;         // when the same request is repeated without a pause
};

constexpr Row table[] = {
    {"#R:12\n", 53, 28},           {"#W:2000000001\n", 59, 37}, {"#RM:0112\n", 61, 30},
    {"#RM:0410111213\n", 124, 78}, {"$R:12*58\n", 68, 34},      {"$W:2000000001*54\n", 74, 46},
};

}  // namespace

TEST_CASE("latency from the first byte in to the last byte out") {
  for (const Row& row : table) {
    CAPTURE(row.request);
    DeviceBench core;
    core.ask(row.request);
    CHECK(core.last_out == row.first_to_last);

    DeviceConfiguration configuration = bench();
    configuration.fifo_latency = 2;  // the library's FIFO on both sides
    DeviceBench stack(configuration);
    stack.ask(row.request);
    CHECK(stack.last_out == row.first_to_last + 4);
  }
}

TEST_CASE("steady-state period of requests back to back") {
  for (const Row& row : table) {
    CAPTURE(row.request);
    Clock last[2];
    for (int run = 0; run < 2; ++run) {
      DeviceBench device;
      for (int i = 0; i < 20 + run * 10; ++i) {
        device.put(row.request);
      }
      device.wait(20000);
      last[run] = device.last_out;
    }
    CHECK(last[1] - last[0] == 10 * row.period);
  }
}

TEST_CASE("a publish back to back takes 20 + 16 n clocks plain, 26 + 16 n checked") {
  DeviceConfiguration configuration = bench();
  configuration.base_hz = 50000000;  // more than the line can carry
  for (const std::uint32_t words : {1u, 4u, 8u, 15u}) {
    for (const bool checked : {false, true}) {
      DeviceBench device(configuration);
      std::string set = "#WSA:000" + std::string(1, "0123456789ABCDEF"[words]);
      for (std::uint32_t word = 0; word < words; ++word) {
        set += "10";
      }
      device.ask(set + "\n#WSR:000001\n");
      const std::string out = device.ask(checked ? "#EPC\n" : "#EPS\n", 100000);
      const auto messages = static_cast<double>(std::count(out.begin(), out.end(), '\n'));
      const double period = 100000.0 / messages;
      const double expected = (checked ? 26 : 20) + 16.0 * words;
      CHECK(period == doctest::Approx(expected).epsilon(0.01));
    }
  }
}

TEST_CASE("the first strobe comes with enabling, the next ones every clock_hz / base_hz") {
  DeviceConfiguration configuration = bench();
  configuration.base_hz = 100000;
  DeviceBench device(configuration);
  device.ask("#WSA:00021011\n#WSR:000003\n");
  device.ask("#EPS\n", 400);
  std::vector<Clock> heads;
  const Clock enabled = device.device.clock() - 400;
  for (int i = 0; i < 5000; ++i) {
    device.device.run_until(device.device.clock() + 1);
    const std::string out = device.taken();
    if (out.find('%') != std::string::npos) {
      heads.push_back(device.device.clock() - enabled);
    }
  }
  REQUIRE(heads.size() >= 3);
  CHECK(heads[0] / 500 == 2);  // rate 3: first after two periods, then after every three
  CHECK(heads[1] - heads[0] == 1500);
  CHECK(heads[2] - heads[1] == 1500);
}
