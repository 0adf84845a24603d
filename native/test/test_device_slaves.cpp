// SPDX-License-Identifier: BSD-3-Clause
// The bus slaves: TosNet with its two hazards, the FIFO, the double buffer.
#include "device/memory.hpp"
#include "device_bench.hpp"

using namespace unitylink::device;
using unitylink::device::test::bench;
using unitylink::device::test::DeviceBench;

namespace {

constexpr Clock cycle = 5000;

DeviceConfiguration network() {
  DeviceConfiguration configuration;
  configuration.address_bits = 11;
  configuration.tosnet.present = true;
  configuration.tosnet.cycle_clocks = cycle;
  configuration.tosnet.nodes = {{2, 0x07}, {5, 0xFF}};
  return configuration;
}

struct Network : DeviceBench {
  Network() : DeviceBench(network()) {}

  void write(std::uint32_t address, std::uint32_t value) {
    char text[32];
    std::snprintf(text, sizeof text, "#W:%04x%08x\n", address, value);
    REQUIRE(ask(text, 200) == "#S_W\n");
  }
  std::uint32_t read(std::uint32_t address) {
    char text[16];
    std::snprintf(text, sizeof text, "#R:%04x\n", address);
    const std::string reply = ask(text, 200);
    REQUIRE(reply.substr(0, 5) == "#S_R:");
    return static_cast<std::uint32_t>(std::stoul(reply.substr(5), nullptr, 16));
  }
  void commit() { write(0x400, 0); }
  void next_cycle() { wait(cycle - device.clock() % cycle + 1); }
  std::uint32_t node(std::uint32_t address) { return device.bus().get(address, device.clock()).value; }
};

}  // namespace

TEST_CASE("TosNet: what the PC writes reaches the nodes at the strobe after a commit, all at once") {
  Network net;
  net.next_cycle();
  net.write(0x8C, 100);
  net.write(0x94, 200);
  net.next_cycle();
  CHECK(net.node(0x8C) == 0);  // not committed
  net.commit();
  CHECK((net.read(0x400) & 1u) == 1);  // CWP
  CHECK(net.node(0x8C) == 0);
  net.next_cycle();
  CHECK((net.read(0x400) & 1u) == 0);
  CHECK(net.node(0x8C) == 100);
  CHECK(net.node(0x94) == 200);
  CHECK(net.read(0x8C) == 100);
}

TEST_CASE("TosNet hazard 1: a word not rewritten before a commit goes back to its value of two commits ago") {
  Network net;
  const auto naive = [&net](std::uint32_t address, std::uint32_t value) {  // writes only what changes
    net.write(address, value);
    net.commit();
    net.next_cycle();
  };
  naive(0x8C, 1);
  naive(0x8C, 2);
  CHECK(net.node(0x8C) == 2);
  naive(0x94, 7);  // another word: 0x8C was not rewritten
  CHECK(net.node(0x94) == 7);
  CHECK(net.node(0x8C) == 1);
}

TEST_CASE("TosNet hazard 2: a write while a commit is pending aborts the commit") {
  Network net;
  net.next_cycle();
  net.write(0x8C, 1);
  net.commit();
  net.write(0x94, 2);  // too early
  const std::uint32_t status = net.read(0x400);
  CHECK((status & 1u) == 0);
  CHECK((status >> 5 & 1u) == 1);  // CWA
  net.next_cycle();
  CHECK(net.node(0x8C) == 0);
  net.commit();  // clears CWA
  CHECK((net.read(0x400) >> 5 & 1u) == 0);
  net.next_cycle();
  CHECK(net.node(0x8C) == 1);
  CHECK(net.node(0x94) == 2);
}

TEST_CASE("TosNet: what nodes put out appears at the strobe, and stands still within a block") {
  Network net;
  net.next_cycle();
  CHECK(net.device.bus().set(0x80, 11, net.device.clock()) == BusStatus::ok);
  CHECK(net.read(0x80) == 0);
  net.next_cycle();
  CHECK(net.read(0x80) == 11);
  CHECK(net.device.bus().set(0x8C, 1, net.device.clock()) == BusStatus::error);  // a word that only the PC may write
}

TEST_CASE("TosNet: map, rights and the network list") {
  Network net;
  CHECK(net.ask("#W:008000000001\n") == "#?E_FBW\n");  // the OUT word of another node
  CHECK(net.ask("#W:004000000001\n") == "#S_W\n");     // the PC's own OUT word
  CHECK(net.ask("#R:0600\n") == "#S_R:00000030\n");
  CHECK(net.ask("#R:0404\n#R:0510\n#R:0702\n") == "#?E_FBR\n#?E_FBR\n#?E_FBR\n");
  CHECK((net.read(0x400) >> 30) == 3);  // ONLINE, MASTER
  CHECK(net.read(0x500) == 0x00FFFF01);
  CHECK(net.read(0x501) == 0x00070712);
  CHECK(net.read(0x502) == 0x00FFFF25);
  CHECK(net.read(0x503) == 0);
  const std::uint32_t packets = net.read(0x401);
  net.next_cycle();
  CHECK(net.read(0x401) == packets + 1);
}

TEST_CASE("TosNet offline: commits stay pending until the network is back") {
  Network net;
  net.device.bus().tosnet()->set_online(false, net.device.clock());
  net.write(0x8C, 5);
  net.commit();
  net.wait(20 * cycle);
  CHECK((net.read(0x400) & 1u) == 1);
  CHECK((net.read(0x400) >> 31) == 0);
  net.device.bus().tosnet()->set_online(true, net.device.clock());
  net.wait(2 * cycle);
  CHECK(net.node(0x8C) == 5);
  CHECK(net.read(0x402) == 1);
}

TEST_CASE("TosNet: a damaged cycle is counted and told for one cycle") {
  Network net;
  net.next_cycle();
  net.device.bus().tosnet()->damage_cycle(net.device.clock());
  CHECK((net.read(0x400) >> 29 & 1u) == 1);
  CHECK(net.read(0x403) == 1);
  net.next_cycle();
  CHECK((net.read(0x400) >> 29 & 1u) == 0);
}

TEST_CASE("TosNet: too many cycles without a commit halt the system, and only coming back online ends that") {
  DeviceConfiguration configuration = network();
  configuration.tosnet.max_skipped_writes = 10;
  DeviceBench device(configuration);
  const auto halted = [&device] {
    return (std::stoul(device.ask("#R:0400\n", 200).substr(5), nullptr, 16) >> 28 & 1u) == 1;
  };
  for (int i = 0; i < 5; ++i) {
    device.ask("#W:040000000000\n", 8 * cycle);
    CHECK(!halted());
  }
  device.wait(12 * cycle);
  CHECK(halted());
  device.ask("#W:040000000000\n", 2 * cycle);
  CHECK(halted());
  device.device.bus().tosnet()->set_online(false, device.device.clock());
  device.device.bus().tosnet()->set_online(true, device.device.clock());
  CHECK(!halted());
}

TEST_CASE("TosNet: the asynchronous channel, both ways") {
  Network net;
  net.write(0x601, 0x15);  // two bytes for node 5
  net.write(0x602, 0xABCD0000);
  net.wait(2 * cycle);
  AsyncWord word;
  REQUIRE(net.device.bus().tosnet()->async_take(word, net.device.clock()));
  CHECK(word.node == 5);
  CHECK(word.last == 1);
  CHECK(word.data == 0xABCD0000);
  CHECK(net.read(0x700) == 0x80);
  REQUIRE(net.device.bus().tosnet()->async_give({0x11223344, 3, 2}, net.device.clock()));
  net.wait(2 * cycle);
  CHECK(net.read(0x700) == 0x72);
  CHECK(net.read(0x702) == 0x11223344);
  CHECK(net.ask("#R:0702\n") == "#?E_FBR\n");
}

TEST_CASE("FIFO: reading takes, nothing comes from an empty one, nothing goes into a full one") {
  DeviceConfiguration configuration;
  configuration.fifos = {{0x40, 2}};
  DeviceBench device(configuration);
  CHECK(device.ask("#R:41\n#R:40\n") == "#S_R:00000000\n#?E_FBR\n");
  CHECK(device.device.bus().set(0x40, 7, 0) == BusStatus::ok);
  CHECK(device.device.bus().set(0x40, 8, 0) == BusStatus::ok);
  CHECK(device.device.bus().set(0x40, 9, 0) == BusStatus::error);
  CHECK(device.ask("#R:41\n#R:40\n#R:40\n#R:40\n") == "#S_R:00000002\n#S_R:00000007\n#S_R:00000008\n#?E_FBR\n");
  CHECK(device.ask("#W:4000000001\n#W:4000000002\n#R:42\n#W:4000000003\n") == "#S_W\n#S_W\n#S_R:00000000\n#?E_FBW\n");
  CHECK(device.device.bus().get(0x40, 0).value == 1);
  CHECK(device.ask("#R:42\n") == "#S_R:00000001\n");
}

TEST_CASE("double buffer: visible by commit, and the hazard of a swap without a copy") {
  DeviceConfiguration configuration;
  configuration.double_buffers = {{0x40, 4}};
  DeviceBench device(configuration);
  CHECK(device.ask("#W:4000000001\n#R:40\n") == "#S_W\n#S_R:00000000\n");
  CHECK(device.ask("#W:4400000000\n#R:40\n#R:44\n") == "#S_W\n#S_R:00000001\n#S_R:00000001\n");
  CHECK(device.device.bus().get(0x40, 0).value == 1);
  CHECK(device.ask("#W:4100000005\n#W:4400000000\n#R:41\n#R:40\n") == "#S_W\n#S_W\n#S_R:00000005\n#S_R:00000000\n");
}

TEST_CASE("memory of 32 address bits costs what is used of it, and refuses to take the machine") {
  Memory memory(false, 0xFFFFFFFF);
  CHECK(memory.read(0xFFFFFFFF, 0).value == 0);
  CHECK(memory.write(0xFFFFFFFF, 9, 0) == BusStatus::ok);
  CHECK(memory.read(0xFFFFFFFF, 0).value == 9);
  std::uint32_t page = 0;
  while (page < 20000 && memory.write(page * 1024, 1, 0) == BusStatus::ok) {
    ++page;
  }
  CHECK(page == Memory::pages_most - 1);
  CHECK(memory.write(5, 1, 0) == BusStatus::ok);  // existing pages still work
}
