// SPDX-License-Identifier: BSD-3-Clause
// NativeLink: what a control loop does in each turn, each in one call. The same bytes travel as with single calls.
#include <utility>

#include "link_arguments.hpp"

namespace unitylink::python {
namespace {

double seconds_of(std::uint64_t ns) noexcept { return static_cast<double>(ns) / 1e9; }

nb::object list_of(std::span<const std::uint32_t> words) {
  nb::object list = nb::steal(PyList_New(static_cast<Py_ssize_t>(words.size())));
  if (!list.is_valid()) {
    nb::raise_python_error();
  }
  for (std::size_t index = 0; index < words.size(); ++index) {
    PyList_SetItem(list.ptr(), static_cast<Py_ssize_t>(index), nb::int_(words[index]).release().ptr());
  }
  return list;
}

// Returns the time in the middle of a read, and its words.
nb::tuple sample(Link& link, nb::handle addresses, bool atomic, nb::handle checked, bool repeat, nb::handle timeout_s) {
  const RequestOptions options = options_of(checked, repeat, timeout_s);
  const std::vector<std::uint32_t> where = words_of(addresses, "address");
  std::vector<std::uint32_t> words(where.size());
  const std::uint64_t begun_ns = link.now_ns();
  Outcome outcome;
  if ((atomic && !repeat) || !link.read_at_once(where, words, atomic)) {
    GilRelease release;
    outcome = link.read_many(where, words, atomic, options);
  }
  raise_unless_ok(outcome);
  return nb::make_tuple((seconds_of(begun_ns) + seconds_of(link.now_ns())) / 2, list_of(words));
}

// Writes words, then 1 to `place`, and returns the word there. Before that it looks again, at most `looks` times,
// while the bits `mask` of the word are `waiting`. If a look fails, it returns the word as it was: who looks again gets
// the error.
std::uint32_t commit(Link& link, nb::handle addresses, nb::handle values, std::uint32_t place, std::uint32_t mask,
                     std::uint32_t waiting, unsigned looks, nb::handle timeout_s) {
  std::vector<std::uint32_t> where = words_of(addresses, "address");
  std::vector<std::uint32_t> words = words_of(values, "value");
  where.push_back(place);
  words.push_back(1);
  const RequestOptions once = options_of(nb::none(), false, timeout_s);
  const RequestOptions again{.checked = std::nullopt, .repeat = true};
  constexpr std::uint64_t between_ns = 100'000;  // as Link.pause_between_looks() in Python
  std::uint32_t word = 0;
  Outcome outcome;
  {
    GilRelease release;
    outcome = link.transfer(where, words, std::span(&place, 1), std::span(&word, 1), false, once);
    for (; outcome.ok() && looks > 0 && (word & mask) == waiting; --looks) {
      std::uint32_t seen = 0;
      if ((link.in_steps() && !link.pass(link.now_ns() + between_ns).ok()) || !link.read(place, seen, again).ok()) {
        break;
      }
      word = seen;
    }
  }
  raise_unless_ok(outcome);
  raise_pending();
  return word;
}

// Lets a step pass that begins at the end of the last one, `stepped_ns`, or now. Returns its end.
std::uint64_t pass_step(Link& link, std::uint64_t stepped_ns, std::uint64_t step_ns) {
  const std::uint64_t now_ns = link.now_ns();
  const std::uint64_t due_ns = stepped_ns + step_ns;
  const std::uint64_t until_ns = stepped_ns <= now_ns && now_ns <= due_ns ? due_ns : now_ns + step_ns;
  Outcome outcome;
  {
    GilRelease release;
    outcome = link.pass(until_ns);
  }
  raise_unless_ok(outcome);
  raise_pending();
  return until_ns;
}

}  // namespace

void bind_loop(nb::class_<Link>& link) {
  using namespace nb::literals;
  link.def("sample", &sample, "addresses"_a, "atomic"_a, "checked"_a.none(), "repeat"_a, "timeout_s"_a.none())
      .def("commit", &commit, "addresses"_a, "values"_a, "commit"_a, "mask"_a, "waiting"_a, "looks"_a,
           "timeout_s"_a.none())
      .def("pass_step", &pass_step, "stepped_ns"_a, "step_ns"_a);
}

}  // namespace unitylink::python
