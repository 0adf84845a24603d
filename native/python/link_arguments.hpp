// SPDX-License-Identifier: BSD-3-Clause
// What the calls of a link have in common: options, words, signals.
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

// Adds what only the framed protocol has.
void bind_framed(nb::class_<Link>& link);

inline RequestOptions options_of(nb::handle checked, bool repeat, nb::handle timeout_s) {
  RequestOptions options;
  options.repeat = repeat;
  if (!checked.is_none()) {
    options.checked = nb::cast<bool>(checked);
  }
  if (!timeout_s.is_none()) {
    const double seconds = nb::cast<double>(timeout_s);
    if (!(seconds > 0 && seconds <= 3600)) {
      raise_unless_ok({Status::range, "timeout_s must be above 0 and at most 3600, not " + std::to_string(seconds)});
    }
    options.timeout_ns = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(seconds * 1e9));
  }
  return options;
}

inline void check_signals() {
  if (PyErr_CheckSignals() != 0) {
    throw nb::python_error();
  }
}

template <class Reader>
nb::object read_words(nb::handle addresses, const Reader& reader) {
  const std::vector<std::uint32_t> words = words_of(addresses, "address");
  auto values = std::make_unique<std::uint32_t[]>(words.size());
  Outcome outcome;
  {
    GilRelease release;
    outcome = reader(std::span<const std::uint32_t>(words), std::span(values.get(), words.size()));
  }
  raise_unless_ok(outcome);
  return array_of(std::move(values), {words.size()});
}

}  // namespace unitylink::python
