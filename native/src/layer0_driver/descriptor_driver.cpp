// SPDX-License-Identifier: BSD-3-Clause
#include "layer0_driver/descriptor_driver.hpp"

#include <cerrno>
#include <cstring>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace unitylink {
namespace {

constexpr int end_of_stream = -1;  // used where an errno is expected

}  // namespace

Outcome refused_port(const std::string& name, int error, const char* missing, const char* forbidden) {
  switch (error) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
    case ENOTDIR:
    case EISDIR: return {Status::not_found, name + ": there is no such port; " + missing};
    case EIO: return {Status::not_found, name + ": the port is gone (unplugged, or its other side was closed)"};
    case EACCES:
    case EPERM: return {Status::permission, name + ": permission denied; " + forbidden};
    case EWOULDBLOCK:
    case EBUSY: return {Status::busy, name + ": another program holds it"};
    default: return {Status::closed, name + ": " + std::strerror(error)};
  }
}

DescriptorDriver::DescriptorDriver(int descriptor) noexcept : descriptor_(descriptor) {
  int on = 1, type = 0;
  socklen_t size = sizeof type;
  usable_ = ::ioctl(descriptor_, FIONBIO, &on) == 0;
  socket_ = usable_ && ::getsockopt(descriptor_, SOL_SOCKET, SO_TYPE, &type, &size) == 0;
  usable_ = usable_ && (socket_ || errno == ENOTSOCK);
  error_ = usable_ ? 0 : errno;
  datagram_ = socket_ && type != SOCK_STREAM;
}

DescriptorDriver::~DescriptorDriver() { DescriptorDriver::close(); }

Transfer DescriptorDriver::send(std::span<const std::uint8_t> bytes) noexcept {
  if (!usable_) {
    return {0, Status::closed};
  }
  const ssize_t count = socket_ ? ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL)
                                : ::write(descriptor_, bytes.data(), bytes.size());
  return count >= 0 ? Transfer{static_cast<std::size_t>(count), Status::ok} : failed(errno);
}

Transfer DescriptorDriver::receive(std::span<std::uint8_t> room) noexcept {
  if (!usable_) {
    return {0, Status::closed};
  }
  const ssize_t count = ::read(descriptor_, room.data(), room.size());
  if (count == 0 && !datagram_) {
    return failed(end_of_stream);
  }
  return count >= 0 ? Transfer{static_cast<std::size_t>(count), Status::ok} : failed(errno);
}

void DescriptorDriver::close() noexcept {
  if (descriptor_ >= 0) {
    ::close(descriptor_);
    descriptor_ = -1;
  }
}

Transfer DescriptorDriver::failed(int error) noexcept {
  if (error == EAGAIN || error == EWOULDBLOCK || error == EINTR || error == ENOBUFS) {
    return {};
  }
  error_ = error;
  return {0, Status::closed};
}

std::string DescriptorDriver::reason() const {
  switch (error_) {
    case 0: return "closed by this program";
    case end_of_stream:
      if (socket_) {
        return "the other side closed the connection";
      }
      [[fallthrough]];  // a terminal that was hung up reads as end of file
    case EIO: return "the port is gone: unplugged, or the other side of the terminal was closed";
    case ECONNREFUSED: return "nothing listens at the other side";
    default: return std::strerror(error_);
  }
}

}  // namespace unitylink
