// SPDX-License-Identifier: BSD-3-Clause
// The connection to a client: a socket, with TLS over it or without.
#pragma once

#include <cerrno>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <sys/socket.h>
#include <utility>

#include "layer0_driver/descriptor.hpp"
#include "layer0_driver/driver.hpp"
#include "layer0_driver/tls.hpp"

namespace unitylink::server {

class Connection {
 public:
  Connection() = default;
  explicit Connection(Descriptor socket, std::unique_ptr<tls::Session> over = nullptr)
      : socket_(std::move(socket)), tls_(std::move(over)) {}
  Connection(Connection&&) = default;
  Connection& operator=(Connection&& other) noexcept {
    end();
    socket_ = std::move(other.socket_);
    tls_ = std::move(other.tls_);
    return *this;
  }
  ~Connection() { end(); }

  [[nodiscard]] int get() const noexcept { return socket_.get(); }
  [[nodiscard]] bool open() const noexcept { return socket_.open(); }
  [[nodiscard]] tls::Session* tls() const noexcept { return tls_.get(); }
  // A room of tls::Session::all_bytes takes all that TLS has decrypted, so that the socket tells when there is more.
  [[nodiscard]] Transfer receive(std::span<std::uint8_t> room) noexcept {
    if (tls_) {
      return tls_->receive(room);
    }
    const ssize_t count = ::recv(socket_.get(), room.data(), room.size(), MSG_DONTWAIT);
    return count == 0 ? Transfer{0, Status::closed} : moved(count);
  }
  [[nodiscard]] Transfer send(std::span<const std::uint8_t> bytes) noexcept {
    return tls_ ? tls_->send(bytes)
                : moved(::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT));
  }
  // Bytes that send() has taken wait for the socket.
  [[nodiscard]] bool unsent() const noexcept { return tls_ && tls_->unsent(); }
  void end() noexcept {
    if (tls_) {
      tls_->end();
      tls_.reset();
    }
    socket_.reset();
  }

 private:
  [[nodiscard]] static Transfer moved(ssize_t count) noexcept {
    if (count >= 0) {
      return {static_cast<std::size_t>(count), Status::ok};
    }
    const bool later = errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
    return {0, later ? Status::ok : Status::closed};
  }

  Descriptor socket_;
  std::unique_ptr<tls::Session> tls_;
};

}  // namespace unitylink::server
