// SPDX-License-Identifier: BSD-3-Clause
// TCP and UDP. `serve` is TCP, with a login at its beginning (serve_driver.cpp). TCP sends at once (TCP_NODELAY). The
// UDP socket is connected. Each call of send() is one datagram. An empty datagram tells the board that the link has
// ended.

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "layer0_driver/descriptor.hpp"
#include "layer0_driver/descriptor_driver.hpp"

namespace unitylink {
namespace {

class UdpDriver final : public DescriptorDriver {
 public:
  using DescriptorDriver::DescriptorDriver;
  ~UdpDriver() override { UdpDriver::close(); }

  [[nodiscard]] Transfer receive(std::span<std::uint8_t> room) noexcept override {
    const Transfer transfer = DescriptorDriver::receive(room);
    heard_ = heard_ || transfer.count > 0;
    return transfer;
  }

  // The empty datagram frees the board for the next program. UDP itself has no message for the end of a connection.
  void close() noexcept override {
    if (descriptor() >= 0) {
      static_cast<void>(::send(descriptor(), nullptr, 0, MSG_NOSIGNAL));
    }
    DescriptorDriver::close();
  }

 protected:
  // "Port unreachable" may come from anybody, and from a board that is restarting. If the board has answered before,
  // this counts as a lost datagram. If it never has, nobody is there.
  [[nodiscard]] Transfer failed(int error) noexcept override {
    return error == ECONNREFUSED && heard_ ? Transfer{} : DescriptorDriver::failed(error);
  }

 private:
  std::atomic<bool> heard_ = false;
};

// Connects within `timeout_ns`. Returns 0 or an errno: ECANCELED if the descriptor `cancelled` becomes readable.
int connect_within(int descriptor, const addrinfo& address, std::uint64_t timeout_ns, int cancelled) noexcept {
  if (::connect(descriptor, address.ai_addr, address.ai_addrlen) == 0) {
    return 0;
  }
  if (errno != EINPROGRESS) {
    return errno;
  }
  const auto until = std::chrono::steady_clock::now() + std::chrono::nanoseconds(timeout_ns);
  pollfd waiting[2] = {{descriptor, POLLOUT, 0}, {cancelled, POLLIN, 0}};
  int ready = -1;
  do {  // after a signal, it waits again
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(until - std::chrono::steady_clock::now()).count();
    ready = ::poll(waiting, 2, static_cast<int>(std::max<std::int64_t>(left, 0)) + 1);
  } while (ready < 0 && errno == EINTR);
  if (ready <= 0) {
    return ready == 0 ? ETIMEDOUT : errno;
  }
  if (waiting[1].revents != 0) {
    return ECANCELED;
  }
  int error = 0;
  socklen_t size = sizeof error;
  return ::getsockopt(descriptor, SOL_SOCKET, SO_ERROR, &error, &size) == 0 ? error : errno;
}

Outcome cannot_connect(const Url& url, int error) {
  const std::string name = url.scheme + "://" + url.host + ":" + url.port + ": ";
  switch (error) {
    case ECONNREFUSED:
      return {Status::not_found, name + "nothing listens there; is the board or `unitylink simulate` running?"};
    case ETIMEDOUT: return {Status::timeout, name + "the connection was not accepted in time"};
    case EHOSTUNREACH:
    case ENETUNREACH: return {Status::not_found, name + "no route to this host"};
    case EACCES:
    case EPERM: return {Status::permission, name + "the operating system refuses this connection"};
    default: return {Status::closed, name + std::strerror(error)};
  }
}

}  // namespace

// Opens tcp://HOST:PORT or udp://HOST:PORT. Errors: not_found (no such host, nothing listens, no route), permission,
// timeout, closed.
Outcome open_socket(const Url& url, const Patience& patience, std::unique_ptr<Driver>& driver) {
  const bool stream = url.scheme != "udp";
  addrinfo hints{};
  hints.ai_socktype = stream ? SOCK_STREAM : SOCK_DGRAM;
  addrinfo* addresses = nullptr;
  if (const int error = ::getaddrinfo(url.host.c_str(), url.port.c_str(), &hints, &addresses); error != 0) {
    return {Status::not_found, url.scheme + "://" + url.host + ":" + url.port + ": " + ::gai_strerror(error)};
  }
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> found(addresses, &::freeaddrinfo);
  int error = ECONNREFUSED;
  for (const addrinfo* address = addresses; address != nullptr; address = address->ai_next) {
    Descriptor socket(
        ::socket(address->ai_family, address->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, address->ai_protocol));
    if (!socket.open()) {
      error = errno;
      continue;
    }
    error = connect_within(socket.get(), *address, patience.timeout_ns, patience.cancelled);
    if (error != 0) {
      if (error == ECANCELED) {
        break;
      }
      continue;
    }
    if (stream) {
      const int on = 1;
      ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
      driver = std::make_unique<DescriptorDriver>(socket.get());
    } else {
      driver = std::make_unique<UdpDriver>(socket.get());
    }
    socket.release();  // the driver owns it now
    break;
  }
  return error == 0 ? Outcome{} : cannot_connect(url, error);
}

}  // namespace unitylink
