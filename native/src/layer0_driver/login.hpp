// SPDX-License-Identifier: BSD-3-Clause
// The login at `unitylink serve`: one line each way, before the framed protocol begins.
//   unitylink-serve 1 BOARD TOKEN [ask]   from the client; "-": none
//   admitted TEXT                         from the server
//   refused REASON TEXT
// With `ask` no frames follow, but one line with a question, and one with its answer, in JSON (serve_question.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace unitylink {

struct Login {
  std::uint32_t version = 0;
  std::string board;  // empty: the only one of the server
  std::string token;  // empty: none
  bool asks = false;  // it has a question about the board, and does not want to use it

  // The line, with its end. Board and token must be words (see is_word) or empty.
  [[nodiscard]] std::string line() const;
  // Takes a line without its end apart. Empty: it is no login.
  [[nodiscard]] static std::optional<Login> parse(std::string_view line);
};

struct LoginAnswer {
  std::string reason;  // empty: admitted; else version, token, board, away or full
  std::string text;    // for people

  // The line, with its end. What cannot stand in a line, or makes it too long, is left out.
  [[nodiscard]] std::string line() const;
  [[nodiscard]] static std::optional<LoginAnswer> parse(std::string_view line);
};

// Whether a text can stand in a line as one word: printable ASCII without spaces, not empty, not "-".
[[nodiscard]] bool is_word(std::string_view text) noexcept;

}  // namespace unitylink
