// SPDX-License-Identifier: BSD-3-Clause
// The kinds of endpoint, and their common parts.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "device/endpoint.hpp"
#include "layer0_driver/descriptor.hpp"

namespace unitylink::device {

inline constexpr std::string_view busy_line = "?busy\n";

// A client behind a stream socket.
class StreamEndpoint : public Endpoint {
 public:
  [[nodiscard]] bool has_client() const noexcept override { return client_.open(); }
  [[nodiscard]] int client() const noexcept override { return client_.get(); }
  void dismiss() override { client_.reset(); }
  Transfer receive(std::span<std::uint8_t> room) override;
  Transfer send(std::span<const std::uint8_t> bytes) override;

 protected:
  // False when the client has closed its side.
  [[nodiscard]] bool client_lives() const noexcept;
  Descriptor client_;
};

std::unique_ptr<Endpoint> make_descriptor_endpoint();
std::unique_ptr<Endpoint> make_local_endpoint();
std::unique_ptr<Endpoint> make_terminal_endpoint(const std::string& path);
std::unique_ptr<Endpoint> make_tcp_endpoint(const std::string& bind, std::uint16_t port);
std::unique_ptr<Endpoint> make_udp_endpoint(const std::string& bind, std::uint16_t port);

}  // namespace unitylink::device
