// SPDX-License-Identifier: BSD-3-Clause
// One board and its clients, in one thread. This thread waits for all of them at once and leads the link, so a request
// passes from the client's socket to the board's line without being handed to another thread.
//
// All clients lose their connections when the line to the board is lost, when the board was reset, and when it did not
// answer a client's request (that client alone). So nothing that a client asked for before that is sent after it.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "layer0_driver/descriptor.hpp"
#include "server/connection.hpp"
#include "server/fan_out.hpp"
#include "server/session.hpp"
#include "server/unlocked.hpp"
#include "server/upstream.hpp"

namespace unitylink::server {

struct ClientReport {
  std::uint64_t id = 0;
  std::string name;
  std::uint64_t since_ns = 0;
  bool dead_man = false;
  std::uint64_t silent_ns = 0;  // since its last frame
  std::size_t unsent = 0;       // bytes that the client has not taken
  Counters counters;
};

struct ServerReport {
  std::vector<ClientReport> clients;
  std::size_t groups = 0;            // publish groups of the board that are in use
  std::uint64_t trips = 0;           // of the dead-man, by this server or noticed by it
  std::uint64_t dropped_silent = 0;  // clients that did not take what was sent
  std::uint64_t dropped_lost = 0;    // clients dropped, because the line or an answer was lost
  std::uint64_t served = 0;          // clients that have come so far
  std::uint64_t joined = 0;          // reads that were answered by an equal one of another client
  std::size_t waiting = 0;           // requests that wait for the line to the board
};

// What the one who governs has to know.
struct News {
  enum class Kind : std::uint8_t {
    asks,    // the client needs the write lease of `address`
    left,    // it has closed its link, and then its connection
    gone,    // its connection has ended, without that
    silent,  // its dead-man has tripped
    arms,    // it wants that writes are allowed again
  };
  std::uint64_t client = 0;
  Kind kind = Kind::asks;
  std::uint32_t address = 0;
  std::uint64_t at_ns = real_ns();  // when that was, by real_ns()
};

class BoardServer final : public Host {
 public:
  // The link must be framed. It must exist as long as the server. Reads of `plain` addresses have no side effect.
  BoardServer(Link& link, Addresses plain);
  ~BoardServer();

  // Takes a client that has logged in. `name` is that of its user: clients of one name share the turns of one.
  // Returns its number. A server that has ended ends the connection at once.
  std::uint64_t admit(Connection connection, std::string name, Grant grant);
  // Changes what a client may do. `decided` answers what it has asked for (Session::resume). False: it is gone.
  struct Decision {
    Session::Ask what = Session::Ask::nothing;
    Session::Status outcome = 0;
  };
  bool set_grant(std::uint64_t id, Grant grant, std::optional<Decision> decided);
  // Waits for news. Each is told once.
  [[nodiscard]] std::vector<News> wait_news(std::uint64_t timeout_ns);
  bool drop(std::uint64_t id);
  // The clients that have sent no frame for so long.
  [[nodiscard]] std::vector<std::uint64_t> silent(std::uint64_t limit_ns);
  // As those of the link, and the clients' dead-men know of it. A trip waits for no other request, and wins against an
  // arm that is under way. The thread of the server arms; another one waits.
  [[nodiscard]] Outcome trip(const RequestOptions& how);
  [[nodiscard]] Outcome arm(const RequestOptions& how);
  // Likewise. A group that a client reads, too, is shared with it.
  [[nodiscard]] Outcome subscribe(const SubscriptionRequest& request, std::uint32_t& id);
  [[nodiscard]] Outcome unsubscribe(std::uint32_t id);
  [[nodiscard]] ServerReport report();
  // Drops all clients and ends the thread. A dead-man that runs for a client trips first.
  void close();

 private:
  struct Client;
  struct Order {
    std::function<Outcome(BoardServer&)> act;
    std::optional<Outcome> outcome = std::nullopt;
  };

  // Host
  [[nodiscard]] const Facts& facts() const noexcept override { return facts_; }
  [[nodiscard]] Errand& errand() override { return upstream_.errand(); }
  void discard(Errand& errand) override { upstream_.recycle(errand); }
  void submit(Errand& errand) override { upstream_.submit(errand); }
  void abandon(const Session& session) override { upstream_.abandon(session); }
  [[nodiscard]] std::uint32_t define_group(Session& session, std::uint32_t group,
                                           std::span<const std::uint32_t> addresses, std::uint32_t divisor,
                                           bool on_event) override;
  [[nodiscard]] std::uint32_t set_dead_man() override;
  void ask_for_lease(Session& session, std::uint32_t address) override;
  void ask_to_arm(Session& session, std::uint32_t age_us) override;
  [[nodiscard]] std::uint32_t clock_us() const noexcept override;
  void trip() noexcept override { trip_wanted_ = true; }
  [[nodiscard]] std::uint64_t trips() const noexcept override { return report_.trips; }
  void notice_trip() noexcept override;

  void run();
  void turn(bool up);
  void wait_for_descriptors();
  void harvest();
  void look_at_dead_men();
  void make_safe();
  [[nodiscard]] Outcome ordered(std::function<Outcome(BoardServer&)> act);
  template <class Call>
  [[nodiscard]] Outcome at_board(const Call& call) {
    return while_unlocked(mutex_, upstream_.link(), call);
  }
  void obey(bool ending);
  [[nodiscard]] Outcome arm_board(const RequestOptions& how);
  void tell(News news);
  void tell_of(const Session& session, News::Kind kind, std::uint32_t address, std::uint32_t age_us = 0);
  void receive(Client& client);
  void send(Client& client);
  void watch(Client& client, std::uint32_t wanted);
  void drop_client(std::size_t index);
  void admit_waiting();
  [[nodiscard]] std::uint64_t due_ns() const noexcept;
  void wake() noexcept;

  std::mutex mutex_;  // guards all below the flags; the thread holds it whenever it does not wait
  Facts facts_;
  Upstream upstream_;
  FanOut fan_out_;
  Descriptor epoll_;
  Descriptor wake_;
  std::atomic<bool> ending_ = false;
  std::atomic<bool> trip_wanted_ = false;
  std::atomic<bool> tripped_now_ = false;  // by another thread
  std::atomic<int> tripping_ = 0;          // other threads that do so

  std::vector<std::unique_ptr<Client>> clients_;
  std::vector<std::unique_ptr<Client>> admitted_;
  std::uint64_t clients_made_ = 0;
  std::map<std::string, std::uint32_t> users_;  // all names that have come so far, with a number each
  std::uint64_t generation_ = 0;
  const std::uint32_t own_ticks_;  // the limit that the link had before: the dead-man of the server itself
  std::uint32_t board_ticks_;      // of the board's dead-man
  bool tripped_ = false;
  std::vector<Order*> orders_;  // of other threads
  bool over_ = false;           // the thread obeys no more
  std::condition_variable obeyed_;
  ServerReport report_;
  std::vector<News> news_;
  std::condition_variable told_;
  std::thread thread_;
};

}  // namespace unitylink::server
