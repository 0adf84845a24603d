// SPDX-License-Identifier: BSD-3-Clause
// serve://HOST:PORT/BOARD is a board behind `unitylink serve`. It is TCP, with a login at its beginning. The token is
// in a file (token_file=) or in UNITYLINK_TOKEN, never in the URL, because URLs are printed. With tls_ca= all of it is
// encrypted, and the server shows a certificate; with tls_cert= (and tls_key=) the client shows its own.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>

#include "layer0_driver/driver.hpp"
#include "layer0_driver/login.hpp"
#include "layer0_driver/polling.hpp"
#include "layer0_driver/serve_question.hpp"
#include "layer0_driver/tls_driver.hpp"
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

// Puts TLS over the connection, if the URL wants it.
Outcome encrypt(const Url& url, int cancelled, std::uint64_t until_ns, std::unique_ptr<Driver>& driver) {
  const auto option = [&](const char* name) { return url.option(name) ? *url.option(name) : std::string(); };
  const tls::Files files{.certificate = option("tls_cert"), .key = option("tls_key"), .authorities = option("tls_ca")};
  if (files.authorities.empty()) {
    return files.certificate.empty() && files.key.empty()
               ? Outcome{}
               : wrong_url(url, "tls_cert and tls_key need tls_ca=FILE, the certificate that has signed the server's");
  }
  if (files.certificate.empty() && !files.key.empty()) {
    return wrong_url(url, "tls_key needs tls_cert=FILE, the certificate of this key");
  }
  std::shared_ptr<const tls::Side> side;
  if (Outcome outcome = tls::Side::make(tls::Role::client, files, side); !outcome.ok()) {
    return {outcome.status, place_of(url) + ": " + outcome.text};
  }
  auto over = std::make_unique<tls::TlsDriver>(std::move(driver), std::move(side), url.host);
  while (true) {
    const tls::Progress progress = over->shake();
    if (progress == tls::Progress::done) {
      driver = std::move(over);
      return {};
    }
    if (progress == tls::Progress::failed) {
      return {over->distrusted() ? Status::mismatch : Status::closed,
              place_of(url) + ": " + over->reason() +
                  (over->distrusted() ? "; is tls_ca= right, and the name of the host?"
                                      : "; does the server have --tls-cert?")};
    }
    if (!ready(over->descriptor(), progress == tls::Progress::reads ? POLLIN : POLLOUT, cancelled, until_ns)) {
      return {Status::timeout, place_of(url) + ": TLS does not begin; does the server have --tls-cert?"};
    }
  }
}

// Sends all of a text. False: not in time, or the connection has ended.
bool say(Driver& driver, std::string_view text, int cancelled, std::uint64_t until_ns) noexcept {
  for (std::size_t sent = 0; sent < text.size();) {
    const Transfer transfer =
        driver.send(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()).subspan(sent));
    sent += transfer.count;
    if (transfer.status != Status::ok ||
        (transfer.count == 0 && !ready(driver.descriptor(), POLLOUT, cancelled, until_ns))) {
      return false;
    }
  }
  return true;
}

// Connects and logs in. Errors: see open_serve().
Outcome log_in(const Url& url, const Patience& patience, bool asks, std::uint64_t until_ns,
               std::unique_ptr<Driver>& driver) {
  Login login{.version = protocol::serve::version, .board = url.path, .token = {}, .asks = asks};
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
  std::unique_ptr<Driver> opened;
  if (Outcome outcome = open_socket(url, patience, opened); !outcome.ok()) {
    return outcome;
  }
  if (Outcome outcome = encrypt(url, patience.cancelled, until_ns, opened); !outcome.ok()) {
    return outcome;
  }
  if (!say(*opened, line, patience.cancelled, until_ns)) {
    return {Status::timeout, place_of(url) + ": the server does not take the login"};
  }
  std::string answer;
  std::array<std::uint8_t, protocol::serve::login_max> room;
  while (answer.find('\n') == std::string::npos) {
    if (!ready(opened->descriptor(), POLLIN, patience.cancelled, until_ns)) {
      return {Status::timeout, place_of(url) + ": no answer to the login; is a `unitylink serve` there?"};
    }
    const Transfer transfer = opened->receive(std::span(room).first(room.size() - answer.size()));
    if (transfer.status != Status::ok) {
      return {Status::closed,
              place_of(url) + ": the server ended the connection during the login: " + opened->reason()};
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

}  // namespace

// Errors: those of tcp, and refused (the token is wrong), not_found (no such board), busy (too many clients),
// closed (the board is away), mismatch (no server, another version, or a certificate that is not trusted).
Outcome open_serve(const Url& url, const Patience& patience, std::unique_ptr<Driver>& driver) {
  return log_in(url, patience, false, real_ns() + patience.timeout_ns, driver);
}

Outcome ask_server(const Url& url, const Patience& patience, const std::string& question, std::string& answer) {
  const std::uint64_t until_ns = real_ns() + patience.timeout_ns;
  std::unique_ptr<Driver> driver;
  if (Outcome outcome = log_in(url, patience, true, until_ns, driver); !outcome.ok()) {
    return outcome;
  }
  if (!say(*driver, question + "\n", patience.cancelled, until_ns)) {
    return {Status::timeout, place_of(url) + ": the server does not take the question"};
  }
  answer.clear();
  std::vector<std::uint8_t> room(tls::Session::all_bytes);
  while (!answer.ends_with('\n')) {
    if (!ready(driver->descriptor(), POLLIN, patience.cancelled, until_ns)) {
      return {Status::timeout, place_of(url) + ": the server does not answer the question"};
    }
    const Transfer transfer = driver->receive(room);
    if (transfer.status != Status::ok) {
      return {Status::closed, place_of(url) + ": the server does not answer the question: " + driver->reason()};
    }
    answer.append(reinterpret_cast<const char*>(room.data()), transfer.count);
  }
  return {};
}

}  // namespace unitylink
