// SPDX-License-Identifier: BSD-3-Clause
#include "device/endpoint.hpp"

#include <charconv>

#include "device/endpoints.hpp"

namespace unitylink::device {

namespace {

std::uint16_t port_number(const std::string& kind, const std::string& text) {
  std::uint16_t port = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (!text.empty() && (error != std::errc() || end != text.data() + text.size())) {
    throw EndpointError("endpoint '" + kind + "': '" + text +
                        "' is not a port; give 1 to 65535, or none to have one chosen");
  }
  return port;
}

}  // namespace

std::unique_ptr<Endpoint> make_endpoint(const std::string& kind, const std::string& bind) {
  const std::size_t colon = kind.find(':');
  const std::string name = kind.substr(0, colon);
  const std::string rest = colon == std::string::npos ? std::string() : kind.substr(colon + 1);
  if (name == "fd" && colon == std::string::npos) {
    return make_descriptor_endpoint();
  }
  if (name == "lockstep" && colon == std::string::npos) {
    return make_local_endpoint();
  }
  if (name == "pty") {
    return make_terminal_endpoint(rest);
  }
  if (name == "tcp") {
    return make_tcp_endpoint(bind, port_number(kind, rest));
  }
  if (name == "udp") {
    return make_udp_endpoint(bind, port_number(kind, rest));
  }
  throw EndpointError("endpoint '" + kind +
                      "' is not known; choose fd, lockstep, pty, pty:PATH, tcp, tcp:PORT, udp or udp:PORT");
}

}  // namespace unitylink::device
