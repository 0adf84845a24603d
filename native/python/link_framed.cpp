// SPDX-License-Identifier: BSD-3-Clause
// NativeLink: the methods that only the framed protocol has.
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include "link_arguments.hpp"

namespace unitylink::python {
namespace {

nb::object transfer(Link& link, nb::handle pairs, nb::handle addresses, bool atomic, nb::handle timeout_s) {
  const Writes writes = writes_of(pairs);
  const RequestOptions options = options_of(nb::none(), false, timeout_s);
  return read_words(addresses, [&](auto words, auto values) {
    return link.transfer(writes.addresses, writes.values, words, values, atomic, options);
  });
}

void post(Link& link, nb::handle addresses, nb::handle values, nb::handle timeout_s) {
  const std::vector<std::uint32_t> where = words_of(addresses, "address");
  const std::vector<std::uint32_t> what = words_of(values, "value");
  const RequestOptions options = options_of(nb::none(), false, timeout_s);
  Outcome outcome;
  {
    GilRelease release;
    outcome = link.post(where, what, options);
  }
  check_signals();
  raise_unless_ok(outcome);
}

void synchronise(Link& link, nb::handle timeout_s) {
  const RequestOptions options = options_of(nb::none(), true, timeout_s);
  Outcome outcome;
  {
    GilRelease release;
    outcome = link.sync(options);
  }
  raise_unless_ok(outcome);
}

nb::object read_control(Link& link, std::uint32_t address, std::size_t count) {
  auto values = std::make_unique<std::uint32_t[]>(count);
  Outcome outcome;
  {
    GilRelease release;
    outcome = link.read_control(address, std::span(values.get(), count), {});
  }
  raise_unless_ok(outcome);
  return array_of(std::move(values), {count});
}

void write_control(Link& link, std::uint32_t address, std::uint32_t value) {
  Outcome outcome;
  {
    GilRelease release;
    outcome = link.write_control(address, value, {});
  }
  raise_unless_ok(outcome);
}

// Runs a call that takes options and returns nothing.
template <class Call>
void done(nb::handle timeout_s, const Call& call) {
  const RequestOptions options = options_of(nb::none(), false, timeout_s);
  Outcome outcome;
  {
    GilRelease release;
    outcome = call(options);
  }
  raise_unless_ok(outcome);
}

nb::object do_list(Link& link, nb::handle operations, nb::handle addresses, nb::handle values, nb::handle masks,
                   std::size_t reads, bool atomic, nb::handle timeout_s) {
  const std::vector<std::uint32_t> what = words_of(operations, "operation");
  const std::vector<std::uint32_t> where = words_of(addresses, "address");
  const std::vector<std::uint32_t> words = words_of(values, "value");
  const std::vector<std::uint32_t> bits = words_of(masks, "mask");
  std::vector<ListWord> steps;
  for (std::size_t index = 0; index < std::min({what.size(), where.size(), words.size(), bits.size()}); ++index) {
    steps.push_back({what[index], where[index], words[index], bits[index]});
  }
  auto read = std::make_unique<std::uint32_t[]>(reads);
  done(timeout_s,
       [&](const RequestOptions& how) { return link.list(steps, std::span(read.get(), reads), atomic, how); });
  return array_of(std::move(read), {reads});
}

std::vector<ExchangeWord> layout_of(nb::handle addresses, nb::handle bytes) {
  const std::vector<std::uint32_t> where = words_of(addresses, "address");
  const std::vector<std::uint32_t> widths = words_of(bytes, "number of bytes");
  std::vector<ExchangeWord> words;
  for (std::size_t index = 0; index < std::min(where.size(), widths.size()); ++index) {
    words.push_back({where[index], widths[index]});
  }
  return words;
}

std::uint32_t define_exchange(Link& link, nb::handle outputs, nb::handle output_bytes, nb::handle inputs,
                              nb::handle input_bytes) {
  const std::vector<ExchangeWord> out = layout_of(outputs, output_bytes);
  const std::vector<ExchangeWord> in = layout_of(inputs, input_bytes);
  std::uint32_t id = 0;
  done(nb::none(), [&](const RequestOptions&) { return link.define_exchange(out, in, id); });
  return id;
}

nb::object exchange(Link& link, std::uint32_t id, nb::handle outputs, std::size_t inputs, nb::handle timeout_s) {
  const std::vector<std::uint32_t> words = words_of(outputs, "value");
  auto values = std::make_unique<std::uint32_t[]>(inputs);
  done(timeout_s,
       [&](const RequestOptions& how) { return link.exchange(id, words, std::span(values.get(), inputs), how); });
  return array_of(std::move(values), {inputs});
}

void set_dead_man(Link& link, double silence_s, nb::handle timeout_s) {
  done(timeout_s, [&](const RequestOptions& how) { return link.set_dead_man(silence_s, how); });
}

void arm(Link& link, nb::handle timeout_s) {
  done(timeout_s, [&](const RequestOptions& how) { return link.arm(how); });
}

void trip(Link& link, nb::handle timeout_s) {
  done(timeout_s, [&](const RequestOptions& how) { return link.trip(how); });
}

void watch_program(Link& link, double patience_s) {
  done(nb::none(), [&](const RequestOptions&) { return link.watch_program(patience_s); });
}

nb::dict description(const Link& link) {
  const Description& told = link.description();
  nb::dict result;
  result["version"] = told.version;
  result["gateware_version"] = told.gateware_version;
  result["build"] = told.build;
  result["clock_hz"] = told.clock_hz;
  result["features"] = told.features;
  result["credit"] = told.credit;
  result["request_max"] = told.request_max;
  result["reply_max"] = told.reply_max;
  result["window"] = told.window;
  result["cache"] = told.cache;
  result["exchanges"] = told.exchanges;
  result["exchange_size"] = told.exchange_size;
  result["spec_hash"] = told.spec_hash;
  return result;
}

std::string check_spec(const Link& link, std::string_view spec, const std::vector<std::uint64_t>& hashes) {
  std::string unverified;
  raise_unless_ok(link.check_spec(spec, hashes, unverified));
  return unverified;
}

nb::tuple clock_state(Link& link) {
  ClockState state;
  {
    GilRelease release;
    state = link.clock();
  }
  return nb::make_tuple(state.period_ns, state.drift_ppm, state.uncertainty_ns);
}

}  // namespace

void bind_framed(nb::class_<Link>& link) {
  using namespace nb::literals;
  link.def("transfer", &transfer, "writes"_a, "reads"_a, "atomic"_a, "timeout_s"_a.none())
      .def("do_list", &do_list, "operations"_a, "addresses"_a, "values"_a, "masks"_a, "reads"_a, "atomic"_a,
           "timeout_s"_a.none())
      .def("post", &post, "addresses"_a, "values"_a, "timeout_s"_a.none())
      .def("sync", &synchronise, "timeout_s"_a.none())
      .def("read_control", &read_control, "address"_a, "count"_a)
      .def("write_control", &write_control, "address"_a, "value"_a)
      .def("define_exchange", &define_exchange, "outputs"_a, "output_bytes"_a, "inputs"_a, "input_bytes"_a)
      .def("exchange", &exchange, "id"_a, "outputs"_a, "inputs"_a, "timeout_s"_a.none())
      .def("release_exchange", &Link::release_exchange, "id"_a, nb::call_guard<GilRelease>())
      .def("set_dead_man", &set_dead_man, "silence_s"_a, "timeout_s"_a.none())
      .def("arm", &arm, "timeout_s"_a.none())
      .def("trip", &trip, "timeout_s"_a.none())
      .def("watch_program", &watch_program, "patience_s"_a)
      .def("alive", &Link::alive)
      .def("missing", &Link::missing, "id"_a, nb::call_guard<GilRelease>())
      .def("clock", &clock_state)
      .def("check_spec", &check_spec, "spec"_a, "hashes"_a)
      .def_prop_ro("protocol", &Link::protocol)
      .def_prop_ro("notice", [](const Link& link) { return link.notice(); })
      .def_prop_ro("description", &description);
}

}  // namespace unitylink::python
