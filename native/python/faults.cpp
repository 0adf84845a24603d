// SPDX-License-Identifier: BSD-3-Clause
// The fault simulation for Python; commands/faults.py runs it.
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>

#include <string>
#include <string_view>

#include "bindings.hpp"
#include "faults/goodput.hpp"
#include "faults/simulation.hpp"

namespace nb = nanobind;

namespace unitylink::python {
namespace {

nb::list profiles() {
  nb::list result;
  for (const faults::Profile& profile : faults::profiles()) {
    result.append(nb::make_tuple(std::string(profile.name), std::string(profile.meaning)));
  }
  return result;
}

nb::dict run(std::uint64_t seed, std::uint64_t messages, std::string_view profile, bool framed, std::uint32_t clients,
             std::uint32_t window, nb::handle configuration, nb::handle model) {
  const auto chosen = faults::find_profile(profile);
  if (!chosen) {
    throw nb::key_error(("no profile " + std::string(profile)).c_str());
  }
  faults::Plan plan{
      .seed = seed, .messages = messages, .profile = *chosen, .framed = framed, .clients = clients, .window = window};
  std::unique_ptr<device::RtlDevice> gateware;
  if (!model.is_none()) {
    gateware = make_rtl_device(model, configuration_of(configuration));
    plan.gateware = [&gateware] { return std::move(gateware); };
  }
  faults::Report report;
  {
    const GilRelease released;
    report = faults::run(plan);
  }
  nb::dict result;
  result["messages"] = report.messages;
  result["good"] = report.good;
  result["failed"] = report.failed;
  result["unknown"] = report.unknown;
  result["faults"] = report.faults;
  result["resets"] = report.resets;
  result["sessions"] = report.sessions;
  result["retries"] = report.retries;
  result["bus_writes"] = report.bus_writes;
  result["undetected"] = report.undetected;
  result["digest"] = report.digest;
  result["virtual_s"] = report.virtual_s;
  result["calm_rate_hz"] = report.calm_rate_hz;
  result["faulty_rate_hz"] = report.faulty_rate_hz;
  result["recovered_rate_hz"] = report.recovered_rate_hz;
  nb::list violations;
  for (const std::string& text : report.violations) {
    violations.append(text);
  }
  result["violations"] = violations;
  return result;
}

nb::dict goodput(std::uint64_t seed, std::string_view kind, std::uint64_t words, double lose,
                 std::uint32_t message_words, std::uint32_t window, std::uint64_t byte_ns, std::uint64_t delay_ns,
                 std::uint64_t buffer_bytes) {
  const auto chosen = faults::find_traffic(kind);
  if (!chosen) {
    throw nb::key_error(("no traffic " + std::string(kind)).c_str());
  }
  faults::GoodputReport report;
  {
    const GilRelease released;
    report = faults::goodput({.seed = seed,
                              .kind = *chosen,
                              .words = words,
                              .message_words = message_words,
                              .lose = lose,
                              .window = window,
                              .byte_ns = byte_ns,
                              .delay_ns = delay_ns,
                              .buffer_bytes = buffer_bytes});
  }
  nb::dict result;
  result["words_per_s"] = report.words_per_s;
  result["sent_bytes_per_word"] = report.sent_bytes_per_word;
  result["returned_bytes_per_word"] = report.returned_bytes_per_word;
  result["lost"] = report.lost;
  result["wrong"] = report.wrong;
  return result;
}

}  // namespace

void bind_faults(nb::module_& module) {
  module.def("fault_profiles", &profiles);
  module.def("run_faults", &run, nb::arg("seed"), nb::arg("messages"), nb::arg("profile"), nb::arg("framed"),
             nb::arg("clients"), nb::arg("window"), nb::arg("configuration").none() = nb::none(),
             nb::arg("model").none() = nb::none());
  const faults::GoodputPlan usual;
  module.def("goodput", &goodput, nb::arg("seed"), nb::arg("kind"), nb::arg("words"), nb::arg("lose"),
             nb::arg("message_words") = usual.message_words, nb::arg("window") = usual.window,
             nb::arg("byte_ns") = usual.byte_ns, nb::arg("delay_ns") = usual.delay_ns,
             nb::arg("buffer_bytes") = usual.buffer_bytes);
}

}  // namespace unitylink::python
