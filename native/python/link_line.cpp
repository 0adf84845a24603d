// SPDX-License-Identifier: BSD-3-Clause
// NativeLink: the methods about a line that may be lost and come back.
#include <nanobind/stl/string.h>

#include <algorithm>
#include <string>
#include <vector>

#include "layer2_message/send_limit.hpp"
#include "link_arguments.hpp"

namespace unitylink::python {
namespace {

// Waits for the line. False: it is still gone. If the link has ended, it raises the reason.
bool wait_up(Link& link, double timeout_s) {
  std::uint64_t left = timeout_s > 0 ? static_cast<std::uint64_t>(std::min(timeout_s, 1e9) * 1e9) : 0;
  while (true) {
    const std::uint64_t slice = std::min(left, patience_ns);
    Outcome outcome;
    {
      GilRelease release;
      outcome = link.wait_up(slice);
    }
    if (outcome.status != Status::down) {
      raise_unless_ok(outcome);
      return true;
    }
    left -= slice;
    if (left == 0) {
      return false;
    }
    check_signals();
  }
}

// Why the line has not come back yet. Empty if it is up, or the link has ended.
std::string trouble(Link& link) {
  GilRelease release;
  const Outcome outcome = link.wait_up(0);
  return outcome.status == Status::down ? outcome.text : std::string();
}

nb::tuple events(Link& link, std::uint64_t from) {
  std::vector<LinkEvent> come;
  {
    GilRelease release;
    come = link.events(from);
  }
  static constexpr const char* names[] = {"lost", "restarted", "back"};
  nb::list all;
  for (const LinkEvent& event : come) {
    all.append(nb::make_tuple(names[static_cast<std::size_t>(event.kind)], static_cast<double>(event.time_ns) * 1e-9,
                              event.text));
  }
  return nb::make_tuple(all, from);
}

}  // namespace

void bind_line(nb::class_<Link>& link) {
  using namespace nb::literals;
  link.def("wait_up", &wait_up, "timeout_s"_a)
      .def("events", &events, "since"_a)
      .def_prop_ro("trouble", &trouble)
      .def_prop_ro("generation", &Link::generation)
      .def_prop_ro("now_ns", &Link::now_ns)
      .def_static("limit_sending", &limit_sending, "before_ns"_a,
                  "From now on, what this thread asks of framed links is not sent at or after `before_ns` of the "
                  "system's monotonic clock. 0: no limit. Returns the limit until now.")
      .def_prop_ro("in_steps", &Link::in_steps)
      .def(
          "pass_until",
          [](Link& self, std::uint64_t until_ns) {
            Outcome outcome;
            {
              GilRelease release;
              outcome = self.pass(until_ns);
            }
            raise_unless_ok(outcome);
            raise_pending();
          },
          "until_ns"_a,
          "Waits until now_ns is `until_ns`. In steps, the boards and links of the process advance so far.")
      .def("now_s", [](const Link& self) { return static_cast<double>(self.now_ns()) / 1e9; });
}

}  // namespace unitylink::python
