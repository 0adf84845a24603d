// SPDX-License-Identifier: BSD-3-Clause
#include "layer0_driver/pumped_driver.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <sys/socket.h>
#include <unistd.h>

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
  pair = {ends[0], ends[1]};
  return {};
}

void PumpedDriver::close() noexcept {
  if (!stop_.exchange(true)) {
    ::shutdown(far_, SHUT_RDWR);
    for (std::thread& pump : pumps_) {
      pump.join();
    }
    pumps_.clear();
    ::close(far_);
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
    ::close(far_);
    let_go(false);
  }
  DescriptorDriver::close();
}

std::string PumpedDriver::reason() const {
  const std::scoped_lock lock(mutex_);
  return why_.empty() ? DescriptorDriver::reason() : why_;
}

void PumpedDriver::ended(const std::string& why) {
  const std::scoped_lock lock(mutex_);
  if (why_.empty() && !stop_) {
    why_ = why;
  }
  gone_ = true;
  ::shutdown(far_, SHUT_RDWR);
}

void PumpedDriver::hand_on(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty() && running()) {
    const ssize_t count = ::send(far_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(count));
    } else if (errno == EAGAIN || errno == EINTR) {
      pollfd waiting{far_, POLLOUT, 0};
      ::poll(&waiting, 1, patience_ms);
    } else {
      return;
    }
  }
}

std::size_t PumpedDriver::fetch(std::span<std::uint8_t> room, std::uint64_t patience_ns, int other) {
  std::array<pollfd, 2> waiting{{{far_, POLLIN, 0}, {other, POLLIN, 0}}};
  if (poll_for(waiting, patience_ns) <= 0 || waiting[0].revents == 0) {
    return 0;
  }
  const ssize_t count = ::recv(far_, room.data(), room.size(), MSG_DONTWAIT);
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

}  // namespace unitylink
