// SPDX-License-Identifier: BSD-3-Clause
// A client that has a question, and sends no frames: lines in and out, each within a time.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "server/connection.hpp"

namespace unitylink::server {

class Conversation {
 public:
  explicit Conversation(Connection connection) : connection_(std::move(connection)) {}

  // A line without its end. Empty: none came in time, or it is longer than `most`.
  [[nodiscard]] std::optional<std::string> read_line(std::uint64_t timeout_ns, std::size_t most);
  // False: the client has not taken all in time, or is gone.
  bool write(std::string_view text, std::uint64_t timeout_ns);
  void end() noexcept { connection_.end(); }

 private:
  [[nodiscard]] bool ready(short what, std::uint64_t until_ns) const noexcept;

  Connection connection_;
};

}  // namespace unitylink::server
