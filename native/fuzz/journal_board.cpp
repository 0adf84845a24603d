// SPDX-License-Identifier: BSD-3-Clause
// A board for tests that kill it:  journal_board ENDPOINT JOURNAL [framed|classic|both]
// It serves the twin until it is killed. It records each write that its bus executes, and each of its own starts, in
// the file JOURNAL. The file is mapped, so the records stay when the process is killed at any moment. tests/apart
// compares them with the results that a host was given.
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <random>
#include <string>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <unistd.h>

#include "device/board.hpp"
#include "device/device.hpp"

namespace {

using namespace unitylink::device;

// Words of 32 bits, little end first: how many records there are, 0, and then each record, an address and a value.
class JournalFile {
 public:
  static constexpr std::uint32_t records_most = 1u << 22;
  // stands for an address: the board has started, and its words are 0
  static constexpr std::uint32_t begun = 0xFFFFFFFF;

  explicit JournalFile(const char* path) {
    const int file = ::open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    constexpr std::size_t bytes = sizeof(std::uint32_t) * 2 * (records_most + 1);
    if (file < 0 || ::ftruncate(file, bytes) != 0) {  // a sparse file of this size
      std::perror(path);
      std::exit(1);
    }
    void* mapped = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    ::close(file);
    if (mapped == MAP_FAILED) {
      std::perror(path);
      std::exit(1);
    }
    words_ = static_cast<std::uint32_t*>(mapped);
  }

  void add(std::uint32_t address, std::uint32_t value) noexcept {
    const std::uint32_t count = words_[0];
    if (count == records_most) {
      std::fputs("journal_board: the journal is full\n", stderr);
      std::_Exit(1);
    }
    words_[2 * count + 2] = address;
    words_[2 * count + 3] = value;
    // written last, so that half a record does not count
    std::atomic_ref(words_[0]).store(count + 1, std::memory_order_release);
  }

 private:
  std::uint32_t* words_;
};

}  // namespace

int main(int count, char** arguments) {
  if (count < 3) {
    std::fputs("usage: journal_board ENDPOINT JOURNAL [framed|classic|both]\n", stderr);
    return 2;
  }
  JournalFile journal(arguments[2]);
  DeviceConfiguration configuration;
  configuration.address_bits = 16;
  configuration.fifo = 2048;
  const std::string spoken = count > 3 ? arguments[3] : "both";
  configuration.protocol = spoken == "framed"    ? Protocol::framed
                           : spoken == "classic" ? Protocol::classic
                                                 : Protocol::both;
  if (std::string(arguments[1]).starts_with("udp")) {  // like every board on UDP
    std::random_device random;
    configuration.offer_secret = std::uint64_t{random()} << 32 | random() | 1;
  }
  auto device = std::make_unique<Device>(configuration);
  device->bus().observe([&journal](std::uint32_t address, std::uint32_t value) { journal.add(address, value); });
  try {
    Board board(std::move(device), make_endpoint(arguments[1], "127.0.0.1"));
    journal.add(JournalFile::begun, 0);
    board.start();
    std::printf("%s\n", board.url().c_str());
    std::fflush(stdout);
    for (char byte; ::read(STDIN_FILENO, &byte, 1) > 0;) {  // end when the program that started it has ended
    }
  } catch (const EndpointError& error) {
    std::fprintf(stderr, "journal_board: %s\n", error.what());
    return 1;
  }
  return 0;
}
