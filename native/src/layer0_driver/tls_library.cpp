// SPDX-License-Identifier: BSD-3-Clause
#include "layer0_driver/tls_library.hpp"

#include <cstdlib>
#include <dlfcn.h>
#include <string>
#include <type_traits>

namespace unitylink::tls {

const Library* Library::load(Outcome& outcome) {
  static Library library;
  static const Outcome found = library.find_all();
  outcome = found;
  return found.ok() ? &library : nullptr;
}

Outcome Library::find_all() {
  const char* const told = std::getenv("UNITYLINK_LIBSSL");
  void* file = nullptr;
  std::string name;
  for (const char* const candidate : {told != nullptr ? told : "libssl.so.3", "libssl.so.1.1"}) {
    name = candidate;
    file = ::dlopen(candidate, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    if (file != nullptr || told != nullptr) {
      break;
    }
  }
  if (file == nullptr) {
    return {Status::not_found, (told != nullptr ? name : "OpenSSL, libssl.so.3,") +
                                   " is missing, and TLS needs it; on Debian or Ubuntu: sudo apt-get install libssl3"};
  }
  std::string missing;
  const auto find = [&](auto& function, const char* symbol, const char* earlier = nullptr) {
    void* address = ::dlsym(file, symbol);  // also finds what is in libcrypto, on which libssl depends
    if (address == nullptr && earlier != nullptr) {
      address = ::dlsym(file, earlier);
    }
    if (address == nullptr) {
      missing = symbol;
    }
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(address);
  };
  find(server_method, "TLS_server_method");
  find(client_method, "TLS_client_method");
  find(context_new, "SSL_CTX_new");
  find(context_free, "SSL_CTX_free");
  find(context_ctrl, "SSL_CTX_ctrl");
  find(context_set_tickets, "SSL_CTX_set_num_tickets");
  find(context_set_password, "SSL_CTX_set_default_passwd_cb");
  find(context_use_chain, "SSL_CTX_use_certificate_chain_file");
  find(context_use_key, "SSL_CTX_use_PrivateKey_file");
  find(context_check_key, "SSL_CTX_check_private_key");
  find(context_trust, "SSL_CTX_load_verify_locations");
  find(context_trust_system, "SSL_CTX_set_default_verify_paths");
  find(context_verify, "SSL_CTX_set_verify");
  find(ssl_new, "SSL_new");
  find(ssl_free, "SSL_free");
  find(ssl_set_bio, "SSL_set_bio");
  find(ssl_accepts, "SSL_set_accept_state");
  find(ssl_connects, "SSL_set_connect_state");
  find(ssl_shake, "SSL_do_handshake");
  find(ssl_read, "SSL_read");
  find(ssl_write, "SSL_write");
  find(ssl_error, "SSL_get_error");
  find(ssl_shutdown, "SSL_shutdown");
  find(ssl_ctrl, "SSL_ctrl");
  find(ssl_set_host, "SSL_set1_host");
  find(ssl_verify, "SSL_get0_param");
  find(ssl_verified, "SSL_get_verify_result");
  find(ssl_peer, "SSL_get1_peer_certificate", "SSL_get_peer_certificate");
  find(verify_set_ip, "X509_VERIFY_PARAM_set1_ip_asc");
  find(verify_text, "X509_verify_cert_error_string");
  find(x509_subject, "X509_get_subject_name");
  find(x509_free, "X509_free");
  find(name_text, "X509_NAME_get_text_by_NID");
  find(bio_new, "BIO_new");
  find(bio_memory, "BIO_s_mem");
  find(bio_read, "BIO_read");
  find(bio_write, "BIO_write");
  find(last_error, "ERR_peek_last_error");
  find(clear_errors, "ERR_clear_error");
  find(error_text, "ERR_reason_error_string");
  if (!missing.empty()) {
    return {Status::not_found, name + " has no " + missing + ": it is not OpenSSL, or it is older than 1.1.1"};
  }
  return {};
}

}  // namespace unitylink::tls
