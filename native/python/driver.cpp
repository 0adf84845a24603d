// SPDX-License-Identifier: BSD-3-Clause
// Layer 0 for Python: a driver used alone. Its calls wait as long as their argument says.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/unique_ptr.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <memory>
#include <poll.h>
#include <string>

#include "bindings.hpp"
#include "layer0_driver/driver.hpp"

namespace nb = nanobind;

namespace unitylink::python {
namespace {

constexpr std::size_t receive_bytes_max = 65536;

int milliseconds(double timeout_s) {
  return timeout_s <= 0 ? 0 : static_cast<int>(timeout_s < 3600 ? timeout_s * 1e3 + 0.999 : 3.6e6);
}

std::unique_ptr<Driver> open(std::string_view text, double timeout_s) {
  Url url;
  Outcome outcome = parse_url(text, url);
  std::unique_ptr<Driver> driver;
  if (outcome.ok()) {
    GilRelease release;
    outcome = open_driver(url, static_cast<std::uint64_t>(timeout_s * 1e9), driver);
  }
  raise_unless_ok(outcome);
  return driver;
}

bool wait_for(const Driver& driver, short what, double timeout_s) {
  pollfd waiting{driver.descriptor(), what, 0};
  const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(milliseconds(timeout_s));
  while (true) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - std::chrono::steady_clock::now()).count();
    const int ready = ::poll(&waiting, 1, static_cast<int>(std::max<std::int64_t>(left, 0)));
    if (ready >= 0 || errno != EINTR) {
      return ready > 0;
    }
    const nb::gil_scoped_acquire hold;
    if (PyErr_CheckSignals() != 0) {
      throw nb::python_error();
    }
  }
}

void must_be_open(const Driver& driver) {
  if (driver.descriptor() < 0) {
    raise_unless_ok({Status::closed, "the driver is closed"});
  }
}

std::size_t send(Driver& driver, nb::bytes data, double timeout_s) {
  must_be_open(driver);
  const std::span<const std::uint8_t> bytes(static_cast<const std::uint8_t*>(data.data()), data.size());
  Outcome outcome;
  std::size_t done = 0;
  {
    GilRelease release;
    while (done < bytes.size()) {
      const Transfer transfer = driver.send(bytes.subspan(done));
      done += transfer.count;
      if (transfer.status != Status::ok) {
        outcome = {transfer.status, driver.reason()};
        break;
      }
      if (transfer.count == 0 && !wait_for(driver, POLLOUT, timeout_s)) {
        break;
      }
    }
  }
  raise_unless_ok(outcome);
  return done;
}

nb::bytes receive(Driver& driver, double timeout_s) {
  must_be_open(driver);
  std::string room(receive_bytes_max, '\0');
  Outcome outcome;
  Transfer transfer;
  {
    GilRelease release;
    if (wait_for(driver, POLLIN, timeout_s)) {
      transfer = driver.receive(std::span(reinterpret_cast<std::uint8_t*>(room.data()), room.size()));
      if (transfer.status != Status::ok) {
        outcome = {transfer.status, driver.reason()};
      }
    }
  }
  raise_unless_ok(outcome);
  return nb::bytes(room.data(), transfer.count);
}

// Each row of the table as (name, form, what, stream, once).
nb::list schemes_there() {
  nb::list rows;
  for (const Scheme* scheme : schemes()) {
    rows.append(nb::make_tuple(std::string(scheme->name), std::string(scheme->form), std::string(scheme->what),
                               scheme->stream, scheme->once));
  }
  return rows;
}

}  // namespace

void bind_driver(nb::module_& module) {
  using namespace nb::literals;
  nb::class_<Driver>(module, "NativeDriver")
      .def("send", &send, "data"_a, "timeout_s"_a)
      .def("receive", &receive, "timeout_s"_a)
      .def("close", &Driver::close)
      .def_prop_ro("descriptor", &Driver::descriptor);
  module.def("open_driver", &open, "url"_a, "timeout_s"_a);
  module.def("schemes", &schemes_there);
}

}  // namespace unitylink::python
