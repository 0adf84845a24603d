// SPDX-License-Identifier: BSD-3-Clause
// TLS 1.3 over a connected socket, by OpenSSL. No call blocks.
//
// OpenSSL sees memory only. The bytes of the socket are moved here, by send() with MSG_NOSIGNAL, because OpenSSL's own
// writing would end a C program with SIGPIPE.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "layer0_driver/driver.hpp"
#include "layer0_driver/status.hpp"
#include "layer0_driver/tls_library.hpp"

namespace unitylink::tls {

// Files in the format PEM.
struct Files {
  std::string certificate;  // one's own, and those up to its CA. Empty: none (a client's)
  std::string key;          // empty: in the file of the certificate
  std::string authorities;  // who has signed the other side's. "system": those that this machine trusts
};

enum class Role : std::uint8_t { server, client };

// What all connections of one side have in common.
class Side {
 public:
  // A server needs a certificate. With `authorities` it refuses clients that show none of theirs. A client needs
  // `authorities`. not_found: a file is missing or wrong, or OpenSSL is.
  [[nodiscard]] static Outcome make(Role role, const Files& files, std::shared_ptr<const Side>& side);
  Side(const Library& library, Role role);
  Side(const Side&) = delete;
  Side& operator=(const Side&) = delete;
  ~Side();

 private:
  friend class Session;
  [[nodiscard]] Outcome use(const Files& files);
  [[nodiscard]] Outcome failed(const std::string& file, const char* remedy) const;

  const Library& library_;
  const Role role_;
  Context* context_;
};

enum class Progress : std::uint8_t { done, reads, writes, failed };

class Session {
 public:
  // The socket is non-blocking, and stays the caller's. A client names the host whose certificate it expects.
  Session(std::shared_ptr<const Side> side, int socket, const std::string& host = {});
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  ~Session();

  // Goes on with the handshake, until it is done or needs the socket to be readable or writable.
  [[nodiscard]] Progress shake() noexcept;
  // A room of `all_bytes` takes all that has arrived. With a smaller one, call it again until nothing comes.
  static constexpr std::size_t all_bytes = 65536;
  [[nodiscard]] Transfer receive(std::span<std::uint8_t> room) noexcept;
  // Takes all bytes or none. What the socket does not take now is kept: see unsent().
  [[nodiscard]] Transfer send(std::span<const std::uint8_t> bytes) noexcept;
  // Bytes are kept that the socket did not take. The next send() or receive() sends them first.
  [[nodiscard]] bool unsent() const noexcept { return sent_ < out_.size(); }
  // Says that no more bytes come.
  void end() noexcept;
  // The common name of the other side's certificate; empty: it showed none.
  [[nodiscard]] std::string peer() const;
  // Why a call has failed, in words.
  [[nodiscard]] std::string reason() const;
  // The other side's certificate was not accepted.
  [[nodiscard]] bool distrusted() const noexcept;

 private:
  [[nodiscard]] bool flush() noexcept;
  [[nodiscard]] bool fill() noexcept;
  void collect() noexcept;
  [[nodiscard]] Transfer failed() noexcept;

  const std::shared_ptr<const Side> side_;
  const Library& library_;
  const int socket_;
  Ssl* ssl_ = nullptr;
  Bio* in_ = nullptr;         // ciphertext that has arrived; the session owns it
  Bio* encrypted_ = nullptr;  // ciphertext to send, which collect() moves into out_
  std::vector<std::uint8_t> out_;
  std::size_t sent_ = 0;
  bool ended_ = false;    // the connection has ended, or is broken
  bool orderly_ = false;  // the other side has said so
  int error_ = 0;         // errno of the socket
  std::string told_;      // OpenSSL's text about the first failure
};

}  // namespace unitylink::tls
