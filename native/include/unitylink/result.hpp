// SPDX-License-Identifier: BSD-3-Clause
//
// What a call gives: a value, or the error why there is none. It is used as std::expected of C++23. value() throws the
// error as unitylink::Failure, for programs that prefer exceptions. C++20; it allocates nothing unless it throws.
#pragma once

#include <unitylink/value.h>

#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace unitylink {

class Error {
 public:
  Error() = default;
  explicit Error(const ul_failure& failure) : failure_(failure) {}

  // UL_TIMEOUT, UL_RANGE, UL_MISMATCH and the others of unitylink.h.
  [[nodiscard]] ul_status status() const noexcept { return failure_.status; }
  // The name of the value, group or robot.
  [[nodiscard]] const char* path() const noexcept { return failure_.path; }
  // What failed, why, and the remedy.
  [[nodiscard]] const char* text() const noexcept { return failure_.text; }

 private:
  ul_failure failure_{};
};

// An error as an exception.
class Failure : public std::runtime_error {
 public:
  explicit Failure(const Error& error) : std::runtime_error(error.text()), error_(error) {}
  [[nodiscard]] const Error& error() const noexcept { return error_; }
  [[nodiscard]] ul_status status() const noexcept { return error_.status(); }

 private:
  Error error_;
};

[[noreturn]] inline void raise(const Error& error) {
#if defined(__cpp_exceptions)
  throw Failure(error);
#else
  std::fputs(error.text(), stderr);
  std::abort();
#endif
}

template <class T = void>
class [[nodiscard]] result {
 public:
  result(const T& value)
    requires std::is_copy_constructible_v<T>
      : has_(true), value_(value) {}
  result(T&& value)
    requires std::is_move_constructible_v<T>
      : has_(true), value_(std::move(value)) {}
  result(const Error& error) : has_(false), error_(error) {}
  template <class... Arguments>
  explicit result(std::in_place_t, Arguments&&... arguments)
      : has_(true), value_(std::forward<Arguments>(arguments)...) {}
  result(const result& other)
    requires std::is_copy_constructible_v<T>
      : has_(other.has_) {
    take(other);
  }
  result(result&& other) noexcept
    requires std::is_move_constructible_v<T>
      : has_(other.has_) {
    take(std::move(other));
  }
  result& operator=(result other) noexcept
    requires std::is_move_constructible_v<T>
  {
    drop();
    has_ = other.has_;
    take(std::move(other));
    return *this;
  }
  ~result() { drop(); }

  [[nodiscard]] bool has_value() const noexcept { return has_; }
  explicit operator bool() const noexcept { return has_; }
  // Only if there is a value, as with std::expected.
  T& operator*() & noexcept { return value_; }
  const T& operator*() const& noexcept { return value_; }
  T&& operator*() && noexcept { return std::move(value_); }
  T* operator->() noexcept { return std::addressof(value_); }
  const T* operator->() const noexcept { return std::addressof(value_); }
  // Throws Failure if there is none.
  T& value() & { return checked(), value_; }
  const T& value() const& { return checked(), value_; }
  T&& value() && { return checked(), std::move(value_); }
  template <class Other>
  T value_or(Other&& other) const {
    return has_ ? value_ : static_cast<T>(std::forward<Other>(other));
  }
  [[nodiscard]] const Error& error() const noexcept { return error_; }

 private:
  void checked() const {
    if (!has_) raise(error_);
  }
  template <class Other>
  void take(Other&& other) {
    if (has_) {
      std::construct_at(std::addressof(value_), std::forward<Other>(other).value_);
    } else {
      std::construct_at(std::addressof(error_), other.error_);
    }
  }
  void drop() noexcept {
    if (has_) {
      std::destroy_at(std::addressof(value_));
    } else {
      std::destroy_at(std::addressof(error_));
    }
  }

  bool has_;
  union {
    T value_;
    Error error_;
  };
};

template <>
class [[nodiscard]] result<void> {
 public:
  result() = default;
  result(const Error& error) : has_(false), error_(error) {}
  [[nodiscard]] bool has_value() const noexcept { return has_; }
  explicit operator bool() const noexcept { return has_; }
  void value() const {
    if (!has_) raise(error_);
  }
  [[nodiscard]] const Error& error() const noexcept { return error_; }

 private:
  bool has_ = true;
  Error error_;
};

}  // namespace unitylink
