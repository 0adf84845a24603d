// SPDX-License-Identifier: BSD-3-Clause
// OpenSSL 1.1.1 or 3, as the operating system has it. It is loaded only for a connection with TLS, so nobody else needs
// it, and its updates reach us without a new release. Its ABI is stable, so this file declares what we use of it. The
// environment variable UNITYLINK_LIBSSL names another file to load.
#pragma once

#include "layer0_driver/status.hpp"

namespace unitylink::tls {

struct Context;    // SSL_CTX
struct Ssl;        // SSL
struct Method;     // SSL_METHOD
struct Bio;        // BIO
struct BioMethod;  // BIO_METHOD
struct Verify;     // X509_VERIFY_PARAM
struct X509;       // X509
struct Name;       // X509_NAME

// Of OpenSSL's headers.
inline constexpr int version_1_3 = 0x0304;
inline constexpr int file_pem = 1;
inline constexpr int verify_peer = 1;
inline constexpr int verify_required = 2;  // also refuses a client without a certificate
inline constexpr int ctrl_set_host_name = 55;
inline constexpr int ctrl_mode = 33;
inline constexpr int ctrl_session_cache_mode = 44;
inline constexpr int ctrl_min_version = 123;
inline constexpr long mode_release_buffers = 0x10;
inline constexpr int error_wants_read = 2;
inline constexpr int error_wants_write = 3;
inline constexpr int error_end = 6;  // the other side has said that it ends
inline constexpr int nid_common_name = 13;

struct Library {
  // The library, loaded once and then kept, because OpenSSL must not be unloaded. nullptr: `outcome` says what is
  // missing, and how to install it.
  [[nodiscard]] static const Library* load(Outcome& outcome);

  const Method* (*server_method)() = nullptr;
  const Method* (*client_method)() = nullptr;
  Context* (*context_new)(const Method*) = nullptr;
  void (*context_free)(Context*) = nullptr;
  long (*context_ctrl)(Context*, int, long, void*) = nullptr;
  int (*context_set_tickets)(Context*, std::size_t) = nullptr;
  void (*context_set_password)(Context*, int (*)(char*, int, int, void*)) = nullptr;
  int (*context_use_chain)(Context*, const char*) = nullptr;
  int (*context_use_key)(Context*, const char*, int) = nullptr;
  int (*context_check_key)(const Context*) = nullptr;
  int (*context_trust)(Context*, const char*, const char*) = nullptr;
  int (*context_trust_system)(Context*) = nullptr;
  void (*context_verify)(Context*, int, void*) = nullptr;
  Ssl* (*ssl_new)(Context*) = nullptr;
  void (*ssl_free)(Ssl*) = nullptr;
  void (*ssl_set_bio)(Ssl*, Bio*, Bio*) = nullptr;
  void (*ssl_accepts)(Ssl*) = nullptr;
  void (*ssl_connects)(Ssl*) = nullptr;
  int (*ssl_shake)(Ssl*) = nullptr;
  int (*ssl_read)(Ssl*, void*, int) = nullptr;
  int (*ssl_write)(Ssl*, const void*, int) = nullptr;
  int (*ssl_error)(const Ssl*, int) = nullptr;
  int (*ssl_shutdown)(Ssl*) = nullptr;
  long (*ssl_ctrl)(Ssl*, int, long, void*) = nullptr;
  int (*ssl_set_host)(Ssl*, const char*) = nullptr;
  Verify* (*ssl_verify)(Ssl*) = nullptr;
  long (*ssl_verified)(const Ssl*) = nullptr;
  X509* (*ssl_peer)(const Ssl*) = nullptr;
  int (*verify_set_ip)(Verify*, const char*) = nullptr;
  const char* (*verify_text)(long) = nullptr;
  Name* (*x509_subject)(const X509*) = nullptr;
  void (*x509_free)(X509*) = nullptr;
  int (*name_text)(Name*, int, char*, int) = nullptr;
  Bio* (*bio_new)(const BioMethod*) = nullptr;
  const BioMethod* (*bio_memory)() = nullptr;
  int (*bio_read)(Bio*, void*, int) = nullptr;
  int (*bio_write)(Bio*, const void*, int) = nullptr;
  unsigned long (*last_error)() = nullptr;
  void (*clear_errors)() = nullptr;
  const char* (*error_text)(unsigned long) = nullptr;

 private:
  [[nodiscard]] Outcome find_all();
};

}  // namespace unitylink::tls
