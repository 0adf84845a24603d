// SPDX-License-Identifier: BSD-3-Clause
#include "server/conversation.hpp"

#include <vector>

#include "layer0_driver/polling.hpp"
#include "layer0_driver/robot_time.hpp"

namespace unitylink::server {

bool Conversation::ready(short what, std::uint64_t until_ns) const noexcept {
  pollfd waiting{connection_.get(), what, 0};
  const std::uint64_t now = real_ns();
  return now < until_ns && poll_for(std::span(&waiting, 1), until_ns - now) > 0;
}

std::optional<std::string> Conversation::read_line(std::uint64_t timeout_ns, std::size_t most) {
  const std::uint64_t until_ns = real_ns() + timeout_ns;
  std::vector<std::uint8_t> room(tls::Session::all_bytes);
  std::string line;
  while (line.find('\n') == std::string::npos) {
    if (line.size() > most || !ready(POLLIN, until_ns)) {
      return std::nullopt;
    }
    const Transfer transfer = connection_.receive(room);
    if (transfer.status != Status::ok) {
      return std::nullopt;
    }
    line.append(reinterpret_cast<const char*>(room.data()), transfer.count);
  }
  line.resize(line.find('\n'));
  return line.size() > most ? std::nullopt : std::optional(line);
}

bool Conversation::write(std::string_view text, std::uint64_t timeout_ns) {
  const std::uint64_t until_ns = real_ns() + timeout_ns;
  std::span<const std::uint8_t> left(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  while (!left.empty() || connection_.unsent()) {
    const Transfer transfer = connection_.send(left);
    if (transfer.status != Status::ok) {
      return false;
    }
    left = left.subspan(transfer.count);
    if ((transfer.count == 0 || connection_.unsent()) && !ready(POLLOUT, until_ns)) {
      return left.empty() && !connection_.unsent();
    }
  }
  return true;
}

}  // namespace unitylink::server
