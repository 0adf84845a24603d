// SPDX-License-Identifier: BSD-3-Clause
// serve://HOST:PORT/BOARD is a board behind `unitylink serve`. It is TCP, with a login at its beginning. The token is
// in a file (token_file=) or in UNITYLINK_TOKEN, never in the URL, because URLs are printed.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>

#include "layer0_driver/driver.hpp"
#include "layer0_driver/login.hpp"
#include "layer0_driver/polling.hpp"
#include "unitylink/protocol.hpp"

namespace unitylink {

Opener open_socket;

namespace {

std::string place_of(const Url& url) {
  return "serve://" + url.host + ":" + url.port + (url.path.empty() ? "" : "/" + url.path);
}

Outcome find_token(const Url& url, std::string& token) {
  if (const std::string* const name = url.option("token_file"); name != nullptr) {
    std::ifstream file(*name);
    if (!std::getline(file, token) || !is_word(token)) {
      return {Status::not_found, place_of(url) + ": token_file=" + *name +
                                     " has no token: its first line must be the token, which is one word"};
    }
  } else if (const char* const given = std::getenv("UNITYLINK_TOKEN"); given != nullptr && *given != '\0') {
    token = given;
    if (!is_word(token)) {
      return {Status::refused, place_of(url) + ": UNITYLINK_TOKEN is not one word of printable characters"};
    }
  }
  return {};
}

Status status_of_refusal(std::string_view reason) noexcept {
  return reason == "token"   ? Status::refused
         : reason == "board" ? Status::not_found
         : reason == "away"  ? Status::closed
         : reason == "full"  ? Status::busy
                             : Status::mismatch;
}

// Waits until the descriptor can do `what`. False: not in time, or cancelled.
bool ready(int descriptor, short what, int cancelled, std::uint64_t until_ns) noexcept {
  pollfd waiting[2] = {{descriptor, what, 0}, {cancelled, POLLIN, 0}};
  const std::uint64_t now = real_ns();
  return now < until_ns && poll_for(waiting, until_ns - now) > 0 && waiting[1].revents == 0;
}

}  // namespace

// Errors: those of tcp, and refused (the token is wrong), not_found (no such board), busy (too many clients),
// closed (the board is away), mismatch (no server, or another version).
Outcome open_serve(const Url& url, const Patience& patience, std::unique_ptr<Driver>& driver) {
  Login login{.version = protocol::serve::version, .board = url.path, .token = {}};
  if (!url.path.empty() && !is_word(url.path)) {
    return wrong_url(url, "'" + url.path + "' is not the name of a board; see what `unitylink serve` has printed");
  }
  if (Outcome outcome = find_token(url, login.token); !outcome.ok()) {
    return outcome;
  }
  const std::string line = login.line();
  if (line.size() > protocol::serve::login_max) {
    return {Status::refused, place_of(url) + ": the token or the name of the board is too long"};
  }
  const std::uint64_t until_ns = real_ns() + patience.timeout_ns;
  std::unique_ptr<Driver> opened;
  if (Outcome outcome = open_socket(url, patience, opened); !outcome.ok()) {
    return outcome;
  }
  for (std::size_t sent = 0; sent < line.size();) {
    const Transfer transfer =
        opened->send(std::span(reinterpret_cast<const std::uint8_t*>(line.data()), line.size()).subspan(sent));
    sent += transfer.count;
    if (transfer.status != Status::ok ||
        (transfer.count == 0 && !ready(opened->descriptor(), POLLOUT, patience.cancelled, until_ns))) {
      return {Status::timeout, place_of(url) + ": the server does not take the login"};
    }
  }
  std::string answer;
  std::array<std::uint8_t, protocol::serve::login_max> room;
  while (answer.find('\n') == std::string::npos) {
    if (!ready(opened->descriptor(), POLLIN, patience.cancelled, until_ns)) {
      return {Status::timeout, place_of(url) + ": no answer to the login; is a `unitylink serve` there?"};
    }
    const Transfer transfer = opened->receive(std::span(room).first(room.size() - answer.size()));
    if (transfer.status != Status::ok) {
      return {Status::closed, place_of(url) + ": the server closed the connection during the login"};
    }
    answer.append(reinterpret_cast<const char*>(room.data()), transfer.count);
    if (answer.size() >= room.size() && answer.find('\n') == std::string::npos) {
      break;
    }
  }
  // Nothing follows the line until this side speaks.
  const std::size_t end = answer.find('\n');
  const auto told = end + 1 == answer.size() ? LoginAnswer::parse(std::string_view(answer).substr(0, end))
                                             : std::optional<LoginAnswer>();
  if (!told) {
    return {Status::mismatch, place_of(url) + ": what listens there is no `unitylink serve`"};
  }
  if (!told->reason.empty()) {
    return {status_of_refusal(told->reason), place_of(url) + ": " + told->text};
  }
  driver = std::move(opened);
  return {};
}

}  // namespace unitylink
