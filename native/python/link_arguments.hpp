// SPDX-License-Identifier: BSD-3-Clause
// What all calls of a link share: options, words, signals.
#pragma once

#include <nanobind/nanobind.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "layer2_message/link.hpp"

namespace unitylink::python {

namespace nb = nanobind;

// Adds the methods that only the framed protocol has.
void bind_framed(nb::class_<Link>& link);
// Adds the methods about the line.
void bind_line(nb::class_<Link>& link);
// Adds the calls of a control loop.
void bind_loop(nb::class_<Link>& link);

constexpr std::uint64_t patience_ns = 100'000'000;  // a wait without a limit checks for Ctrl-C this often

inline RequestOptions options_of(nb::handle checked, bool repeat, nb::handle timeout_s) {
  RequestOptions options;
  options.repeat = repeat;
  if (!checked.is_none()) {
    bool wanted = false;
    if (!nb::try_cast(checked, wanted)) {
      raise_unless_ok({Status::range, "checked is True, False or None, not " + told(checked)});
    }
    options.checked = wanted;
  }
  if (!timeout_s.is_none()) {
    double seconds = 0;
    if (!nb::try_cast(timeout_s, seconds) || !(seconds > 0 && seconds <= 3600)) {
      PyErr_Clear();  // an integer that no float can hold leaves an exception
      raise_unless_ok({Status::range, "timeout_s must be above 0 and at most 3600, not " + told(timeout_s)});
    }
    options.timeout_ns = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(seconds * 1e9));
  }
  return options;
}

// Subscribes at a link, or at its server. Returns the number of the subscription.
template <class Publisher>
std::uint32_t subscribe(Publisher& at, nb::handle addresses, nb::handle divisor, bool on_event, bool verify,
                        nb::handle ring, nb::handle group) {
  const std::vector<std::uint32_t> words = words_of(addresses, "address");
  SubscriptionRequest request{.addresses = words,
                              .divisor = word_of(divisor, "divisor"),
                              .on_event = on_event,
                              .verify = verify,
                              .ring = word_of(ring, "ring")};
  if (!group.is_none()) {
    request.group = word_of(group, "group");
  }
  std::uint32_t id = 0;
  Outcome outcome;
  {
    GilRelease release;
    outcome = at.subscribe(request, id);
  }
  raise_unless_ok(outcome);
  return id;
}

template <class Publisher>
void unsubscribe(Publisher& at, std::uint32_t id) {
  Outcome outcome;
  {
    GilRelease release;
    outcome = at.unsubscribe(id);
  }
  raise_unless_ok(outcome);
}

// Raises what a signal's handler has raised while a call waited, where the call itself has gone well.
inline void raise_pending() {
  if (PyErr_Occurred() != nullptr) {
    throw nb::python_error();
  }
}

inline void check_signals() {
  if (PyErr_CheckSignals() != 0) {
    throw nb::python_error();
  }
}

// `at_once` tries to read without waiting, with the GIL held. If it returns false, `reader` reads.
template <class Reader, class AtOnce>
nb::object read_words(nb::handle addresses, const Reader& reader, const AtOnce& at_once) {
  const std::vector<std::uint32_t> words = words_of(addresses, "address");
  auto values = std::make_unique<std::uint32_t[]>(words.size());
  const std::span<const std::uint32_t> where(words);
  const std::span<std::uint32_t> room(values.get(), words.size());
  Outcome outcome;
  if (!at_once(where, room)) {
    GilRelease release;
    outcome = reader(where, room);
  }
  raise_unless_ok(outcome);
  return array_of(std::move(values), {words.size()});
}

template <class Reader>
nb::object read_words(nb::handle addresses, const Reader& reader) {
  return read_words(addresses, reader, [](auto, auto) { return false; });
}

}  // namespace unitylink::python
