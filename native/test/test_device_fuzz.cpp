// SPDX-License-Identifier: BSD-3-Clause
// Random bytes to the twin. It must not crash or hang, must give the same answers in one chunk and byte by byte, and
// must answer #R afterwards.
#include <random>
#include <vector>

#include "device_bench.hpp"

using namespace unitylink::device;
using unitylink::device::test::bench;
using unitylink::device::test::DeviceBench;

namespace {

std::string noise(std::mt19937& random, std::size_t size) {
  static constexpr std::string_view likely = "##$$%&:*\n\r 0123456789abcdefABCDEFRWMSILCPDrwmsil,.?!";
  std::string text;
  while (text.size() < size) {
    if (random() % 8 == 0) {
      static constexpr std::string_view whole[] = {"#R:12\n",         "$R:12*58\n",   "#RM:021011\n", "#W:20DEADBEEF\n",
                                                   "#WSA:00021112\n", "#RLC\n",       "#R:F5\n",      "#RSI:00\n",
                                                   "#WIC:0001\n",     "#WSR:000001\n"};
      text += whole[random() % std::size(whole)];
    } else {
      text.push_back(random() % 16 == 0 ? static_cast<char>(random()) : likely[random() % likely.size()]);
    }
  }
  return text;
}

// Replies keep their order, and so do datalink errors. The order between the two kinds depends on timing.
struct Sorted {
  std::string replies;
  std::string errors;
  bool operator==(const Sorted&) const = default;
};

Sorted sorted(const std::string& output) {
  Sorted result;
  std::size_t start = 0;
  while (start < output.size()) {
    const std::size_t end = std::min(output.find('\n', start), output.size() - 1) + 1;
    (output[start] == '?' ? result.errors : result.replies) += output.substr(start, end - start);
    start = end;
  }
  return result;
}

}  // namespace

TEST_CASE("random bytes: one chunk and byte by byte agree, and the device lives on") {
  DeviceConfiguration configuration = bench();
  configuration.protocol = Protocol::classic;  // inside a frame without an end nothing would be answered
  configuration.publish_mode = 0;              // no publishes, because they depend on timing
  std::mt19937 random(20120601);
  for (int round = 0; round < 300; ++round) {
    CAPTURE(round);
    const std::string bytes = noise(random, 1 + random() % 400);
    DeviceBench whole(configuration);
    const std::string once = whole.ask(bytes, 200000);
    DeviceBench pieces(configuration);
    std::string piecewise;
    for (const char c : bytes) {
      piecewise += pieces.ask(std::string_view(&c, 1), random() % 4 == 0 ? 300 : 1);
    }
    piecewise += pieces.wait(200000);
    CHECK(sorted(once) == sorted(piecewise));
    CHECK(once.size() == piecewise.size());
    whole.ask("\n");
    CHECK(whole.ask("#R:13\n") == "#S_R:40de1313\n");
  }
}

TEST_CASE("random bytes while publishing, with events, errors and FIFOs of 4 bytes: it still answers") {
  std::mt19937 random(4711);
  for (int round = 0; round < 60; ++round) {
    CAPTURE(round);
    DeviceConfiguration configuration = bench();
    configuration.protocol = Protocol::classic;
    configuration.base_hz = 10000;  // low enough for the line, because publishes have priority over requests
    configuration.baud_hz = round % 2 == 0 ? 0 : 12'500'000;
    configuration.fifo = round % 3 == 0 ? 4 : 0;
    configuration.honour_flush = round % 5 == 0;
    DeviceBench device(configuration);
    const std::string bytes = "#WSA:00021112\n#WSR:000002\n#EPC\n" + noise(random, 600);
    std::size_t sent = 0;
    while (sent < bytes.size()) {
      if (device.device.receive(static_cast<std::uint8_t>(bytes[sent]))) {
        ++sent;
      }
      device.device.set_events(static_cast<std::uint32_t>(random()));
      if (random() % 50 == 0) {
        device.device.receive_error(static_cast<std::uint8_t>(random()));
      }
      device.wait(random() % 64);
    }
    device.device.set_events(0);
    device.wait(1500000);  // until a large transmit FIFO is empty
    std::string answer;
    for (const char c : std::string("!\n#DPS\n")) {  // byte by byte, so that a FIFO of 4 bytes does not overrun
      answer += device.ask(std::string_view(&c, 1), 2000);
    }
    answer.clear();
    device.wait(50000);
    for (const char c : std::string("#R:13\n")) {
      answer += device.ask(std::string_view(&c, 1), 2000);
    }
    CHECK(answer == "#S_R:40de1313\n");
  }
}
