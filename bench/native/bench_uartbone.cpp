// SPDX-License-Identifier: BSD-3-Clause
// A device for LiteX's UARTBone on a pty, which answers at once. It was written from the protocol of LiteX's host tool.
//   request  command (1 write incrementing, 2 read incrementing, 3 write fixed, 4 read fixed), words, word address
//            (4 bytes, most significant first), for a write the words; reply to a read: the words
// Word n is 0x40DE0000 + n until it is written. It prints the path of the pty, and serves until standard input ends.
#include <vector>

#include "endpoint.hpp"

namespace {

constexpr std::size_t words = 1 << 16;
constexpr std::size_t head_bytes = 6;

class UartBone {
 public:
  UartBone() : memory_(words) {
    for (std::size_t word = 0; word < words; ++word) {
      memory_[word] = 0x40DE0000u + static_cast<std::uint32_t>(word);
    }
  }

  // Removes complete requests from the front of `received`, and appends their answers to `reply`. False: an unknown
  // command.
  bool serve(std::vector<char>& received, std::vector<char>& reply) {
    std::size_t at = 0;
    while (received.size() - at >= head_bytes) {
      const auto command = static_cast<unsigned char>(received[at]);
      const std::size_t length = static_cast<unsigned char>(received[at + 1]);
      const bool write = command == 1 || command == 3;
      const std::size_t step = command <= 2 ? 1 : 0;
      if (command < 1 || command > 4) {
        return false;
      }
      const std::size_t whole = head_bytes + (write ? 4 * length : 0);
      if (received.size() - at < whole) {
        break;
      }
      std::size_t address = word(&received[at + 2]);
      for (std::size_t i = 0; i < length; ++i, address += step) {
        if (write) {
          memory_[address % words] = word(&received[at + head_bytes + 4 * i]);
        } else {
          for (int shift = 24; shift >= 0; shift -= 8) {
            reply.push_back(static_cast<char>(memory_[address % words] >> shift));
          }
        }
      }
      at += whole;
    }
    received.erase(received.begin(), received.begin() + static_cast<std::ptrdiff_t>(at));
    return true;
  }

 private:
  static std::uint32_t word(const char* bytes) {
    std::uint32_t value = 0;
    for (int i = 0; i < 4; ++i) {
      value = (value << 8) | static_cast<unsigned char>(bytes[i]);
    }
    return value;
  }

  std::vector<std::uint32_t> memory_;
};

}  // namespace

int main() {
  using namespace unitylink::bench;
  Endpoint endpoint("pty");
  announce(endpoint);
  UartBone device;
  std::vector<char> received;
  std::vector<char> reply;
  std::array<char, 4096> chunk{};
  while (true) {
    pollfd ready[] = {{endpoint.descriptor(), POLLIN, 0}, {STDIN_FILENO, POLLIN, 0}};
    if (poll(ready, 2, -1) < 0 && errno != EINTR) {
      stop("poll", errno);
    }
    if (ready[1].revents != 0) {
      return 0;
    }
    if ((ready[0].revents & POLLIN) == 0) {
      received.clear();
      usleep(10000);  // the client has closed the pty; wait for the next one
      continue;
    }
    const auto count = endpoint.receive(chunk);
    received.insert(received.end(), chunk.begin(), chunk.begin() + static_cast<std::ptrdiff_t>(count));
    reply.clear();
    if (!device.serve(received, reply)) {
      stop("a command UARTBone does not have");
    }
    if (!reply.empty() && !endpoint.send(reply)) {
      stop("the client does not read");
    }
  }
}
