// SPDX-License-Identifier: BSD-3-Clause
// Layer 2 for Python: NativeLink, and NativePending for asyncio. Every call that may lock the link's mutex releases the
// GIL first.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <deque>
#include <memory>
#include <mutex>
#include <sys/eventfd.h>
#include <unistd.h>

#include "arrays.hpp"
#include "bindings.hpp"
#include "link_arguments.hpp"
#include "layer2_message/link.hpp"
#include "layer2_message/link_options.hpp"

namespace nb = nanobind;

namespace unitylink::python {
namespace {

std::unique_ptr<Link> open_link(std::string_view url) {
  std::unique_ptr<Link> link;
  Outcome outcome;
  {
    GilRelease release;
    outcome = Link::open(url, link);
  }
  raise_unless_ok(outcome);
  return link;
}

void check_link_url(std::string_view text) {
  Url url;
  LinkOptions options;
  Outcome outcome = parse_url(text, url);
  if (outcome.ok()) {
    outcome = parse_options(url, options);
  }
  raise_unless_ok(outcome);
}

std::uint32_t read(Link& link, nb::handle address, nb::handle checked, bool repeat, nb::handle timeout_s) {
  const std::uint32_t word = word_of(address, "address");
  const RequestOptions options = options_of(checked, repeat, timeout_s);
  std::uint32_t value = 0;
  if (link.read_at_once(word, value)) {
    return value;
  }
  Outcome outcome;
  {
    GilRelease release;
    outcome = link.read(word, value, options);
  }
  raise_unless_ok(outcome);
  return value;
}

void write(Link& link, nb::handle address, nb::handle value, nb::handle checked, bool repeat, nb::handle timeout_s) {
  const std::uint32_t word = word_of(address, "address");
  const std::uint32_t what = word_of(value, "value");
  const RequestOptions options = options_of(checked, repeat, timeout_s);
  if (link.write_at_once(word, what)) {
    return;
  }
  Outcome outcome;
  {
    GilRelease release;
    outcome = link.write(word, what, options);
  }
  raise_unless_ok(outcome);
}

nb::object read_many(Link& link, nb::handle addresses, bool atomic, nb::handle checked, bool repeat,
                     nb::handle timeout_s) {
  const RequestOptions options = options_of(checked, repeat, timeout_s);
  // Words of one moment must be read twice, so only if repeating does no harm.
  const auto at_once = [&](auto words, auto values) {
    return (!atomic || repeat) && link.read_at_once(words, values, atomic);
  };
  return read_words(
      addresses, [&](auto words, auto values) { return link.read_many(words, values, atomic, options); }, at_once);
}

nb::object read_each(Link& link, nb::handle addresses, nb::handle checked, bool repeat, nb::handle timeout_s) {
  const RequestOptions options = options_of(checked, repeat, timeout_s);
  return read_words(addresses, [&](auto words, auto values) { return link.read_each(words, values, options); });
}

void write_many(Link& link, nb::handle addresses, nb::handle values, nb::handle checked, bool repeat,
                nb::handle timeout_s) {
  const std::vector<std::uint32_t> where = words_of(addresses, "address");
  const std::vector<std::uint32_t> what = words_of(values, "value");
  const RequestOptions options = options_of(checked, repeat, timeout_s);
  Outcome outcome;
  {
    GilRelease release;
    outcome = link.write_many(where, what, options);
  }
  raise_unless_ok(outcome);
}

nb::tuple drain(Link& link, std::uint32_t id, std::size_t words) {
  std::unique_ptr<double[]> times;
  std::unique_ptr<std::uint32_t[]> values;
  std::size_t count = 0;
  {
    GilRelease release;
    const std::size_t room = link.available(id);
    times.reset(new double[room]);
    values.reset(new std::uint32_t[room * words]);
    count = room == 0 ? 0 : link.drain(id, std::span(times.get(), room), std::span(values.get(), room * words));
  }
  return nb::make_tuple(array_of(std::move(times), {count}), array_of(std::move(values), {count, words}));
}

// Returns the waiting publish as (time_s, words) if there is only one. This is the usual case, and making arrays would
// take most of the time of the call.
nb::object take_single(Link& link, std::uint32_t id, std::size_t words) {
  double time_s = 0;
  std::array<std::uint32_t, protocol::limits::group_size_max> room;
  if (words > room.size()) {
    return nb::none();
  }
  {
    GilRelease release;
    if (link.available(id) != 1 || link.drain(id, std::span(&time_s, 1), std::span(room).first(words)) != 1) {
      return nb::none();
    }
  }
  const nb::object row = nb::steal(PyTuple_New(static_cast<Py_ssize_t>(words)));
  if (!row.is_valid()) {
    nb::raise_python_error();
  }
  for (std::size_t index = 0; index < words; ++index) {
    PyTuple_SetItem(row.ptr(), static_cast<Py_ssize_t>(index), nb::int_(room[index]).release().ptr());
  }
  return nb::make_tuple(time_s, row);
}

// Only the main thread gets Ctrl-C, so other threads are never interrupted.
bool interrupted() noexcept {
  if (::gettid() != ::getpid()) {
    return false;
  }
  const nb::gil_scoped_acquire hold;
  return PyErr_Occurred() == nullptr && PyErr_CheckSignals() != 0;
}

// Raises the reason if the link has ended by itself. It does nothing if the link is open, or was closed by this
// program.
void check_alive(Link& link) {
  bool by_itself = false;
  Outcome outcome;
  {
    GilRelease release;
    outcome = link.ending(by_itself);
  }
  if (by_itself) {
    raise_unless_ok(outcome);
  }
}

bool wait_publish(Link& link, std::uint32_t id, double timeout_s) {
  std::uint64_t left = timeout_s > 0 ? static_cast<std::uint64_t>(std::min(timeout_s, 1e9) * 1e9) : 0;
  while (true) {
    const std::uint64_t slice = std::min(left, patience_ns);
    bool come = false;
    Outcome over;
    {
      GilRelease release;
      bool by_itself = false;
      come = link.wait_publish(id, slice);
      if (!come && !link.subscribed(id)) {
        over = {Status::closed, "the subscription is closed"};
      }
      if (Outcome ending = come ? Outcome{} : link.ending(by_itself); !ending.ok()) {
        over = std::move(ending);
      }
    }
    raise_unless_ok(over);
    left -= slice;
    if (come || left == 0) {
      return come;
    }
    check_signals();
  }
}

// ---- asyncio: finished calls are put into a mailbox. The event loop watches its descriptor

// shared, so that C++ code needs no reference to a Python object
class Mailbox : public std::enable_shared_from_this<Mailbox> {
 public:
  Mailbox() : descriptor_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}
  Mailbox(const Mailbox&) = delete;
  Mailbox& operator=(const Mailbox&) = delete;
  ~Mailbox() { ::close(descriptor_); }

  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
  void post(std::uint64_t ticket) {
    const std::scoped_lock lock(mutex_);
    tickets_.push_back(ticket);
    const std::uint64_t one = 1;
    static_cast<void>(!::write(descriptor_, &one, sizeof one));
  }
  std::vector<std::uint64_t> collect() {
    std::uint64_t count = 0;
    static_cast<void>(!::read(descriptor_, &count, sizeof count));
    const std::scoped_lock lock(mutex_);
    return std::exchange(tickets_, {});
  }

 private:
  int descriptor_;
  std::mutex mutex_;
  std::vector<std::uint64_t> tickets_;
};

// One asynchronous call. It keeps itself alive until the engine no longer uses its exchanges.
class Pending {
 public:
  Pending(std::shared_ptr<Mailbox> mailbox, std::uint64_t ticket) : mailbox_(std::move(mailbox)), ticket_(ticket) {}

  static std::shared_ptr<Pending> start(Link& link, std::shared_ptr<Mailbox> mailbox, std::uint64_t ticket,
                                        nb::handle addresses, nb::handle values, bool atomic, nb::handle checked,
                                        bool repeat, nb::handle timeout_s) {
    auto pending = std::make_shared<Pending>(std::move(mailbox), ticket);
    pending->addresses_ = words_of(addresses, "address");
    pending->writes_ = !values.is_none();
    if (pending->writes_) {
      pending->values_ = words_of(values, "value");
    } else {
      pending->values_.resize(pending->addresses_.size());
    }
    const RequestOptions options = options_of(checked, repeat, timeout_s);
    Outcome outcome;
    {
      GilRelease release;
      outcome = pending->plan(link, atomic, options);
      if (outcome.ok()) {
        pending->submit(link, pending);
      }
    }
    raise_unless_ok(outcome);
    return pending;
  }

  void withdraw(Link& link) {
    GilRelease release;
    link.withdraw(call_);
  }

  nb::object result(Link& link) {
    Outcome outcome;
    {
      GilRelease release;
      outcome = link.result(call_);
    }
    raise_unless_ok(outcome);
    if (writes_) {
      return nb::none();
    }
    auto copy = std::make_unique<std::uint32_t[]>(values_.size());
    std::copy(values_.begin(), values_.end(), copy.get());
    return array_of(std::move(copy), {values_.size()});
  }

 private:
  Outcome plan(Link& link, bool atomic, const RequestOptions& options) {
    if (writes_) {
      return link.plan_write_many(call_, addresses_, values_, options);
    }
    return addresses_.size() == 1 ? link.plan_read_each(call_, addresses_, values_, options)
                                  : link.plan_read_many(call_, addresses_, values_, atomic, options);
  }

  void submit(Link& link, const std::shared_ptr<Pending>& self) {
    left_ = call_.exchanges.size();
    if (left_ == 0) {
      mailbox_->post(ticket_);
      return;
    }
    self_ = self;
    for (Exchange& exchange : call_.exchanges) {
      exchange.owner = this;
      exchange.on_done = [](Exchange& done) noexcept { static_cast<Pending*>(done.owner)->one_done(); };
    }
    link.submit(call_);
  }

  void one_done() {
    if (--left_ == 0) {
      const std::shared_ptr<Pending> self = std::move(self_);
      mailbox_->post(ticket_);
    }
  }

  std::shared_ptr<Mailbox> mailbox_;
  std::uint64_t ticket_;
  bool writes_ = false;
  std::vector<std::uint32_t> addresses_;
  std::vector<std::uint32_t> values_;
  Call call_;
  std::size_t left_ = 0;
  std::shared_ptr<Pending> self_;
};

nb::dict statistics(Link& link) {
  Statistics counted;
  {
    GilRelease release;
    counted = link.statistics();
  }
  nb::dict result;
#define UNITYLINK_COUNTER(name) result[#name] = counted.name
  UNITYLINK_COUNTER(requests);
  UNITYLINK_COUNTER(replies);
  UNITYLINK_COUNTER(device_errors);
  UNITYLINK_COUNTER(retries);
  UNITYLINK_COUNTER(timeouts);
  UNITYLINK_COUNTER(fences);
  UNITYLINK_COUNTER(checksum_errors);
  UNITYLINK_COUNTER(malformed_messages);
  UNITYLINK_COUNTER(datalink_errors);
  UNITYLINK_COUNTER(stale_replies);
  UNITYLINK_COUNTER(garbage_bytes);
  UNITYLINK_COUNTER(publishes);
  UNITYLINK_COUNTER(unclaimed_publishes);
  UNITYLINK_COUNTER(mismatched_publishes);
  UNITYLINK_COUNTER(overruns);
  UNITYLINK_COUNTER(bytes_sent);
  UNITYLINK_COUNTER(bytes_received);
  UNITYLINK_COUNTER(posts);
  UNITYLINK_COUNTER(missing_publishes);
  UNITYLINK_COUNTER(sessions);
  UNITYLINK_COUNTER(restarts);
  UNITYLINK_COUNTER(reconnections);
#undef UNITYLINK_COUNTER
  return result;
}

nb::dict configuration(const Link& link) {
  const Configuration& told = link.configuration();
  nb::dict result;
  result["address_bytes"] = told.address_bytes;
  result["data_bytes"] = told.data_bytes;
  result["read_many"] = told.read_many;
  result["publish_mode"] = told.publish_mode;
  result["base_hz"] = told.base_hz;
  result["groups"] = told.groups;
  result["group_size"] = told.group_size;
  result["rate_bytes"] = told.rate_bytes;
  result["discovered"] = told.discovered;
  return result;
}

}  // namespace

void bind_link(nb::module_& module) {
  using namespace nb::literals;
  nb::class_<Mailbox>(module, "Mailbox")
      .def_prop_ro("descriptor", &Mailbox::descriptor)
      .def("collect", &Mailbox::collect)
      .def("post", &Mailbox::post, "ticket"_a);
  module.def("mailbox", [] { return std::make_shared<Mailbox>(); });
  nb::class_<Pending>(module, "Pending")
      .def("result", &Pending::result, "link"_a)
      .def("withdraw", &Pending::withdraw, "link"_a);
  nb::class_<Link> link(module, "NativeLink");
  bind_framed(link);
  bind_line(link);
  bind_loop(link);
  link.def("read", &read, "address"_a, "checked"_a.none(), "repeat"_a, "timeout_s"_a.none())
      .def("write", &write, "address"_a, "value"_a, "checked"_a.none(), "repeat"_a, "timeout_s"_a.none())
      .def("read_many", &read_many, "addresses"_a, "atomic"_a, "checked"_a.none(), "repeat"_a, "timeout_s"_a.none())
      .def("read_each", &read_each, "addresses"_a, "checked"_a.none(), "repeat"_a, "timeout_s"_a.none())
      .def("write_many", &write_many, "addresses"_a, "values"_a, "checked"_a.none(), "repeat"_a, "timeout_s"_a.none())
      .def("start", &Pending::start, "mailbox"_a, "ticket"_a, "addresses"_a, "values"_a.none(), "atomic"_a,
           "checked"_a.none(), "repeat"_a, "timeout_s"_a.none())
      .def("subscribe", &subscribe<Link>, "addresses"_a, "divisor"_a, "on_event"_a, "verify"_a, "ring"_a,
           "group"_a.none())
      .def("unsubscribe", &unsubscribe<Link>, "id"_a)
      .def("drain", &drain, "id"_a, "words"_a)
      .def("take_single", &take_single, "id"_a, "words"_a)
      .def("subscribed", &Link::subscribed, "id"_a, nb::call_guard<GilRelease>())
      .def("wait", &wait_publish, "id"_a, "timeout_s"_a)
      .def("available", &Link::available, "id"_a, nb::call_guard<GilRelease>())
      .def("lost", &Link::lost, "id"_a, nb::call_guard<GilRelease>())
      .def("wait_publishes", &Link::wait_publishes, "seen"_a, "timeout_ns"_a, nb::call_guard<GilRelease>())
      .def("notify_publishes", &Link::notify_publishes, "descriptor"_a, nb::call_guard<GilRelease>())
      .def("forget_notification", &Link::forget_notification, "descriptor"_a, nb::call_guard<GilRelease>())
      .def("statistics", &statistics)
      .def_prop_ro("warning", &Link::warning, nb::call_guard<GilRelease>())
      .def_prop_ro("configuration", &configuration)
      .def_prop_ro("usable_group_size", &Link::usable_group_size)
      .def_prop_ro("closed", &Link::closed, nb::call_guard<GilRelease>())
      .def("check_alive", &check_alive)
      .def("disown", &Link::disown)
      .def("close", &Link::close, nb::call_guard<GilRelease>());
  Link::ask_while_waiting(&interrupted);
  module.def("open_link", &open_link, "url"_a);
  module.def("check_link_url", &check_link_url, "url"_a);
}

}  // namespace unitylink::python
