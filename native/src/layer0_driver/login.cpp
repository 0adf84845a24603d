// SPDX-License-Identifier: BSD-3-Clause
#include "layer0_driver/login.hpp"

#include <algorithm>
#include <charconv>

#include "unitylink/protocol.hpp"

namespace unitylink {
namespace {

constexpr std::string_view none = "-";

// Cuts the first word off. Words have exactly one space between them.
std::string_view next_word(std::string_view& line) noexcept {
  const std::size_t end = std::min(line.find(' '), line.size());
  const std::string_view word = line.substr(0, end);
  line.remove_prefix(std::min(end + 1, line.size()));
  return word;
}

bool word_or_none(std::string_view text, std::string& into) {
  if (text != none && !is_word(text)) {
    return false;
  }
  into = text == none ? std::string_view{} : text;
  return true;
}

std::string_view shown(const std::string& word) noexcept { return word.empty() ? none : std::string_view(word); }

}  // namespace

bool is_word(std::string_view text) noexcept {
  return !text.empty() && text != none &&
         std::all_of(text.begin(), text.end(), [](char character) { return character > ' ' && character < 0x7F; });
}

std::string Login::line() const {
  std::string text(protocol::serve::greeting);
  return text.append(" ")
             .append(std::to_string(version))
             .append(" ")
             .append(shown(board))
             .append(" ")
             .append(shown(token))
             .append(asks ? " " : "")
             .append(asks ? protocol::serve::asking : "") +
         "\n";
}

std::optional<Login> Login::parse(std::string_view line) {
  if (line.size() >= protocol::serve::login_max || next_word(line) != protocol::serve::greeting) {
    return std::nullopt;
  }
  Login login;
  const std::string_view version = next_word(line);
  const auto [end, error] = std::from_chars(version.data(), version.data() + version.size(), login.version);
  if (version.empty() || error != std::errc{} || end != version.data() + version.size()) {
    return std::nullopt;
  }
  if (!word_or_none(next_word(line), login.board) || !word_or_none(next_word(line), login.token)) {
    return std::nullopt;
  }
  login.asks = line == protocol::serve::asking;
  if (!line.empty() && !login.asks) {
    return std::nullopt;
  }
  return login;
}

std::string LoginAnswer::line() const {
  std::string made(reason.empty() ? protocol::serve::admitted : protocol::serve::refused);
  made += reason.empty() ? "" : " " + reason;
  made += " ";
  for (const char character : text) {
    if (made.size() + 1 < protocol::serve::login_max) {
      made += character >= ' ' ? character : ' ';
    }
  }
  return made + "\n";
}

std::optional<LoginAnswer> LoginAnswer::parse(std::string_view line) {
  const std::string_view first = next_word(line);
  LoginAnswer answer;
  if (first == protocol::serve::refused) {
    answer.reason = next_word(line);
    if (!is_word(answer.reason)) {
      return std::nullopt;
    }
  } else if (first != protocol::serve::admitted) {
    return std::nullopt;
  }
  answer.text = line;
  return answer;
}

}  // namespace unitylink
