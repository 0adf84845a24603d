// SPDX-License-Identifier: BSD-3-Clause
#include "server/door.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <memory>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include "layer0_driver/polling.hpp"
#include "layer0_driver/robot_time.hpp"
#include "unitylink/protocol.hpp"

namespace unitylink::server {
namespace {

constexpr int backlog = 256;
constexpr int send_buffer_bytes = 65536;  // so that a client that does not read is noticed soon
constexpr int no_files_pause_ms = 20;
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

void say(Connection& connection, const LoginAnswer& answer) {
  const std::string line = answer.line();
  static_cast<void>(connection.send({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()}));
}

}  // namespace

Outcome Door::open(const std::string& host, std::uint16_t port, std::shared_ptr<const tls::Side> side,
                   std::optional<Door>& door) {
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
            wanted + ": " + std::strerror(error) + "; " +
                (error == EADDRINUSE ? "another program has this port, choose another"
                 : error == EACCES   ? "choose a port above 1023, or give this program the right to listen there"
                                     : "give an address of this machine, such as 127.0.0.1")};
  }
  sockaddr_storage name{};
  socklen_t size = sizeof name;
  ::getsockname(listener.get(), reinterpret_cast<sockaddr*>(&name), &size);
  door.emplace(Door(std::move(listener), told(name, size), std::move(side)));
  return {};
}

std::optional<Knock> Door::wait(std::uint64_t timeout_ns) {
  const std::uint64_t until_ns = real_ns() + timeout_ns;
  while (true) {
    std::vector<pollfd> waiting{{callers_.size() < knocking_most ? listener_.get() : -1, POLLIN, 0}};
    std::uint64_t look_ns = until_ns;
    for (const Caller& caller : callers_) {
      waiting.push_back({caller.connection.get(), static_cast<short>(caller.wants_room ? POLLOUT : POLLIN), 0});
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
      if (caller.connection.open() && real_ns() >= caller.until_ns) {
        caller.connection.end();
        turned_away_ += 1;
      }
    }
    std::erase_if(callers_, [](const Caller& caller) { return !caller.connection.open(); });
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
      if (errno == EMFILE || errno == ENFILE) {  // the caller still waits: a pause, or this loop takes a core
        ::poll(nullptr, 0, no_files_pause_ms);
      }
      return;
    }
    set(next.get(), IPPROTO_TCP, TCP_NODELAY, 1);
    set(next.get(), SOL_SOCKET, SO_SNDBUF, send_buffer_bytes);
    set(next.get(), IPPROTO_TCP, TCP_USER_TIMEOUT, unheard_most_ms);
    set(next.get(), SOL_SOCKET, SO_KEEPALIVE, 1);
    set(next.get(), IPPROTO_TCP, TCP_KEEPIDLE, 10);
    set(next.get(), IPPROTO_TCP, TCP_KEEPINTVL, 2);
    auto over = side_ ? std::make_unique<tls::Session>(side_, next.get()) : nullptr;
    callers_.push_back({.connection = Connection(std::move(next), std::move(over)),
                        .peer = told(from, size),
                        .line = {},
                        .until_ns = real_ns() + patience_ns,
                        .shaken = !side_});
  }
}

void Door::turn_away(Caller& caller, const std::string& text) {
  turned_away_ += 1;
  if (!text.empty()) {
    say(caller.connection, {"version", text});
  }
  caller.connection.end();
}

// Goes on with the handshake of TLS. False: it is not over, or has failed.
bool Door::shake(Caller& caller) {
  constexpr std::uint8_t handshake = 0x16;  // with which each connection of TLS begins
  std::uint8_t first = handshake;
  static_cast<void>(!::recv(caller.connection.get(), &first, 1, MSG_PEEK | MSG_DONTWAIT));
  if (first == static_cast<std::uint8_t>(protocol::serve::greeting.front())) {
    Connection plain(Descriptor(::fcntl(caller.connection.get(), F_DUPFD_CLOEXEC, 0)));
    say(plain, {"version", "this server wants TLS; add ?tls_ca=FILE to the URL"});
    turn_away(caller, {});
    return false;
  }
  const tls::Progress progress = caller.connection.tls()->shake();
  caller.wants_room = progress == tls::Progress::writes;
  caller.shaken = progress == tls::Progress::done;
  if (progress == tls::Progress::failed) {
    turn_away(caller, {});
  }
  return caller.shaken;
}

// Reads what a caller has sent. Its connection is not open afterwards if it was turned away, or has said all.
std::optional<Knock> Door::hear(Caller& caller) {
  if (!caller.shaken && !shake(caller)) {
    return std::nullopt;
  }
  std::array<std::uint8_t, protocol::serve::login_max> room;
  const Transfer transfer = caller.connection.receive(std::span(room).first(room.size() - caller.line.size()));
  const bool there = transfer.status == Status::ok;
  if (there && transfer.count == 0) {
    return std::nullopt;
  }
  caller.line.append(reinterpret_cast<const char*>(room.data()), transfer.count);
  const std::size_t end = caller.line.find('\n');
  const std::size_t known = std::min(caller.line.size(), protocol::serve::greeting.size());
  const bool plausible = protocol::serve::greeting.starts_with(std::string_view(caller.line).substr(0, known));
  if (there && plausible && end == std::string::npos && caller.line.size() < room.size()) {
    return std::nullopt;
  }
  // Nothing may follow the line before it is answered.
  const auto login = there && plausible && end != std::string::npos && end + 1 == caller.line.size()
                         ? Login::parse(std::string_view(caller.line).substr(0, end))
                         : std::optional<Login>();
  if (!login) {
    turn_away(caller, there ? "this is `unitylink serve`; use the URL serve://" + place_ + "/BOARD" : std::string());
    return std::nullopt;
  }
  Knock knock{
      .connection = std::move(caller.connection), .peer = std::move(caller.peer), .certificate = {}, .login = *login};
  if (knock.connection.tls() != nullptr) {
    knock.certificate = knock.connection.tls()->peer();
  }
  return knock;
}

void Door::refuse(Knock knock, const std::string& reason, const std::string& text) {
  say(knock.connection, {reason, text});
}

Connection Door::admit(Knock knock, const std::string& text) {
  say(knock.connection, {{}, text});
  return std::move(knock.connection);
}

}  // namespace unitylink::server
