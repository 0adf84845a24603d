// SPDX-License-Identifier: BSD-3-Clause
// An endpoint that looks like a serial port: the master side of a pseudo-terminal.
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <termios.h>
#include <utility>

#include "device/endpoints.hpp"

namespace unitylink::device {

namespace {

// The lock of the serial driver keeps a second program out. A terminal cannot answer it.
class TerminalEndpoint final : public Endpoint {
 public:
  explicit TerminalEndpoint(const std::string& path)
      : master_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
    char name[128];
    if (!master_.open() || ::grantpt(master_.get()) != 0 || ::unlockpt(master_.get()) != 0 ||
        ::ptsname_r(master_.get(), name, sizeof name) != 0) {
      throw EndpointError(std::string("pseudo-terminal: ") + std::strerror(errno));
    }
    const Descriptor slave(::open(name, O_RDWR | O_NOCTTY | O_CLOEXEC));
    termios settings{};
    if (!slave.open() || ::tcgetattr(slave.get(), &settings) != 0) {
      throw EndpointError(std::string(name) + ": " + std::strerror(errno));
    }
    ::cfmakeraw(&settings);  // so that even a client that sets nothing gets its bytes unchanged
    ::tcsetattr(slave.get(), TCSANOW, &settings);
    path_ = name;
    if (!path.empty()) {
      link(path);
    }
  }

  ~TerminalEndpoint() override {
    if (!link_.empty()) {
      ::unlink(link_.c_str());
    }
  }

  std::string url() override { return "serial:" + path_; }
  [[nodiscard]] bool has_client() const noexcept override { return open_; }
  [[nodiscard]] int client() const noexcept override { return open_ ? master_.get() : -1; }
  [[nodiscard]] bool must_look() const noexcept override { return !open_; }

  bool admit(bool) override {
    if (open_) {
      return false;
    }
    pollfd state{master_.get(), POLLIN, 0};
    open_ = ::poll(&state, 1, 0) == 0 || (state.revents & POLLIN) != 0 || (state.revents & POLLHUP) == 0;
    return open_;
  }

  Transfer receive(std::span<std::uint8_t> room) override {
    return outcome(::read(master_.get(), room.data(), room.size()));
  }

  Transfer send(std::span<const std::uint8_t> bytes) override {
    return outcome(::write(master_.get(), bytes.data(), bytes.size()));
  }

 private:
  Transfer outcome(ssize_t count) {
    if (count > 0) {
      return {Result::done, static_cast<std::size_t>(count)};
    }
    if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) {
      return {Result::nothing, 0};
    }
    open_ = false;                        // EIO: no program has the other side open
    ::tcflush(master_.get(), TCIOFLUSH);  // bytes that the last client did not read are not for the next
    return {Result::gone, 0};
  }

  void link(const std::string& path) {
    if (::symlink(path_.c_str(), path.c_str()) != 0) {
      throw EndpointError("pty:" + path + ": " + std::strerror(errno));
    }
    link_ = path_ = path;
  }

  Descriptor master_;
  std::string path_;
  std::string link_;
  bool open_ = false;
};

// Whether the terminal behind a link is newer than the link. Then the board's terminal is gone, and another one got its
// number.
bool younger(const struct stat& terminal, const struct stat& link) {
  return S_ISCHR(terminal.st_mode) && std::pair(terminal.st_ctim.tv_sec, terminal.st_ctim.tv_nsec) >
                                          std::pair(link.st_ctim.tv_sec, link.st_ctim.tv_nsec);
}

// A board that was killed leaves a link to a terminal that is gone. The next terminal may get the same number.
void make_way(const std::string& path) {
  struct stat link{}, target{};
  if (::lstat(path.c_str(), &link) == 0) {
    if (!S_ISLNK(link.st_mode)) {
      throw EndpointError("pty:" + path + ": the file exists; choose another name or remove it");
    }
    if (::stat(path.c_str(), &target) == 0 && !younger(target, link)) {
      throw EndpointError("pty:" + path + ": a link to what is in use; choose another name or remove it");
    }
    ::unlink(path.c_str());
  }
}

}  // namespace

std::unique_ptr<Endpoint> make_terminal_endpoint(const std::string& path) {
  if (!path.empty()) {
    make_way(path);
  }
  return std::make_unique<TerminalEndpoint>(path);
}

}  // namespace unitylink::device
