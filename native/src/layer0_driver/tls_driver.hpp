// SPDX-License-Identifier: BSD-3-Clause
// A byte pipe with TLS over another one, which is a connected socket.
#pragma once

#include <memory>
#include <mutex>

#include "layer0_driver/driver.hpp"
#include "layer0_driver/tls.hpp"

namespace unitylink::tls {

// What the socket does not take is sent with the next call. As a client of a server has few requests under way, the
// socket takes all in practice.
class TlsDriver final : public Driver {
 public:
  TlsDriver(std::unique_ptr<Driver> socket, std::shared_ptr<const Side> side, const std::string& host)
      : socket_(std::move(socket)), session_(std::move(side), socket_->descriptor(), host) {}
  ~TlsDriver() override { TlsDriver::close(); }

  [[nodiscard]] Progress shake() noexcept { return session_.shake(); }
  [[nodiscard]] bool distrusted() const noexcept { return session_.distrusted(); }

  [[nodiscard]] Transfer send(std::span<const std::uint8_t> bytes) noexcept override {
    const std::scoped_lock lock(mutex_);
    return session_.send(bytes);
  }
  [[nodiscard]] Transfer receive(std::span<std::uint8_t> room) noexcept override {
    const std::scoped_lock lock(mutex_);
    return session_.receive(room);
  }
  void close() noexcept override {
    const std::scoped_lock lock(mutex_);
    session_.end();
    socket_->close();
  }
  void disown() noexcept override { socket_->disown(); }
  [[nodiscard]] int descriptor() const noexcept override { return socket_->descriptor(); }
  [[nodiscard]] std::string reason() const override {
    const std::scoped_lock lock(mutex_);
    return session_.reason();
  }

 private:
  mutable std::mutex mutex_;  // one thread may send while another receives
  std::unique_ptr<Driver> socket_;
  Session session_;
};

}  // namespace unitylink::tls
