// SPDX-License-Identifier: BSD-3-Clause
// What the servers of the bench share: a pty or a TCP port of this machine, with one client at a time.
#pragma once

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

namespace unitylink::bench {

[[noreturn]] inline void stop(std::string_view what, int error = 0) {
  std::fprintf(stderr, "%.*s%s%s\n", static_cast<int>(what.size()), what.data(), error != 0 ? ": " : "",
               error != 0 ? std::strerror(error) : "");
  std::exit(1);
}

// The value of `--name` in the arguments, or `otherwise`.
inline std::string argument(std::span<char*> arguments, std::string_view name, std::string otherwise) {
  for (std::size_t i = 1; i + 1 < arguments.size(); ++i) {
    if (arguments[i] == name) {
      return arguments[i + 1];
    }
  }
  return otherwise;
}

inline std::uint64_t number(std::string_view name, const std::string& text) {
  char* end = nullptr;
  errno = 0;
  const auto value = std::strtoull(text.c_str(), &end, 0);
  if (text.empty() || *end != '\0' || errno != 0 || text.front() == '-') {
    stop(std::string(name) + " needs a whole number, not '" + text + "'");
  }
  return value;
}

// Switches off echo, line editing and translation. Setting it at one end of a pty sets it for both.
inline void make_raw(int descriptor) {
  termios settings{};
  if (tcgetattr(descriptor, &settings) != 0) {
    stop("cannot read the terminal settings", errno);
  }
  cfmakeraw(&settings);
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  if (tcsetattr(descriptor, TCSANOW, &settings) != 0) {
    stop("cannot set the terminal raw", errno);
  }
}

class Endpoint {
 public:
  explicit Endpoint(std::string_view kind) : pty_(kind == "pty") {
    if (pty_) {
      descriptor_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
      if (descriptor_ < 0 || grantpt(descriptor_) != 0 || unlockpt(descriptor_) != 0) {
        stop("cannot make a pty", errno);
      }
      make_raw(descriptor_);
      path_ = ptsname(descriptor_);
    } else if (kind == "tcp") {
      listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
      sockaddr_in address{};
      address.sin_family = AF_INET;
      address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      socklen_t size = sizeof address;
      if (listener_ < 0 || bind(listener_, reinterpret_cast<sockaddr*>(&address), size) != 0 ||
          listen(listener_, 1) != 0 || getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
        stop("cannot listen on the loopback", errno);
      }
      port_ = ntohs(address.sin_port);
    } else {
      stop("--endpoint is pty or tcp");
    }
  }
  Endpoint(const Endpoint&) = delete;
  Endpoint& operator=(const Endpoint&) = delete;
  ~Endpoint() {
    leave();
    if (listener_ >= 0) {
      close(listener_);
    }
  }

  // The address for a client: a path for a pty, a port for TCP.
  [[nodiscard]] std::string place() const { return pty_ ? path_ : "127.0.0.1:" + std::to_string(port_); }

  // Waits for a client. False: standard input has ended, because the parent is done.
  [[nodiscard]] bool accept_client() {
    while (!pty_ && descriptor_ < 0) {
      pollfd ready[] = {{listener_, POLLIN, 0}, {STDIN_FILENO, POLLIN, 0}};
      if (poll(ready, 2, -1) < 0 && errno != EINTR) {
        stop("poll", errno);
      }
      if (ready[1].revents != 0) {
        return false;
      }
      if ((ready[0].revents & POLLIN) != 0) {
        descriptor_ = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
        const int on = 1;
        if (descriptor_ >= 0) {
          setsockopt(descriptor_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
        }
      }
    }
    return true;
  }

  // Ends the connection to the client. A pty stays open for the next one.
  void leave() {
    if (!pty_ && descriptor_ >= 0) {
      close(descriptor_);
      descriptor_ = -1;
    }
  }

  // Returns the number of bytes received. 0: there are none, or the client has left. poll() shows which.
  [[nodiscard]] std::size_t receive(std::span<char> into) const {
    while (true) {
      const auto count = read(descriptor_, into.data(), into.size());
      if (count >= 0) {
        return static_cast<std::size_t>(count);
      }
      if (errno != EINTR) {
        return 0;
      }
    }
  }

  // False: the client has left, or has not read for two seconds. (A pty does not report that its reader is gone.)
  [[nodiscard]] bool send(std::span<const char> data) const {
    while (!data.empty()) {
      const auto count = pty_ ? write(descriptor_, data.data(), data.size())
                              : ::send(descriptor_, data.data(), data.size(), MSG_NOSIGNAL);
      if (count > 0) {
        data = data.subspan(static_cast<std::size_t>(count));
      } else if (errno == EAGAIN) {
        pollfd ready{descriptor_, POLLOUT, 0};
        if (poll(&ready, 1, 2000) == 0) {
          return false;
        }
      } else if (errno != EINTR) {
        return false;
      }
    }
    return true;
  }

  [[nodiscard]] int descriptor() const { return descriptor_; }
  [[nodiscard]] bool pty() const { return pty_; }

 private:
  bool pty_;
  int descriptor_ = -1;
  int listener_ = -1;
  std::uint16_t port_ = 0;
  std::string path_;
};

// Prints the address of the endpoint, for the program that started this one.
inline void announce(const Endpoint& endpoint) {
  std::printf("%s\n", endpoint.place().c_str());
  std::fflush(stdout);
}

}  // namespace unitylink::bench
