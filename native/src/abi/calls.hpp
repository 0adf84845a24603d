// SPDX-License-Identifier: BSD-3-Clause
// What each call of the C ABI does: it checks its arguments, turns exceptions into a status, and keeps the failure.
#pragma once

#include <exception>
#include <new>
#include <system_error>

#include "abi/growing.hpp"
#include "abi/last_failure.hpp"
#include "layer2_message/link.hpp"
#include "unitylink.h"

namespace unitylink::abi {

inline constinit thread_local LastFailure last_failure;

inline ul_status told(const Outcome& outcome) noexcept {
  if (!outcome.ok()) {
    last_failure.keep(outcome);
  }
  return static_cast<ul_status>(outcome.status);
}

inline ul_status told(ul_status status, const char* text) noexcept {
  last_failure.keep(status, text);
  return status;
}

inline ul_status bad_argument(const char* what) noexcept { return told(UL_ARGUMENT, what); }

template <class Call>
ul_status guarded(const Call& call) noexcept {
  try {
    return call();
  } catch (const std::bad_alloc&) {
    return told(UL_NO_MEMORY, "");
  } catch (const std::system_error&) {
    return told(UL_NO_MEMORY, "the system gives this program no more threads or descriptors");
  } catch (const std::exception& error) {
    return told(UL_NO_MEMORY, error.what());
  }
}

inline bool request_options(const ul_options* given, bool repeat, RequestOptions& options) {
  options.repeat = repeat;
  if (given == nullptr) {
    return true;
  }
  ul_options wanted{};
  if (!take(given, wanted)) {
    return false;
  }
  if (wanted.checked >= 0) {
    options.checked = wanted.checked != 0;
  }
  options.repeat = wanted.repeat != 0;
  options.timeout_ns = wanted.timeout_ns;
  return true;
}

inline constexpr const char* null_pointer = "a required pointer is NULL";
inline constexpr const char* unknown_size =
    "a struct is NULL, its size field is not sizeof of the struct, or it asks for what only a newer library has";

}  // namespace unitylink::abi
