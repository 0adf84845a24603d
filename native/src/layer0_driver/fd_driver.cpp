// SPDX-License-Identifier: BSD-3-Clause
// fd:7 is an open descriptor of this process. `sim:` is made of such a link.
#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "layer0_driver/descriptor_driver.hpp"

namespace unitylink {
namespace {

// A link to a virtual board in this process. It uses the time of the boards.
class LocalDriver final : public DescriptorDriver {
 public:
  using DescriptorDriver::DescriptorDriver;
  [[nodiscard]] TimeSource time_source() const noexcept override {
    return []() noexcept { return RobotTime::here().now_ns(); };
  }
};

// Whether the descriptor is one end of a socket pair that this process made.
bool made_here(int descriptor) noexcept {
  ucred maker{};
  socklen_t size = sizeof maker;
  return ::getsockopt(descriptor, SOL_SOCKET, SO_PEERCRED, &maker, &size) == 0 && maker.pid == ::getpid();
}

}  // namespace

// The driver owns the descriptor from now on. It must close it, because this tells the other side that the link has
// ended.
Outcome open_descriptor(const Url& url, const Patience&, std::unique_ptr<Driver>& driver) {
  std::uint64_t number = 0;
  if (!parse_number(url.path, 1u << 20, number)) {
    return wrong_url(url, "not a descriptor number");
  }
  const int descriptor = static_cast<int>(number);
  if (::fcntl(descriptor, F_SETFD, FD_CLOEXEC) != 0) {
    return {Status::not_found, "link URL '" + url.text + "': no descriptor " + url.path + " is open in this process"};
  }
  if (made_here(descriptor)) {
    driver = std::make_unique<LocalDriver>(descriptor);
  } else {
    driver = std::make_unique<DescriptorDriver>(descriptor);
  }
  return {};
}

}  // namespace unitylink
