// SPDX-License-Identifier: BSD-3-Clause
#include "server/door.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include "layer0_driver/polling.hpp"
#include "layer0_driver/robot_time.hpp"
#include "unitylink/protocol.hpp"

namespace unitylink::server {
namespace {

constexpr int backlog = 256;
constexpr int send_buffer_bytes = 65536;    // so that a client that does not read is noticed soon
constexpr unsigned unheard_most_ms = 5000;  // what a dead computer does not confirm for so long ends its connection

void set(int socket, int level, int option, int value) noexcept {
  ::setsockopt(socket, level, option, &value, sizeof value);
}

std::string told(const sockaddr_storage& address, socklen_t size) {
  std::array<char, NI_MAXHOST> host{};
  std::array<char, NI_MAXSERV> port{};
  if (::getnameinfo(reinterpret_cast<const sockaddr*>(&address), size, host.data(), host.size(), port.data(),
                    port.size(), NI_NUMERICHOST | NI_NUMERICSERV) != 0) {
    return "unknown";
  }
  const std::string name = host.data();
  return (name.find(':') == std::string::npos ? name : "[" + name + "]") + ":" + port.data();
}

void say(int socket, const LoginAnswer& answer) noexcept {
  const std::string line = answer.line();
  static_cast<void>(!::send(socket, line.data(), line.size(), MSG_NOSIGNAL | MSG_DONTWAIT));
}

}  // namespace

Outcome Door::open(const std::string& host, std::uint16_t port, std::optional<Door>& door) {
  const std::string wanted = host + ":" + std::to_string(port);
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (const int error = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found); error != 0) {
    return {Status::not_found,
            wanted + ": " + ::gai_strerror(error) + "; give an address of this machine, such as 127.0.0.1"};
  }
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> keeper(found, &::freeaddrinfo);
  Descriptor listener(::socket(found->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  set(listener.get(), SOL_SOCKET, SO_REUSEADDR, 1);
  if (!listener.open() || ::bind(listener.get(), found->ai_addr, found->ai_addrlen) != 0 ||
      ::listen(listener.get(), backlog) != 0) {
    const int error = errno;
    return {error == EADDRINUSE ? Status::busy : Status::not_found,
            wanted + ": " + std::strerror(error) +
                (error == EADDRINUSE ? "; another program has this port, choose another" : "")};
  }
  sockaddr_storage name{};
  socklen_t size = sizeof name;
  ::getsockname(listener.get(), reinterpret_cast<sockaddr*>(&name), &size);
  door.emplace(Door(std::move(listener), told(name, size)));
  return {};
}

std::optional<Knock> Door::wait(std::uint64_t timeout_ns) {
  const std::uint64_t until_ns = real_ns() + timeout_ns;
  while (true) {
    std::vector<pollfd> waiting{{callers_.size() < knocking_most ? listener_.get() : -1, POLLIN, 0}};
    std::uint64_t look_ns = until_ns;
    for (const Caller& caller : callers_) {
      waiting.push_back({caller.socket.get(), POLLIN, 0});
      look_ns = std::min(look_ns, caller.until_ns);
    }
    const std::uint64_t now = real_ns();
    static_cast<void>(poll_for(waiting, look_ns - std::min(look_ns, now)));
    std::optional<Knock> knock;
    for (std::size_t index = callers_.size(); index-- > 0 && !knock;) {
      Caller& caller = callers_[index];
      if (waiting[index + 1].revents != 0) {
        knock = hear(caller);
      }
      if (caller.socket.open() && real_ns() >= caller.until_ns) {
        caller.socket.reset();
        turned_away_ += 1;
      }
    }
    std::erase_if(callers_, [](const Caller& caller) { return !caller.socket.open(); });
    if (knock) {
      return knock;
    }
    if (waiting[0].revents != 0) {
      let_in();
    }
    if (real_ns() >= until_ns) {
      return std::nullopt;
    }
  }
}

void Door::let_in() {
  while (callers_.size() < knocking_most) {
    sockaddr_storage from{};
    socklen_t size = sizeof from;
    Descriptor next(
        ::accept4(listener_.get(), reinterpret_cast<sockaddr*>(&from), &size, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!next.open()) {
      return;
    }
    set(next.get(), IPPROTO_TCP, TCP_NODELAY, 1);
    set(next.get(), SOL_SOCKET, SO_SNDBUF, send_buffer_bytes);
    set(next.get(), IPPROTO_TCP, TCP_USER_TIMEOUT, unheard_most_ms);
    set(next.get(), SOL_SOCKET, SO_KEEPALIVE, 1);
    set(next.get(), IPPROTO_TCP, TCP_KEEPIDLE, 10);
    set(next.get(), IPPROTO_TCP, TCP_KEEPINTVL, 2);
    callers_.push_back({std::move(next), told(from, size), {}, real_ns() + patience_ns});
  }
}

// Reads what a caller has sent. Its socket is not open afterwards if it was turned away, or has said all.
std::optional<Knock> Door::hear(Caller& caller) {
  std::array<char, protocol::serve::login_max> room;
  const ssize_t count = ::recv(caller.socket.get(), room.data(), room.size() - caller.line.size(), 0);
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) {
    return std::nullopt;
  }
  caller.line.append(room.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  const std::size_t end = caller.line.find('\n');
  const std::size_t known = std::min(caller.line.size(), protocol::serve::greeting.size());
  const bool plausible = protocol::serve::greeting.starts_with(std::string_view(caller.line).substr(0, known));
  if (count > 0 && plausible && end == std::string::npos && caller.line.size() < room.size()) {
    return std::nullopt;
  }
  // Nothing may follow the line before it is answered.
  const auto login = count > 0 && plausible && end != std::string::npos && end + 1 == caller.line.size()
                         ? Login::parse(std::string_view(caller.line).substr(0, end))
                         : std::optional<Login>();
  if (!login) {
    turned_away_ += 1;
    if (count > 0) {
      say(caller.socket.get(), {"version", "this is `unitylink serve`; use the URL serve://" + place_ + "/BOARD"});
    }
    caller.socket.reset();
    return std::nullopt;
  }
  Knock knock{std::move(caller.socket), std::move(caller.peer), *login};
  return knock;
}

void Door::refuse(Knock knock, const std::string& reason, const std::string& text) {
  say(knock.socket.get(), {reason, text});
}

Descriptor Door::admit(Knock knock, const std::string& text) {
  say(knock.socket.get(), {{}, text});
  return std::move(knock.socket);
}

}  // namespace unitylink::server
