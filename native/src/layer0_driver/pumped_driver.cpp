// SPDX-License-Identifier: BSD-3-Clause
#include "layer0_driver/pumped_driver.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <exception>
#include <new>
#include <sys/socket.h>

#include "layer0_driver/polling.hpp"

namespace unitylink {
namespace {

constexpr int patience_ms = 100;  // how often a thread checks whether it must end

}  // namespace

Outcome make_socket_pair(SocketPair& pair) {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    return {Status::closed, std::string("no socket pair: ") + std::strerror(errno)};
  }
  pair = {Descriptor(ends[0]), Descriptor(ends[1])};
  return {};
}

void PumpedDriver::start(std::function<void()> pump) {
  pumps_.emplace_back([this, pump = std::move(pump)] {
    try {
      pump();
    } catch (const std::bad_alloc&) {
      ended("out of memory");  // short enough to need none
    } catch (const std::exception& error) {
      ended(error.what());
    }
  });
}

void PumpedDriver::close() noexcept {
  if (!stop_.exchange(true)) {
    ::shutdown(far_.get(), SHUT_RDWR);
    for (std::thread& pump : pumps_) {
      pump.join();
    }
    pumps_.clear();
    far_.reset();
    let_go(true);
  }
  DescriptorDriver::close();
}

void PumpedDriver::disown() noexcept {
  if (!stop_.exchange(true)) {
    for (std::thread& pump : pumps_) {
      pump.detach();
    }
    pumps_.clear();
    far_.reset();
    let_go(false);
  }
  DescriptorDriver::close();
}

std::string PumpedDriver::reason() const {
  const std::scoped_lock lock(mutex_);
  return why_.empty() ? DescriptorDriver::reason() : why_;
}

void PumpedDriver::ended(std::string_view what, std::string_view why) noexcept {
  const std::scoped_lock lock(mutex_);
  if (why_.empty() && !stop_) {
    try {
      why_.append(what).append(why);
    } catch (const std::bad_alloc&) {  // then reason() is that of the socket
      why_.clear();
    }
  }
  gone_ = true;
  ::shutdown(far_.get(), SHUT_RDWR);
}

void PumpedDriver::hand_on(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty() && running()) {
    const ssize_t count = ::send(far_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(count));
    } else if (errno == EAGAIN || errno == EINTR) {
      pollfd waiting{far_.get(), POLLOUT, 0};
      ::poll(&waiting, 1, patience_ms);
    } else {
      return;
    }
  }
}

std::size_t PumpedDriver::fetch(std::span<std::uint8_t> room, std::uint64_t patience_ns, int other) {
  std::array<pollfd, 2> waiting{{{far_.get(), POLLIN, 0}, {other, POLLIN, 0}}};
  if (poll_for(waiting, patience_ns) <= 0 || waiting[0].revents == 0) {
    return 0;
  }
  const ssize_t count = ::recv(far_.get(), room.data(), room.size(), MSG_DONTWAIT);
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

}  // namespace unitylink
