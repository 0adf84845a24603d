// SPDX-License-Identifier: BSD-3-Clause
// Answers of the twin where the 2012 gateware was wrong, and for sizes that it could not have. tests/conformance
// replays the recordings.
#include "device_bench.hpp"

using namespace unitylink::device;
using unitylink::device::test::bench;
using unitylink::device::test::DeviceBench;

TEST_CASE("writes work at every data width") {
  for (std::uint32_t bits = 8; bits <= 32; ++bits) {
    DeviceConfiguration configuration = bench();
    configuration.data_bits = bits;
    DeviceBench device(configuration);
    const std::string digits = std::string("a5c3962f").substr(0, 2 * configuration.data_bytes());
    CHECK(device.ask("#W:20" + digits + "\n") == "#S_W\n");
    const auto value = static_cast<std::uint32_t>(std::stoul(digits, nullptr, 16)) & configuration.data_mask();
    char expected[16];
    std::snprintf(expected, sizeof expected, "%0*x", static_cast<int>(digits.size()), value);
    CHECK(device.ask("#R:20\n") == std::string("#S_R:") + expected + "\n");
  }
}

TEST_CASE("a bus timeout never touches address 0") {
  DeviceBench device;
  CHECK(device.ask("#W:F555AA55AA\n#R:F5\n#R:00\n") == "#?E_BAT\n#?E_BAT\n#S_R:40de0000\n");
}

TEST_CASE("a group of 255 words in a device of 256 groups, by read-back and publish") {
  DeviceConfiguration configuration = bench();
  configuration.bus_error_ranges.clear();
  configuration.silent_ranges.clear();
  configuration.groups = 256;
  configuration.group_size = 255;
  configuration.base_hz = 1000;
  DeviceBench device(configuration);
  std::string addresses;
  std::string words;
  for (unsigned i = 0; i < 255; ++i) {
    char text[16];
    std::snprintf(text, sizeof text, "%02x", i);
    addresses += text;
    std::snprintf(text, sizeof text, "40de%02x%02x", i, i);
    words += text;
  }
  CHECK(device.ask("#WSA:ffff" + addresses + "\n") == "#S_WSA\n");
  CHECK(device.ask("#WSR:ff0001\n") == "#S_WSR\n");
  CHECK(device.ask("#RSI:ff\n") == "#S_RSI:0001ff" + addresses + "\n");
  CHECK(device.ask("#EPS\n", 20000) == "#S_EPS\n%PUB:ffff" + words + "\n");
  CHECK(device.ask("#DPS\n", 200000) == "#S_DPS\n");
  // The event mask has a bit for every group: 32 bytes.
  const std::string mask = "80" + std::string(60, '0') + "01";
  CHECK(device.ask("#WIC:" + mask + "\n") == "#S_WIC\n");
  CHECK(device.ask("#RIC\n") == "#S_RIC:" + mask + "\n");
  CHECK(device.ask("#EPS\n").substr(0, 7) == "#S_EPS\n");
  device.ask("#WSR:ff0000\n");
  device.device.set_event(255, true);
  device.device.set_event(255, false);
  CHECK(device.wait(20000) == "%PUB:ffff" + words + "\n");
}

TEST_CASE("an empty group publishes nothing, neither by rate nor by event") {
  DeviceConfiguration configuration = bench();
  configuration.base_hz = 100000;
  DeviceBench device(configuration);
  device.ask("#WSR:000001\n#WIC:0001\n#EPS\n");
  device.device.set_events(1);
  CHECK(device.wait(50000).empty());
}

TEST_CASE("a silent address ends the publish, is tried at the next rate, and requests are served between") {
  DeviceConfiguration configuration = bench();
  configuration.base_hz = 100000;
  DeviceBench device(configuration);
  device.ask("#WSA:000310F512\n#WSR:000002\n#EPS\n", 1000);
  const std::string out = device.wait(10000);
  CHECK(std::count(out.begin(), out.end(), '\n') == 10);
  CHECK(out.substr(0, 25) == "%PUB:000340de1010?E_BAT\n%");
  const std::string answer = device.ask("#DPS\n", 1000);
  CHECK(answer.find("#S_DPS\n") != std::string::npos);
  CHECK(device.wait(20000).empty());
}

TEST_CASE("a refused WSA leaves the group as it was") {
  DeviceBench device;
  CHECK(device.ask("#WSA:01021011\n") == "#S_WSA\n");
  for (const char* bad : {"#WSA:010301\n", "#WSA:0111\n", "#WSA:0100\n", "#WSA:01\n"}) {
    CHECK(device.ask(bad).find("?E_") != std::string::npos);
    CHECK(device.ask("#RSI:01\n") == "#S_RSI:0000021011\n");
  }
}

TEST_CASE("a checked request needs its star and exactly one checksum byte") {
  DeviceBench device;
  CHECK(device.ask("$R:12*58\n") == "$S_R:40de1212*2d\n");
  for (const char* bad : {"$R:1258\n", "$R:12*5800\n", "$\n", "$R:12\n", "$R:12*\n", "$R:12*59\n"}) {
    CHECK(device.ask(bad) == "?f4\n");
  }
  CHECK(device.ask("$*\n") == "$?E_ICC\n");
}

TEST_CASE("configurations that cannot be are refused by name") {
  DeviceConfiguration configuration;
  configuration.data_bits = 33;
  CHECK(configuration.problem() == "data_bits is 33; choose 8 to 32");
  configuration = {};
  configuration.tosnet.present = true;
  CHECK(configuration.problem().find("does not fit 8 address bits") != std::string::npos);
  configuration.address_bits = 16;
  CHECK(configuration.problem().empty());
  configuration.fifos = {{0x7FE, 4}};
  CHECK(configuration.problem().find("overlap") != std::string::npos);
}
