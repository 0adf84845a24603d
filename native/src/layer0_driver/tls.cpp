// SPDX-License-Identifier: BSD-3-Clause
#include "layer0_driver/tls.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <cerrno>
#include <cstring>
#include <sys/socket.h>
#include <unistd.h>

namespace unitylink::tls {
namespace {

constexpr std::size_t chunk = 16384;  // read from the socket at once

// OpenSSL would ask at the terminal for the password of a key.
int no_password(char*, int, int, void*) noexcept { return 0; }

bool is_number(const std::string& host) noexcept {
  std::array<std::uint8_t, sizeof(in6_addr)> room;
  return ::inet_pton(AF_INET, host.c_str(), room.data()) == 1 || ::inet_pton(AF_INET6, host.c_str(), room.data()) == 1;
}

}  // namespace

// ---- a side

Side::Side(const Library& library, Role role)
    : library_(library),
      role_(role),
      context_(library.context_new(role == Role::server ? library.server_method() : library.client_method())) {}

Side::~Side() { library_.context_free(context_); }

Outcome Side::make(Role role, const Files& files, std::shared_ptr<const Side>& side) {
  Outcome outcome;
  const Library* const library = Library::load(outcome);
  if (library == nullptr) {
    return outcome;
  }
  const auto made = std::make_shared<Side>(*library, role);
  outcome = made->use(files);
  if (outcome.ok()) {
    side = made;
  }
  return outcome;
}

Outcome Side::failed(const std::string& file, const char* remedy) const {
  const char* why = library_.error_text(library_.last_error());
  library_.clear_errors();
  if (::access(file.c_str(), R_OK) != 0) {  // OpenSSL calls this "system lib"
    why = std::strerror(errno);
  }
  return {Status::not_found, file + ": " + (why != nullptr ? why : "it cannot be used") + "; " + remedy};
}

Outcome Side::use(const Files& files) {
  if (context_ == nullptr) {
    return {Status::closed, "OpenSSL cannot begin"};
  }
  library_.clear_errors();
  library_.context_ctrl(context_, ctrl_min_version, version_1_3, nullptr);
  library_.context_ctrl(context_, ctrl_mode, mode_release_buffers, nullptr);
  library_.context_ctrl(context_, ctrl_session_cache_mode, 0, nullptr);
  library_.context_set_tickets(context_, 0);
  library_.context_set_password(context_, &no_password);
  const std::string& key = files.key.empty() ? files.certificate : files.key;
  if (!files.certificate.empty()) {
    if (library_.context_use_chain(context_, files.certificate.c_str()) != 1) {
      return failed(files.certificate, "expected a certificate in the format PEM");
    }
    if (library_.context_use_key(context_, key.c_str(), file_pem) != 1) {
      return failed(key, "expected the key of the certificate, in the format PEM and without a password");
    }
    if (library_.context_check_key(context_) != 1) {
      return failed(key, "it is not the key of the certificate");
    }
  }
  if (files.authorities == "system") {
    library_.context_trust_system(context_);
  } else if (!files.authorities.empty() && library_.context_trust(context_, files.authorities.c_str(), nullptr) != 1) {
    return failed(files.authorities, "expected the certificates of who signs, in the format PEM");
  }
  if (!files.authorities.empty()) {
    library_.context_verify(context_, verify_peer | verify_required, nullptr);
  }
  return {};
}

// ---- a session

Session::Session(std::shared_ptr<const Side> side, int socket, const std::string& host)
    : side_(std::move(side)), library_(side_->library_), socket_(socket), ssl_(library_.ssl_new(side_->context_)) {
  in_ = library_.bio_new(library_.bio_memory());
  encrypted_ = library_.bio_new(library_.bio_memory());
  if (ssl_ == nullptr || in_ == nullptr || encrypted_ == nullptr) {
    ended_ = true;
    return;
  }
  library_.ssl_set_bio(ssl_, in_, encrypted_);
  if (side_->role_ == Role::server) {
    library_.ssl_accepts(ssl_);
    return;
  }
  library_.ssl_connects(ssl_);
  if (is_number(host)) {
    ended_ = library_.verify_set_ip(library_.ssl_verify(ssl_), host.c_str()) != 1;
  } else {
    ended_ = library_.ssl_set_host(ssl_, host.c_str()) != 1;
    library_.ssl_ctrl(ssl_, ctrl_set_host_name, 0, const_cast<char*>(host.c_str()));
  }
}

Session::~Session() { library_.ssl_free(ssl_); }

Progress Session::shake() noexcept {
  while (!ended_) {
    library_.clear_errors();
    const int result = library_.ssl_shake(ssl_);
    const int error = result == 1 ? 0 : library_.ssl_error(ssl_, result);
    if (result != 1 && error != error_wants_read && error != error_wants_write) {
      static_cast<void>(failed());
    }
    collect();  // also the alert about a failure
    if (!flush() || ended_) {
      break;
    }
    if (unsent()) {
      return Progress::writes;
    }
    if (result == 1) {
      return Progress::done;
    }
    if (!fill()) {
      return ended_ ? Progress::failed : Progress::reads;
    }
  }
  return Progress::failed;
}

Transfer Session::receive(std::span<std::uint8_t> room) noexcept {
  if (ended_ || !flush()) {
    return {0, Status::closed};
  }
  std::size_t count = 0;
  static_cast<void>(fill());
  library_.clear_errors();
  while (count < room.size()) {
    const int most = static_cast<int>(std::min<std::size_t>(room.size() - count, chunk));
    const int got = library_.ssl_read(ssl_, room.data() + count, most);
    if (got > 0) {
      count += static_cast<std::size_t>(got);
      continue;
    }
    const int error = library_.ssl_error(ssl_, got);
    if (error != error_wants_read && error != error_wants_write) {
      orderly_ = error == error_end;
      static_cast<void>(failed());
    }
    break;
  }
  collect();  // a key update is answered
  static_cast<void>(flush());
  return ended_ && count == 0 ? Transfer{0, Status::closed} : Transfer{count, Status::ok};
}

Transfer Session::send(std::span<const std::uint8_t> bytes) noexcept {
  if (ended_ || !flush()) {
    return {0, Status::closed};
  }
  if (unsent() || bytes.empty()) {
    return {};
  }
  library_.clear_errors();
  const int most = static_cast<int>(std::min<std::size_t>(bytes.size(), 1u << 20));
  const int count = library_.ssl_write(ssl_, bytes.data(), most);
  if (count <= 0) {
    return failed();
  }
  collect();
  return flush() ? Transfer{static_cast<std::size_t>(count), Status::ok} : Transfer{0, Status::closed};
}

void Session::end() noexcept {
  if (!ended_ && flush() && !unsent()) {
    library_.clear_errors();
    static_cast<void>(library_.ssl_shutdown(ssl_));
    collect();
    static_cast<void>(flush());
  }
  ended_ = true;
}

// Moves the ciphertext that OpenSSL has made to what is to be sent.
void Session::collect() noexcept {
  std::array<std::uint8_t, 4096> room;
  for (int got = 0; (got = library_.bio_read(encrypted_, room.data(), static_cast<int>(room.size()))) > 0;) {
    try {
      out_.insert(out_.end(), room.data(), room.data() + got);
    } catch (const std::bad_alloc&) {
      ended_ = true;
      return;
    }
  }
}

// Sends what waits. False: the connection has ended.
bool Session::flush() noexcept {
  while (unsent()) {
    const ssize_t count = ::send(socket_, out_.data() + sent_, out_.size() - sent_, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count < 0) {
      if (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR || errno == ENOBUFS) {
        return true;
      }
      error_ = errno;
      ended_ = true;
      return false;
    }
    sent_ += static_cast<std::size_t>(count);
  }
  out_.clear();
  sent_ = 0;
  return true;
}

// Reads ciphertext from the socket. False: none came now, or the connection has ended.
bool Session::fill() noexcept {
  std::array<std::uint8_t, chunk> room;
  const ssize_t count = ::recv(socket_, room.data(), room.size(), MSG_DONTWAIT);
  if (count > 0) {
    return library_.bio_write(in_, room.data(), static_cast<int>(count)) == count;
  }
  if (count == 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)) {
    error_ = count == 0 ? 0 : errno;
    ended_ = true;
  }
  return false;
}

Transfer Session::failed() noexcept {
  ended_ = true;
  if (told_.empty() && !orderly_) {
    const char* const why = library_.error_text(library_.last_error());
    try {
      told_ = why != nullptr ? why : "";
    } catch (const std::bad_alloc&) {  // then without the text
    }
  }
  return {0, Status::closed};
}

bool Session::distrusted() const noexcept { return ssl_ != nullptr && library_.ssl_verified(ssl_) != 0; }

std::string Session::reason() const {
  if (distrusted()) {
    return std::string("its certificate is not trusted: ") + library_.verify_text(library_.ssl_verified(ssl_));
  }
  return !told_.empty() ? "TLS has failed: " + told_
         : error_ != 0  ? std::strerror(error_)
                        : "the other side closed the connection";
}

std::string Session::peer() const {
  X509* const certificate = library_.ssl_peer(ssl_);
  if (certificate == nullptr) {
    return {};
  }
  std::array<char, 65> room{};
  const int size = library_.name_text(library_.x509_subject(certificate), nid_common_name, room.data(),
                                      static_cast<int>(room.size()));
  library_.x509_free(certificate);
  return size > 0 ? std::string(room.data(), static_cast<std::size_t>(size)) : std::string("?");
}

}  // namespace unitylink::tls
