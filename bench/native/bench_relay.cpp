// SPDX-License-Identifier: BSD-3-Clause
// The floor of a server: bytes go from a client to a board and back, and nothing is done with them. One thread, poll()
// and two sockets.  bench_relay --to PORT  prints the URL of its own port.
#include <vector>

#include "endpoint.hpp"

namespace {

using namespace unitylink::bench;

int connect_to(std::uint16_t port) {
  const int descriptor = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(port);
  const int on = 1;
  if (descriptor < 0 || ::connect(descriptor, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 ||
      ::setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on) != 0) {
    stop("cannot connect to the board", errno);
  }
  return descriptor;
}

// False: the other side has left.
bool pass(int from, int to) {
  std::array<char, 16384> chunk;
  const ssize_t count = ::recv(from, chunk.data(), chunk.size(), 0);
  return count > 0 && ::send(to, chunk.data(), static_cast<std::size_t>(count), MSG_NOSIGNAL) == count;
}

}  // namespace

int main(int count, char** arguments) {
  const auto port = number("--to", argument(std::span(arguments, static_cast<std::size_t>(count)), "--to", ""));
  const int listener = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  if (listener < 0 || ::bind(listener, reinterpret_cast<sockaddr*>(&address), size) != 0 ||
      ::listen(listener, 1) != 0 || ::getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    stop("no port", errno);
  }
  std::printf("tcp://127.0.0.1:%u\n", static_cast<unsigned>(ntohs(address.sin_port)));
  std::fflush(stdout);
  while (true) {
    pollfd waiting[] = {{listener, POLLIN, 0}, {STDIN_FILENO, POLLIN, 0}};
    if (::poll(waiting, 2, -1) < 0 && errno != EINTR) {
      stop("poll", errno);
    }
    if (waiting[1].revents != 0) {
      return 0;
    }
    const int client = ::accept(listener, nullptr, nullptr);
    if (client < 0) {
      continue;
    }
    const int on = 1;
    ::setsockopt(client, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    const int board = connect_to(static_cast<std::uint16_t>(port));
    pollfd both[] = {{client, POLLIN, 0}, {board, POLLIN, 0}, {STDIN_FILENO, POLLIN, 0}};
    while (::poll(both, 3, -1) > 0 && both[2].revents == 0) {
      if ((both[0].revents != 0 && !pass(client, board)) || (both[1].revents != 0 && !pass(board, client))) {
        break;
      }
    }
    ::close(client);
    ::close(board);
  }
}
