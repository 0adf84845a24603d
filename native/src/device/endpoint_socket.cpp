// SPDX-License-Identifier: BSD-3-Clause
// Endpoints on sockets: a socket pair for this process, TCP, UDP.
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <vector>

#include "device/endpoints.hpp"

namespace unitylink::device {

namespace {

Endpoint::Transfer outcome(ssize_t count, bool end_means_gone) {
  if (count > 0 || (count == 0 && !end_means_gone)) {
    return {Endpoint::Result::done, static_cast<std::size_t>(count)};
  }
  if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR || errno == ENOBUFS)) {
    return {Endpoint::Result::nothing, 0};
  }
  return {Endpoint::Result::gone, 0};
}

struct Bound {
  Descriptor socket;
  std::string place;  // "HOST:PORT" as a URL has it
};

Bound bind_socket(const std::string& address, std::uint16_t port, int type) {
  const std::string wanted = (type == SOCK_STREAM ? "tcp " : "udp ") + address + ":" + std::to_string(port);
  addrinfo hints{};
  hints.ai_socktype = type;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  const int unknown = ::getaddrinfo(address.c_str(), std::to_string(port).c_str(), &hints, &found);
  if (unknown != 0) {
    throw EndpointError(wanted + ": " + ::gai_strerror(unknown) +
                        "; give an address of this machine, such as 127.0.0.1");
  }
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> keeper(found, &::freeaddrinfo);
  Descriptor socket(::socket(found->ai_family, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int on = 1;
  if (type == SOCK_STREAM) {
    ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  } else {
    ::setsockopt(socket.get(),
                 found->ai_family == AF_INET6 ? static_cast<int>(IPPROTO_IPV6) : static_cast<int>(IPPROTO_IP),
                 // so that an error of this socket shows when the client has left
                 found->ai_family == AF_INET6 ? IPV6_RECVERR : IP_RECVERR, &on, sizeof on);
  }
  if (!socket.open() || ::bind(socket.get(), found->ai_addr, found->ai_addrlen) != 0 ||
      (type == SOCK_STREAM && ::listen(socket.get(), 8) != 0)) {
    const int why = errno;
    throw EndpointError(wanted + ": " + std::strerror(why) +
                        (why == EADDRINUSE ? "; another program has this port, choose another" : ""));
  }
  sockaddr_storage name{};
  socklen_t size = sizeof name;
  ::getsockname(socket.get(), reinterpret_cast<sockaddr*>(&name), &size);
  const auto chosen = ntohs(name.ss_family == AF_INET6 ? reinterpret_cast<sockaddr_in6&>(name).sin6_port
                                                       : reinterpret_cast<sockaddr_in&>(name).sin_port);
  const std::string host = address.find(':') == std::string::npos ? address : "[" + address + "]";
  return {std::move(socket), host + ":" + std::to_string(chosen)};
}

// For links in this process. A link takes over the host's end. When it closes this end, the board knows that the link
// has left, and makes a new one for the next link.
class DescriptorEndpoint final : public StreamEndpoint {
 public:
  std::string url() override {
    if (!client_.open() || !client_lives()) {
      int ends[2];
      if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends) != 0) {
        throw EndpointError(std::string("socket pair: ") + std::strerror(errno));
      }
      client_.reset(ends[0]);
      host_ = ends[1];
      fresh_ = true;
    }
    return "fd:" + std::to_string(host_);
  }

  bool admit(bool) override { return std::exchange(fresh_, false); }

 private:
  int host_ = -1;  // the link's end, which the link closes
  bool fresh_ = false;
};

class TcpEndpoint final : public StreamEndpoint {
 public:
  explicit TcpEndpoint(Bound bound) : listener_(std::move(bound.socket)), url_("tcp://" + bound.place) {}

  std::string url() override { return url_; }
  [[nodiscard]] int listener() const noexcept override { return listener_.get(); }

  [[nodiscard]] bool ended() const noexcept override { return client_.open() && ended_; }

  // `printf '$RLC*9B\n' | nc -N` closes its sending side at once, while its answers are still to come.
  Transfer receive(std::span<std::uint8_t> room) override {
    const Transfer taken = outcome(::recv(client_.get(), room.data(), room.size(), 0), false);
    if (taken.result == Result::gone) {
      client_.reset();
    }
    ended_ = taken.result == Result::done && taken.bytes == 0;
    return ended_ ? Transfer{} : taken;
  }

  bool admit(bool) override {
    bool came = false;
    for (;;) {
      Descriptor next(::accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
      if (!next.open()) {
        return came;
      }
      if (client_.open() && client_lives()) {
        ::send(next.get(), busy_line.data(), busy_line.size(), MSG_NOSIGNAL);
        continue;
      }
      const int on = 1;
      ::setsockopt(next.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
      client_ = std::move(next);
      ended_ = false;
      came = true;
    }
  }

 private:
  Descriptor listener_;
  std::string url_;
  bool ended_ = false;
};

class UdpEndpoint final : public Endpoint {
 public:
  explicit UdpEndpoint(Bound bound) : socket_(std::move(bound.socket)), url_("udp://" + bound.place) {}

  std::string url() override { return url_; }
  [[nodiscard]] bool has_client() const noexcept override { return peer_size_ != 0; }
  [[nodiscard]] int client() const noexcept override { return socket_.get(); }

  bool admit(bool at_rest) override {
    at_rest_ = at_rest;
    return std::exchange(came_, false);
  }

  Transfer receive(std::span<std::uint8_t> room) override {
    if (taken_ == received_) {
      const Transfer next = receive_datagram();
      if (next.result != Result::done) {
        return next;
      }
    }
    const std::size_t count = std::min(room.size(), received_ - taken_);  // the rest waits until there is room
    std::copy_n(datagram_.begin() + static_cast<std::ptrdiff_t>(taken_), count, room.begin());
    taken_ += count;
    return {Result::done, count};
  }

  Transfer send(std::span<const std::uint8_t> bytes) override {
    constexpr std::size_t datagram_most = 1400;
    const Transfer sent = outcome(::sendto(socket_.get(), bytes.data(), std::min(bytes.size(), datagram_most),
                                           MSG_NOSIGNAL, reinterpret_cast<sockaddr*>(&peer_), peer_size_),
                                  false);
    return sent.result == Result::gone ? leave() : sent;
  }

 private:
  Transfer receive_datagram() {
    taken_ = received_ = 0;
    sockaddr_storage from{};
    socklen_t size = sizeof from;
    const ssize_t count =
        ::recvfrom(socket_.get(), datagram_.data(), datagram_.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
    if (count < 0) {
      const Transfer failed = outcome(count, false);
      return failed.result == Result::gone ? leave() : failed;
    }
    const bool known = size == peer_size_ && std::memcmp(&from, &peer_, size) == 0;
    if (count == 0) {
      return known ? leave() : Transfer{Result::nothing, 0};  // an empty datagram is the end of the client
    }
    if (!known && has_client() && at_rest_) {
      probe();
    }
    if (!known && has_client()) {
      ::sendto(socket_.get(), busy_line.data(), busy_line.size(), MSG_NOSIGNAL, reinterpret_cast<sockaddr*>(&from),
               size);
      return {Result::nothing, 0};
    }
    if (!known) {
      peer_ = from;
      peer_size_ = size;
      came_ = true;
    }
    received_ = static_cast<std::size_t>(count);
    return {Result::done, 0};
  }

  Transfer leave() {
    std::uint8_t scratch[512];
    msghdr message{};
    iovec vector{scratch, sizeof scratch};
    message.msg_iov = &vector;
    message.msg_iovlen = 1;
    while (::recvmsg(socket_.get(), &message, MSG_ERRQUEUE | MSG_DONTWAIT) >= 0) {}
    peer_size_ = 0;
    return {Result::gone, 0};
  }

  // A client that left without such an end is noticed only when another one wants to connect. Then it is sent an empty
  // line. If its port is closed, the system reports it.
  void probe() {
    const char line = '\n';
    for (int attempt = 0; attempt < 2; ++attempt) {  // the second call reports the first refusal
      if (::sendto(socket_.get(), &line, 1, MSG_NOSIGNAL, reinterpret_cast<sockaddr*>(&peer_), peer_size_) < 0 &&
          errno == ECONNREFUSED) {
        leave();
        return;
      }
    }
  }

  Descriptor socket_;
  std::string url_;
  sockaddr_storage peer_{};
  socklen_t peer_size_ = 0;
  std::vector<std::uint8_t> datagram_ = std::vector<std::uint8_t>(65536);
  std::size_t received_ = 0;
  std::size_t taken_ = 0;
  bool came_ = false;
  bool at_rest_ = true;
};

}  // namespace

Endpoint::Transfer StreamEndpoint::receive(std::span<std::uint8_t> room) {
  const Transfer taken = outcome(::recv(client_.get(), room.data(), room.size(), 0), true);
  if (taken.result == Result::gone) {
    client_.reset();
  }
  return taken;
}

Endpoint::Transfer StreamEndpoint::send(std::span<const std::uint8_t> bytes) {
  const Transfer sent = outcome(::send(client_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL), true);
  if (sent.result == Result::gone) {
    client_.reset();
  }
  return sent;
}

bool StreamEndpoint::client_lives() const noexcept {
  pollfd state{client_.get(), POLLRDHUP, 0};
  return ::poll(&state, 1, 0) == 0;
}

std::unique_ptr<Endpoint> make_descriptor_endpoint() { return std::make_unique<DescriptorEndpoint>(); }

std::unique_ptr<Endpoint> make_tcp_endpoint(const std::string& bind, std::uint16_t port) {
  return std::make_unique<TcpEndpoint>(bind_socket(bind, port, SOCK_STREAM));
}

std::unique_ptr<Endpoint> make_udp_endpoint(const std::string& bind, std::uint16_t port) {
  return std::make_unique<UdpEndpoint>(bind_socket(bind, port, SOCK_DGRAM));
}

}  // namespace unitylink::device
