// SPDX-License-Identifier: BSD-3-Clause
// fd:7 is an open descriptor of this process. `sim:` is made of such a link.
#include <atomic>
#include <fcntl.h>
#include <memory>
#include <sys/socket.h>
#include <unistd.h>

#include "layer0_driver/descriptor.hpp"
#include "layer0_driver/descriptor_driver.hpp"
#include "layer0_driver/local_line.hpp"

namespace unitylink {
namespace {

std::uint64_t time_of_boards() noexcept { return RobotTime::here().now_ns(); }

// A link to a virtual board in this process. It uses the time of the boards.
class LocalDriver final : public DescriptorDriver {
 public:
  using DescriptorDriver::DescriptorDriver;
  [[nodiscard]] TimeSource time_source() const noexcept override { return &time_of_boards; }
};

// The same without a descriptor: the board goes in steps, and the line is in memory.
class LocalLineDriver final : public Driver {
 public:
  explicit LocalLineDriver(std::shared_ptr<LocalLine> line) noexcept : line_(std::move(line)) {}
  ~LocalLineDriver() override { LocalLineDriver::close(); }

  [[nodiscard]] Transfer send(std::span<const std::uint8_t> bytes) noexcept override {
    return noted(line_->send(LocalLine::link, bytes));
  }
  [[nodiscard]] Transfer receive(std::span<std::uint8_t> room) noexcept override {
    return noted(line_->receive(LocalLine::link, room));
  }
  void close() noexcept override {
    if (ours_) {
      line_->close(LocalLine::link);
    }
  }
  void disown() noexcept override { ours_ = false; }
  [[nodiscard]] int descriptor() const noexcept override { return -1; }
  [[nodiscard]] TimeSource time_source() const noexcept override { return &time_of_boards; }
  [[nodiscard]] LocalLine* local_line() noexcept override { return ours_ ? line_.get() : nullptr; }
  [[nodiscard]] std::string reason() const override {
    return cut_ ? "the other side closed the connection" : "closed by this program";
  }

 private:
  Transfer noted(Transfer transfer) noexcept {
    cut_ = cut_ || transfer.status == Status::closed;
    return transfer;
  }

  std::shared_ptr<LocalLine> line_;
  std::atomic<bool> cut_ = false;
  bool ours_ = true;  // false in a forked child: its copy of the line leads nowhere, and may be locked for ever
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
  if (std::shared_ptr<LocalLine> line = LocalLine::claim(descriptor); line != nullptr) {
    const Descriptor ticket(descriptor);
    driver = std::make_unique<LocalLineDriver>(std::move(line));
  } else if (made_here(descriptor)) {
    driver = std::make_unique<LocalDriver>(descriptor);
  } else {
    driver = std::make_unique<DescriptorDriver>(descriptor);
  }
  return {};
}

}  // namespace unitylink
