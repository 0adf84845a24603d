// SPDX-License-Identifier: BSD-3-Clause
#include "server/board_server.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <utility>

#include "server/board_client.hpp"

namespace unitylink::server {

namespace {

constexpr std::uint64_t patience_ns = 4'000'000'000;  // for a client that takes nothing of what is sent to it
constexpr std::uint64_t look_most_ns = 1'000'000'000;

}  // namespace

BoardServer::BoardServer(Link& link, Addresses plain)
    : facts_{link.configuration(), link.description(), std::move(plain)},
      upstream_(link),
      fan_out_(link, mutex_),
      epoll_(::epoll_create1(EPOLL_CLOEXEC)),
      wake_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)),
      generation_(link.generation()),
      own_ticks_(link.dead_man_ticks()),
      board_ticks_(own_ticks_) {
  epoll_event event{.events = EPOLLIN, .data = {.ptr = nullptr}};
  ::epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, wake_.get(), &event);
  thread_ = std::thread([this] { run(); });
}

BoardServer::~BoardServer() { close(); }

void BoardServer::wake() noexcept {
  const std::uint64_t one = 1;
  static_cast<void>(!::write(wake_.get(), &one, sizeof one));
}

// ---- called by other threads

std::uint64_t BoardServer::admit(Connection connection, std::string name, Grant grant) {
  const std::scoped_lock lock(mutex_);
  const std::uint64_t id = ++clients_made_;
  if (over_) {
    return id;
  }
  const auto user = users_.try_emplace(name, static_cast<std::uint32_t>(users_.size())).first->second;
  admitted_.push_back(std::make_unique<Client>(*this, std::move(connection), std::move(name), user, std::move(grant),
                                               id, upstream_.link().now_ns()));
  report_.served += 1;
  wake();
  return id;
}

bool BoardServer::set_grant(std::uint64_t id, Grant grant, std::optional<Decision> decided) {
  const std::scoped_lock lock(mutex_);
  const auto found = std::ranges::find_if(clients_, [id](const auto& client) { return client->id == id; });
  if (found == clients_.end()) {
    return false;
  }
  (*found)->session.set_grant(std::move(grant));
  if (decided) {
    (*found)->decided = decided;
    wake();
  }
  return true;
}

std::vector<News> BoardServer::wait_news(std::uint64_t timeout_ns) {
  std::unique_lock lock(mutex_);
  told_.wait_for(lock, std::chrono::nanoseconds(timeout_ns), [this] { return !news_.empty(); });
  return std::exchange(news_, {});
}

void BoardServer::ask_for_lease(Session& session, std::uint32_t address) {
  tell_of(session, News::Kind::asks, address);
}

void BoardServer::ask_to_arm(Session& session, std::uint32_t age_us) { tell_of(session, News::Kind::arms, 0, age_us); }

std::uint32_t BoardServer::clock_us() const noexcept { return static_cast<std::uint32_t>(real_ns() / 1000); }

void BoardServer::tell_of(const Session& session, News::Kind kind, std::uint32_t address, std::uint32_t age_us) {
  const auto found = std::ranges::find_if(clients_, [&](const auto& client) { return &client->session == &session; });
  if (found != clients_.end()) {
    const std::uint64_t age_ns = std::uint64_t{1000} * age_us;
    tell({.client = (*found)->id, .kind = kind, .address = address, .at_ns = real_ns() - age_ns});
  }
}

void BoardServer::tell(News news) {
  news_.push_back(news);
  told_.notify_one();
}

bool BoardServer::drop(std::uint64_t id) {
  const std::scoped_lock lock(mutex_);
  const auto found = std::ranges::find_if(clients_, [id](const auto& client) { return client->id == id; });
  if (found == clients_.end()) {
    return false;
  }
  (*found)->gone = true;
  wake();
  return true;
}

std::vector<std::uint64_t> BoardServer::silent(std::uint64_t limit_ns) {
  const std::scoped_lock lock(mutex_);
  const std::uint64_t now = upstream_.link().now_ns();
  std::vector<std::uint64_t> found;
  for (const auto& client : clients_) {
    if (client->session.silent_ns(now) >= limit_ns) {
      found.push_back(client->id);
    }
  }
  return found;
}

ServerReport BoardServer::report() {
  const std::scoped_lock lock(mutex_);
  ServerReport told = report_;
  for (const auto& client : clients_) {
    told.clients.push_back({.id = client->id,
                            .name = client->name,
                            .since_ns = client->since_ns,
                            .dead_man = client->session.dead_man_ticks() > 0,
                            .silent_ns = client->session.silent_ns(upstream_.link().now_ns()),
                            .unsent = client->session.output().size(),
                            .counters = client->session.counters()});
  }
  told.groups = fan_out_.groups();
  told.joined = upstream_.turns().joined();
  told.waiting = upstream_.turns().waiting();
  return told;
}

void BoardServer::close() {
  ending_ = true;
  wake();
  if (thread_.joinable()) {
    thread_.join();
  }
}

// ---- the thread

void BoardServer::run() {
  Link& link = upstream_.link();
  while (!ending_) {
    bool looking = false;
    bool resting = false;
    std::uint64_t until_ns = 0;
    {
      const std::scoped_lock lock(mutex_);
      looking = upstream_.under_way() > 0;
      // While nobody is here, threads of this program that use the link read their answers themselves.
      resting =
          clients_.empty() && admitted_.empty() && orders_.empty() && !looking && !trip_wanted_ && !link.in_steps();
      until_ns = due_ns();
    }
    const bool up = resting ? link.rest(epoll_.get(), until_ns) : link.attend(epoll_.get(), until_ns, looking);
    const std::scoped_lock lock(mutex_);
    turn(up);
  }
  const std::scoped_lock lock(mutex_);
  for (const auto& client : clients_) {
    trip_wanted_ = trip_wanted_ || client->session.dead_man_ticks() > 0;
  }
  make_safe();
  while (!clients_.empty()) {
    drop_client(clients_.size() - 1);
  }
  admitted_.clear();
  while (upstream_.under_way() > 0 && link.attend(-1, link.now_ns() + look_most_ns, false)) {
    harvest();
  }
  harvest();
  link.leave();
  over_ = true;
  obey(true);
}

void BoardServer::turn(bool up) {
  harvest();
  if (!up || generation_ != upstream_.link().generation()) {
    generation_ = upstream_.link().generation();
    board_ticks_ = 0;
    for (const auto& client : clients_) {
      client->gone = true;
      report_.dropped_lost += 1;
    }
  }
  wait_for_descriptors();
  admit_waiting();
  for (const auto& client : clients_) {
    if (const auto decided = std::exchange(client->decided, std::nullopt); decided && !client->gone) {
      client->session.resume(decided->what, decided->outcome);
    }
  }
  look_at_dead_men();
  make_safe();
  obey(false);
  for (const auto& client : clients_) {
    const bool idle = client->watched == EPOLLIN && client->session.output().empty() && client->session.wants_bytes();
    if (!idle && !client->gone) {
      send(*client);
    }
  }
  for (std::size_t index = clients_.size(); index-- > 0;) {
    const Client& client = *clients_[index];
    if (client.session.lost()) {
      report_.dropped_lost += client.gone ? 0 : 1;
    } else if (!client.gone) {
      continue;
    }
    report_.dropped_silent += client.silent ? 1 : 0;
    drop_client(index);
  }
}

// When the thread must look again, even if nothing arrives.
std::uint64_t BoardServer::due_ns() const noexcept {
  const std::uint64_t now = upstream_.link().now_ns();
  std::uint64_t due = now + look_most_ns;
  for (const auto& client : clients_) {
    due = std::min(due, client->session.dead_man_due_ns());
  }
  return trip_wanted_ || !orders_.empty() ? now : due;
}

void BoardServer::harvest() {
  const Upstream::Harvest& arrived = upstream_.harvest();
  for (Errand* const errand : arrived.done) {
    if (errand->session != nullptr) {
      errand->session->finish(*errand);
    }
    for (const Joined& other : errand->joined) {
      errand->id = other.id;
      other.session->finish(*errand);
    }
    upstream_.recycle(*errand);
  }
  upstream_.push();
  for (const Upstream::Publish& publish : arrived.publishes) {
    const auto words = std::span(arrived.words).subspan(publish.begin, publish.end - publish.begin);
    for (const FanOut::Reader& reader : fan_out_.readers(publish.group)) {
      reader.session->publish(reader.group, publish.missing, publish.clock, words);
    }
  }
}

void BoardServer::wait_for_descriptors() {
  std::array<epoll_event, 64> events;
  const int count = ::epoll_wait(epoll_.get(), events.data(), static_cast<int>(events.size()), 0);
  for (int index = 0; index < count; ++index) {
    auto* const client = static_cast<Client*>(events[static_cast<std::size_t>(index)].data.ptr);
    if (client == nullptr) {
      std::uint64_t woken = 0;
      static_cast<void>(!::read(wake_.get(), &woken, sizeof woken));
    } else if (!client->gone) {
      receive(*client);
    }
  }
}

void BoardServer::admit_waiting() {
  for (std::unique_ptr<Client>& client : admitted_) {
    epoll_event event{.events = EPOLLIN, .data = {.ptr = client.get()}};
    client->watched = EPOLLIN;
    client->gone = ::epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, client->connection.get(), &event) != 0;
    clients_.push_back(std::move(client));
  }
  admitted_.clear();
}

void BoardServer::receive(Client& client) {
  std::array<std::uint8_t, tls::Session::all_bytes> room;
  if (!client.session.wants_bytes()) {
    return;
  }
  const Transfer transfer = client.connection.receive(room);
  if (transfer.count > 0) {
    client.session.take(std::span(room).first(transfer.count), upstream_.link().now_ns());
    make_safe();
  }
  client.gone = client.gone || transfer.status != Status::ok;
}

void BoardServer::send(Client& client) {
  const std::span<const std::uint8_t> bytes = client.session.output();
  std::size_t taken = 0;
  Transfer transfer;
  const bool waited = client.connection.unsent();
  if (waited) {
    transfer = client.connection.send({});
  }
  while (taken < bytes.size() && !client.connection.unsent() && transfer.status == Status::ok) {
    transfer = client.connection.send(bytes.subspan(taken));
    taken += transfer.count;
    if (transfer.count == 0) {
      break;
    }
  }
  client.session.sent(taken);
  if (transfer.status != Status::ok) {
    client.gone = true;
    return;
  }
  const bool blocked = !client.session.output().empty() || client.connection.unsent();
  client.stuck_ns = taken > 0 || (waited && !client.connection.unsent()) ? 0 : client.stuck_ns;
  const std::uint64_t now = real_ns();
  client.stuck_ns = !blocked ? 0 : client.stuck_ns == 0 ? now : client.stuck_ns;
  client.silent = blocked && now - client.stuck_ns > patience_ns;
  client.gone = client.gone || client.silent;
  watch(client, (client.session.wants_bytes() ? EPOLLIN : 0u) | (blocked ? EPOLLOUT : 0u));
}

void BoardServer::watch(Client& client, std::uint32_t wanted) {
  if (client.watched != wanted) {
    client.watched = wanted;
    epoll_event event{.events = wanted, .data = {.ptr = &client}};
    ::epoll_ctl(epoll_.get(), EPOLL_CTL_MOD, client.connection.get(), &event);
  }
}

// A client whose dead-man runs has left without CLOSE, so it is dead. Its outputs are made safe before its groups end,
// for which the board is waited for.
void BoardServer::drop_client(std::size_t index) {
  trip_wanted_ = trip_wanted_ || clients_[index]->session.dead_man_ticks() > 0;
  make_safe();
  const std::unique_ptr<Client> client = std::move(clients_[index]);
  clients_.erase(clients_.begin() + static_cast<std::ptrdiff_t>(index));
  upstream_.abandon(client->session);
  fan_out_.remove(client->session);
  const bool in_order = client->session.left_in_order();
  tell({.client = client->id, .kind = in_order ? News::Kind::left : News::Kind::gone, .address = 0});
}

}  // namespace unitylink::server
