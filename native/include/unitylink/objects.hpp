// SPDX-License-Identifier: BSD-3-Clause
//
// Links and values as objects of C++20: what the headers of `unitylink generate --only cpp` are made of. Header-only on
// the C ABI. After their construction the objects allocate nothing, and they hold no lock.
//
// Threads: as in objects.h. Values and parts refer to their robot, which must outlive them and stays where it is.
#pragma once

#include <unitylink/sets.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <initializer_list>
#include <string>

#include "unitylink/result.hpp"

namespace unitylink {

// An open link. docs/command-line.md describes the URLs.
class Link {
 public:
  explicit Link(const std::string& url) : Link(opened(url).value()) {}
  Link(Link&& other) noexcept : link_(std::exchange(other.link_, nullptr)) {}
  Link& operator=(Link other) noexcept {
    std::swap(link_, other.link_);
    return *this;
  }
  ~Link() { ul_free(link_); }

  // Opens a link. Unlike the constructor it does not throw.
  static result<Link> open(const std::string& url) {
    const result<ul_link*> made = opened(url);
    if (!made) return made.error();
    return result<Link>(std::in_place, *made);
  }
  // Takes over a link of the C ABI.
  explicit Link(ul_link* link) noexcept : link_(link) {}

  [[nodiscard]] ul_link* handle() const noexcept { return link_; }
  // Ends the link. A call that waits in another thread gets UL_CLOSED.
  void close() noexcept { ul_close(link_); }
  // After this silence of the program the gateware makes the outputs safe. 0: never.
  result<> set_dead_man(std::chrono::nanoseconds silence) {
    return told(ul_set_dead_man(link_, count(silence), nullptr));
  }
  // Allows writes again after the dead-man has tripped.
  result<> arm() { return told(ul_arm(link_, nullptr)); }
  // From now on alive() must be called within this time, or the dead-man trips. 0: never.
  result<> watch_program(std::chrono::nanoseconds patience) { return told(ul_watch_program(link_, count(patience))); }
  // Says that the program works. Does not lock, wait or allocate.
  void alive() noexcept { ul_alive(link_); }
  // With reconnect=1 in the URL: waits until the line is there.
  result<> wait_up(std::chrono::nanoseconds timeout) { return told(ul_wait_up(link_, count(timeout))); }

 private:
  static std::uint64_t count(std::chrono::nanoseconds time) { return static_cast<std::uint64_t>(time.count()); }
  static result<ul_link*> opened(const std::string& url) {
    ul_link* link = nullptr;
    ul_failure failure{};
    if (ul_fail_link(&failure, ul_open(url.c_str(), &link), "link") != UL_OK) return Error(failure);
    return link;
  }
  static result<> told(ul_status status) {
    ul_failure failure{};
    if (ul_fail_link(&failure, status, "link") != UL_OK) return Error(failure);
    return {};
  }

  ul_link* link_;
};

// ---- between raw numbers and values. A packed value has functions of its own.

template <class T>
ul_status encode(const ul_value& facts, const T& value, std::uint64_t& raw, ul_failure& failure) {
  if constexpr (std::is_same_v<T, bool>) {
    raw = value ? 1 : 0;
    return UL_OK;
  } else if constexpr (std::is_enum_v<T>) {
    return ul_encode_member(&facts, static_cast<std::uint64_t>(value), &raw, &failure);
  } else if constexpr (std::is_floating_point_v<T>) {
    return ul_encode_real(&facts, value, &raw, &failure);
  } else if constexpr (std::is_signed_v<T>) {
    return ul_encode_signed(&facts, value, &raw, &failure);
  } else if constexpr (std::is_unsigned_v<T>) {
    return ul_encode_unsigned(&facts, value, &raw, &failure);
  } else {
    return value.encode(raw, failure);
  }
}

template <class T>
ul_status decode(const ul_value& facts, std::uint64_t raw, T& value, ul_failure& failure) {
  if constexpr (std::is_same_v<T, bool>) {
    value = (raw & 1U) != 0;
  } else if constexpr (std::is_enum_v<T>) {
    std::uint64_t number = 0;
    const ul_status status = ul_decode_member(&facts, raw, &number, &failure);
    value = static_cast<T>(number);
    return status;
  } else if constexpr (std::is_floating_point_v<T>) {
    value = ul_decode_real(&facts, raw);
  } else if constexpr (std::is_signed_v<T>) {
    value = static_cast<T>(ul_signed(&facts, raw));
  } else if constexpr (std::is_unsigned_v<T>) {
    value = static_cast<T>(raw & ul_mask(facts.width));
  } else {
    return value.decode(raw, failure);
  }
  return UL_OK;
}

// A field of a packed value.
template <class T>
ul_status encode_field(const ul_value& facts, const T& value, std::uint64_t& raw, ul_failure& failure) {
  std::uint64_t bits = 0;
  const ul_status status = encode(facts, value, bits, failure);
  raw |= (bits & ul_mask(facts.width)) << facts.address;
  return status;
}
template <class T>
ul_status decode_field(const ul_value& facts, T& value, std::uint64_t raw, ul_failure& failure) {
  return decode(facts, raw >> facts.address & ul_mask(facts.width), value, failure);
}

// ---- values

template <class T>
class Value {
 public:
  Value(ul_objects& objects, std::uint32_t index) noexcept : objects_(&objects), index_(index) {}
  // The value's address, unit, limits and so on.
  [[nodiscard]] const ul_value& facts() const noexcept { return objects_->facts->values[index_]; }

 protected:
  result<T> get() const {
    std::uint64_t raw = 0;
    T value{};
    ul_failure failure{};
    if (ul_value_read(objects_, index_, &raw, &failure) != UL_OK) return Error(failure);
    if (decode(facts(), raw, value, failure) != UL_OK) return Error(failure);
    return value;
  }
  result<> put(const T& value) const {
    std::uint64_t raw = 0;
    ul_failure failure{};
    if (encode(facts(), value, raw, failure) != UL_OK) return Error(failure);
    if (ul_value_write(objects_, index_, raw, &failure) != UL_OK) return Error(failure);
    return {};
  }

 private:
  ul_objects* objects_;
  std::uint32_t index_;
};

template <class T>
class ReadValue : public Value<T> {
 public:
  using Value<T>::Value;
  result<T> read() const { return this->get(); }
};

template <class T>
class WriteValue : public Value<T> {
 public:
  using Value<T>::Value;
  // A value that is out of its limits is an error (UL_RANGE), and nothing is sent.
  result<> write(const T& value) const { return this->put(value); }
};

template <class T>
class ReadWriteValue : public Value<T> {
 public:
  using Value<T>::Value;
  result<T> read() const { return this->get(); }
  result<> write(const T& value) const { return this->put(value); }
};

// A read changes it, so no read is repeated: UL_TIMEOUT may have taken the value with it.
template <class T>
class ReadClearValue : public Value<T> {
 public:
  using Value<T>::Value;
  result<T> read() const { return this->get(); }
};

// Flags that the gateware sets. clear() clears those that are set in `flags`.
template <class T>
class ClearValue : public Value<T> {
 public:
  using Value<T>::Value;
  result<T> read() const { return this->get(); }
  result<> clear(const T& flags) const { return this->put(flags); }
};

// A strobe: what is written works for a moment. It is never repeated.
template <class T>
class PulseValue : public Value<T> {
 public:
  using Value<T>::Value;
  result<> pulse(const T& value) const { return this->put(value); }
  result<> pulse() const
    requires std::is_arithmetic_v<T>
  {
    return this->put(static_cast<T>(1));
  }
};

// ---- the state of a robot

// The base of a public constructor's class: its links, and the shadow of its committed outputs.
template <std::size_t Links, std::size_t Memories, std::size_t Slots>
class Robot {
 public:
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;
  // Why it is not known that the gateware has this spec. "": it was verified.
  [[nodiscard]] const char* unverified() const noexcept { return objects_.unverified; }

 protected:
  // The links, after the boards behind them were found to be those of the spec.
  struct Checked {
    std::array<ul_link*, Links> links{};
    std::array<bool, Links> framed{};
    const char* unverified = "";
  };
  static result<Checked> checked(const ul_robot_facts& facts, const std::array<ul_link*, Links>& links) {
    Checked made{.links = links};
    ul_objects objects{&facts, made.links.data(), made.framed.data(), nullptr, ""};
    ul_failure failure{};
    if (ul_objects_check(&objects, &failure) != UL_OK) return Error(failure);
    made.unverified = objects.unverified;
    return made;
  }

  Robot(const ul_robot_facts& facts, const Checked& checked)
      : checked_(checked),
        objects_{&facts, checked_.links.data(), checked_.framed.data(), memories_.data(), checked.unverified} {
    std::size_t slot = 0;
    for (std::size_t i = 0; i < Memories; ++i) {
      memories_[i] = {&words_[slot], &words_[Slots + Memories + slot], &known_[slot], false, 0};
      slot += facts.memories[i].count + 1;
    }
  }
  ~Robot() = default;

  ul_objects& objects() noexcept { return objects_; }

 private:
  Checked checked_;
  std::array<ul_memory, Memories> memories_{};
  std::array<std::uint32_t, 2 * (Slots + Memories)> words_{};
  std::array<std::uint8_t, Slots + Memories> known_{};
  ul_objects objects_;
};

}  // namespace unitylink
