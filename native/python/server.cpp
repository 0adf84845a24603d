// SPDX-License-Identifier: BSD-3-Clause
// The native server for Python: the door, a login at it, and the server of a board.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <utility>

#include "bindings.hpp"
#include "layer0_driver/serve_question.hpp"
#include "link_arguments.hpp"
#include "server/board_server.hpp"
#include "server/conversation.hpp"
#include "server/door.hpp"

namespace nb = nanobind;

namespace unitylink::python {
namespace {

using namespace unitylink::server;

// Without a certificate: no TLS, so nullptr.
std::shared_ptr<const tls::Side> side_of(const std::string& certificate, const std::string& key,
                                         const std::string& authorities) {
  std::shared_ptr<const tls::Side> side;
  if (!certificate.empty()) {
    raise_unless_ok(
        tls::Side::make(tls::Role::server, {.certificate = certificate, .key = key, .authorities = authorities}, side));
  }
  return side;
}

Door* open_door(const std::string& host, std::uint16_t port, const std::string& certificate, const std::string& key,
                const std::string& authorities) {
  std::optional<Door> door;
  Outcome outcome;
  auto side = side_of(certificate, key, authorities);
  {
    GilRelease release;
    outcome = Door::open(host, port, std::move(side), door);
  }
  raise_unless_ok(outcome);
  return new Door(std::move(*door));
}

nb::object wait(Door& door, double timeout_s) {
  std::optional<Knock> knock;
  {
    GilRelease release;
    knock = door.wait(static_cast<std::uint64_t>(timeout_s * 1e9));
  }
  return knock ? nb::cast(std::move(*knock)) : nb::none();
}

using Ranges = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

Addresses addresses_of(const Ranges& pairs) {
  std::vector<Addresses::Range> ranges;
  for (const auto& [first, last] : pairs) {
    ranges.push_back({first, last});
  }
  return Addresses(std::move(ranges));
}

// Addresses are pairs (first, last), rising and apart.
Grant grant_of(const Ranges& reads, const Ranges& writes, const Ranges& leased, bool arm) {
  return {.reads = addresses_of(reads), .writes = addresses_of(writes), .leased = addresses_of(leased), .arm = arm};
}

std::string ask(const std::string& text, const std::string& question, double timeout_s) {
  std::string answer;
  Outcome outcome;
  {
    GilRelease release;
    Url url;
    outcome = parse_url(text, url);
    if (outcome.ok() && url.scheme != "serve") {
      outcome = wrong_url(url, "only a server answers questions: serve://HOST:PORT/BOARD");
    }
    if (outcome.ok()) {
      outcome = ask_server(url, {.timeout_ns = static_cast<std::uint64_t>(timeout_s * 1e9)}, question, answer);
    }
  }
  raise_unless_ok(outcome);
  return answer;
}

nb::list wait_news(BoardServer& server, double timeout_s) {
  std::vector<News> told;
  {
    GilRelease release;
    told = server.wait_news(static_cast<std::uint64_t>(timeout_s * 1e9));
  }
  constexpr const char* kinds[] = {"asks", "left", "gone", "silent", "arms"};
  nb::list result;
  for (const News& news : told) {
    result.append(nb::make_tuple(news.client, kinds[static_cast<std::size_t>(news.kind)], news.address, news.at_ns));
  }
  return result;
}

nb::dict dict_of(const ClientReport& client) {
  nb::dict result;
  result["id"] = client.id;
  result["name"] = client.name;
  result["since_s"] = static_cast<double>(client.since_ns) * 1e-9;
  result["dead_man"] = client.dead_man;
  result["silent_s"] = static_cast<double>(client.silent_ns) * 1e-9;
  result["unsent"] = client.unsent;
  result["requests"] = client.counters.requests;
  result["refused"] = client.counters.refused;
  result["repeats"] = client.counters.repeats;
  result["discarded"] = client.counters.discarded;
  result["publishes"] = client.counters.publishes;
  result["publishes_lost"] = client.counters.publishes_lost;
  return result;
}

nb::dict report(BoardServer& server) {
  ServerReport told;
  {
    GilRelease release;
    told = server.report();
  }
  nb::dict result;
  nb::list clients;
  for (const ClientReport& client : told.clients) {
    clients.append(dict_of(client));
  }
  result["clients"] = clients;
  result["groups"] = told.groups;
  result["trips"] = told.trips;
  result["dropped_silent"] = told.dropped_silent;
  result["dropped_lost"] = told.dropped_lost;
  result["served"] = told.served;
  result["joined"] = told.joined;
  result["waiting"] = told.waiting;
  return result;
}

// Releases the GIL when it is destroyed, because its thread may be in a call of the link.
class PythonServer {
 public:
  PythonServer(Link& link, Addresses plain) : server(link, std::move(plain)) {}
  ~PythonServer() {
    const GilRelease released;
    server.close();
  }
  BoardServer server;
};

// Another thread gives the server an order, and waits.
template <class Call>
void order(nb::handle timeout_s, const Call& call) {
  const RequestOptions options = options_of(nb::none(), false, timeout_s);
  Outcome outcome;
  {
    const GilRelease release;
    outcome = call(options);
  }
  raise_unless_ok(outcome);
}

PythonServer* make_server(Link& link, const Ranges& plain) {
  if (!link.framed()) {
    raise_unless_ok({Status::mismatch, std::string("a server needs gateware with the framed protocol; this link ") +
                                           "speaks the " + link.protocol() + " one"});
  }
  return new PythonServer(link, addresses_of(plain));
}

}  // namespace

void bind_server(nb::module_& module) {
  using namespace nb::literals;
  nb::class_<Knock>(module, "Knock", "A client at the door of a server, which waits for an answer.")
      .def_ro("peer", &Knock::peer)
      .def_prop_ro("version", [](const Knock& self) { return self.login.version; })
      .def_prop_ro("board", [](const Knock& self) { return self.login.board; })
      .def_prop_ro("token", [](const Knock& self) { return self.login.token; })
      .def_ro("certificate", &Knock::certificate)
      .def_prop_ro("asks", [](const Knock& self) { return self.login.asks; })
      .def(
          "converse",
          [](Knock& self, const std::string& text) { return new Conversation(Door::admit(std::move(self), text)); },
          "text"_a)
      .def(
          "refuse",
          [](Knock& self, const std::string& reason, const std::string& text) {
            Door::refuse(std::move(self), reason, text);
          },
          "reason"_a, "text"_a);
  nb::class_<Conversation>(module, "Conversation", "A client at a server that has a question.")
      .def(
          "read_line",
          [](Conversation& self, double timeout_s) {
            const GilRelease release;
            return self.read_line(static_cast<std::uint64_t>(timeout_s * 1e9), protocol::serve::question_max);
          },
          "timeout_s"_a)
      .def(
          "write",
          [](Conversation& self, const std::string& text, double timeout_s) {
            const GilRelease release;
            return self.write(text, static_cast<std::uint64_t>(timeout_s * 1e9));
          },
          "text"_a, "timeout_s"_a)
      .def("end", &Conversation::end);
  module.def("ask_server", &ask, "url"_a, "question"_a, "timeout_s"_a);
  module.def(
      "check_tls",
      [](const std::string& certificate, const std::string& key, const std::string& authorities) {
        static_cast<void>(side_of(certificate, key, authorities));
      },
      "certificate"_a, "key"_a, "authorities"_a);
  nb::class_<Door>(module, "Door", "Where the clients of a server come in.")
      .def(nb::new_(&open_door), "host"_a, "port"_a, "certificate"_a = "", "key"_a = "", "authorities"_a = "")
      .def_prop_ro("place", &Door::place)
      .def("wait", &wait, "timeout_s"_a)
      .def_prop_ro("turned_away", &Door::turned_away);
  nb::class_<PythonServer>(module, "BoardServer", "One board and its clients, in a thread of its own.")
      .def(nb::new_(&make_server), "link"_a, "plain"_a, nb::keep_alive<1, 2>())
      .def(
          "admit",
          [](PythonServer& self, Knock& knock, const std::string& name, const Ranges& reads, const Ranges& writes,
             const Ranges& leased, bool arm, const std::string& text) -> std::uint64_t {
            Grant grant = grant_of(reads, writes, leased, arm);
            Connection connection = Door::admit(std::move(knock), text);
            const GilRelease release;
            return self.server.admit(std::move(connection), name, std::move(grant));
          },
          "knock"_a, "name"_a, "reads"_a, "writes"_a, "leased"_a, "arm"_a, "text"_a)
      .def(
          "set_grant",
          [](PythonServer& self, std::uint64_t id, const Ranges& reads, const Ranges& writes, const Ranges& leased,
             bool arm, std::optional<std::pair<std::string, std::uint32_t>> decided) {
            Grant grant = grant_of(reads, writes, leased, arm);
            std::optional<BoardServer::Decision> decision;
            if (decided) {
              decision = {decided->first == "arms" ? Session::Ask::arm : Session::Ask::lease, decided->second};
            }
            const GilRelease release;
            return self.server.set_grant(id, std::move(grant), decision);
          },
          "id"_a, "reads"_a, "writes"_a, "leased"_a, "arm"_a, "decided"_a.none())
      .def(
          "wait_news", [](PythonServer& self, double timeout_s) { return wait_news(self.server, timeout_s); },
          "timeout_s"_a)
      .def(
          "drop",
          [](PythonServer& self, std::uint64_t id) {
            const GilRelease release;
            return self.server.drop(id);
          },
          "id"_a)
      .def(
          "silent",
          [](PythonServer& self, double limit_s) {
            const GilRelease release;
            return self.server.silent(static_cast<std::uint64_t>(limit_s * 1e9));
          },
          "limit_s"_a)
      .def(
          "trip",
          [](PythonServer& self, nb::handle timeout_s) {
            order(timeout_s, [&](const RequestOptions& how) { return self.server.trip(how); });
          },
          "timeout_s"_a.none())
      .def(
          "arm",
          [](PythonServer& self, nb::handle timeout_s) {
            order(timeout_s, [&](const RequestOptions& how) { return self.server.arm(how); });
          },
          "timeout_s"_a.none())
      .def(
          "subscribe",
          [](PythonServer& self, nb::handle addresses, nb::handle divisor, bool on_event, bool verify, nb::handle ring,
             nb::handle group) { return subscribe(self.server, addresses, divisor, on_event, verify, ring, group); },
          "addresses"_a, "divisor"_a, "on_event"_a, "verify"_a, "ring"_a, "group"_a.none())
      .def(
          "unsubscribe", [](PythonServer& self, std::uint32_t id) { unsubscribe(self.server, id); }, "id"_a)
      .def("report", [](PythonServer& self) { return report(self.server); })
      .def("close", [](PythonServer& self) {
        const GilRelease release;
        self.server.close();
      });
}

}  // namespace unitylink::python
