// SPDX-License-Identifier: BSD-3-Clause
// The wire: which thread polls, reads or waits. link_requests.cpp and link_subscriptions.cpp use run(),
// link_listening.cpp uses lead().
#include "layer2_message/link.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <new>
#include <random>
#include <sys/eventfd.h>
#include <unistd.h>

#include "layer0_driver/polling.hpp"
#include "layer2_message/failure.hpp"
#include "layer2_message/link_state.hpp"

namespace unitylink {
namespace {

// a read from a pseudo-terminal gives at most this much; less means that it is empty
constexpr std::size_t terminal_chunk = 4095;
constexpr int reads_per_turn_max = 16;
constexpr std::uint64_t farewell_ns = 200'000'000;
constexpr std::uint64_t seed_in_steps = 1;  // the same in each run
constexpr const char* closed_here = "closed by this program";

std::atomic<bool (*)() noexcept> ask_interrupted = nullptr;

void signal(int descriptor) noexcept {
  const std::uint64_t one = 1;
  static_cast<void>(!::write(descriptor, &one, sizeof one));
}

}  // namespace

Link::Link(std::unique_ptr<Driver> driver, std::unique_ptr<DriverSource> source, const LinkOptions& options)
    : options_(options),
      clock_(driver->time_source()),
      step_(step_of(*this, clock_)),
      driver_(std::move(driver)),
      source_(std::move(source)),
      wake_descriptor_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)),
      cancel_descriptor_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)),
      classic_(options.engine),
      pace_(options.spin_ns),
      gateware_(options.gateware) {
  join_steps();
}

Link::~Link() { close(); }

Outcome Link::open(std::string_view text, std::unique_ptr<Link>& link) {
  Url url;
  LinkOptions options;
  if (Outcome outcome = parse_url(text, url); !outcome.ok()) {
    return outcome;
  }
  if (Outcome outcome = parse_options(url, options); !outcome.ok()) {
    return outcome;
  }
  auto source = std::make_unique<DriverSource>(url, options.engine.timeout_ns * options.attempts);
  std::unique_ptr<Driver> driver;
  if (Outcome outcome = source->open(driver); !outcome.ok()) {
    return outcome;
  }
  Outcome outcome = open(std::move(driver), std::move(source), options, link);
  // with UDP, only the first datagram shows that nobody is there
  if (outcome.status == Status::closed && url.row->loses_order) {
    outcome.status = Status::not_found;
  }
  if (!outcome.ok()) {
    outcome.text = url.text + ": " + outcome.text;
  }
  return outcome;
}

Outcome Link::open(std::unique_ptr<Driver> driver, const LinkOptions& options, std::unique_ptr<Link>& link) {
  return open(std::move(driver), nullptr, options, link);
}

Outcome Link::open(std::unique_ptr<Driver> driver, std::unique_ptr<DriverSource> source, const LinkOptions& options,
                   std::unique_ptr<Link>& link) {
  LinkOptions settled = options;
  settled.engine.byte_time_ns = driver->byte_time_ns();
  if (settled.engine.seed == 0 && driver->time_source() != &real_ns && RobotTime::here().in_steps()) {
    settled.engine.seed = seed_in_steps;
  } else if (settled.engine.seed == 0) {
    std::random_device random;
    settled.engine.seed = std::uint64_t{random()} << 32 | random();
  }
  std::unique_ptr<Link> opened(new Link(std::move(driver), std::move(source), settled));
  if (!opened->wake_descriptor_.open() || !opened->cancel_descriptor_.open()) {
    return {Status::closed, std::string("no descriptor to wake threads with: ") + std::strerror(errno)};
  }
  Outcome outcome = opened->begin();
  if (outcome.ok()) {
    if (options.reconnect && opened->source_ != nullptr) {
      opened->last();
    }
    link = std::move(opened);
  }
  return outcome;
}

// ---- the role of the leader

void Link::run(std::span<Exchange> exchanges, std::uint64_t until_ns) {
  Lock lock(mutex_);
  const bool waits = waits_for_line(exchanges);
  const std::uint64_t line_ns = waits ? std::min(until_ns, now_ns() + options_.wait_ns) : 0;
  do {
    run_once(lock, exchanges, until_ns);
  } while (waits && was_cut(exchanges) && wait_for_line(lock, line_ns));
}

void Link::run_once(Lock& lock, std::span<Exchange> exchanges, std::uint64_t until_ns) {
  std::uint64_t now = now_ns();
  std::uint64_t look_ns = std::min(until_ns, now + interruption_patience_ns);
  submit_all(exchanges);
  // they were refused, or mapped memory has executed them: no need to wait
  if (std::ranges::all_of(exchanges, &Exchange::done)) {
    if (leading_ && engine_->next_deadline_ns() < leading_until_ns_) {
      wake();
    }
    return;
  }
  ++callers_;
  if (reader_leading_) {
    wake();  // so that this caller reads its answer itself, which is quicker than being woken for it
  }
  std::size_t done = 0;
  while (true) {
    while (done < exchanges.size() && exchanges[done].done()) {
      ++done;
    }
    if (done == exchanges.size()) {
      break;
    }
    turn(lock, look_ns);
    now = now_ns();
    if (now >= look_ns) {
      look_ns = std::min(until_ns, now + interruption_patience_ns);
      if (now >= until_ns || interrupted(lock)) {
        engine_->abandon(exchanges, now_ns());
        flush(engine_->now_ns());
        wake();
      }
    }
  }
  --callers_;
  last_call_ns_ = engine_->now_ns();
  last_caller_ = std::this_thread::get_id();
  hand_over();
}

// Submits the requests. While the line is gone they are declined, and so are done at once.
void Link::submit_all(std::span<Exchange> exchanges) noexcept {
  const std::uint64_t now = now_ns();
  const bool taken = takes_requests();
  for (Exchange& exchange : exchanges) {
    if (taken) {
      engine_->submit(exchange, now);
    } else {
      engine_->decline(exchange, Status::down, now);
    }
  }
  flush(now);
}

// Waits once: as the leader at the descriptor, or as a follower for the leader.
void Link::turn(Lock& lock, std::uint64_t until_ns) noexcept {
  if (!leading_) {
    lead(lock, until_ns);
    touch_steps();
    return;
  }
  if (blocked_ || engine_->next_deadline_ns() < leading_until_ns_) {
    wake();
  }
  ++followers_;
  wait(lock, turn_, until_ns);
  --followers_;
}

// May return too early, because robot time may be slower than real time. Then the caller checks its condition, and
// waits again.
void Link::wait(Lock& lock, std::condition_variable& news, std::uint64_t until_ns) const noexcept {
  news.wait_for(lock, std::chrono::nanoseconds(until_ns - std::min(until_ns, now_ns())));
}

bool Link::interrupted(Lock& lock) noexcept {
  bool (*const ask)() noexcept = ask_interrupted;
  if (ask == nullptr) {
    return false;
  }
  lock.unlock();
  const bool answer = ask();
  lock.lock();
  return answer;
}

void Link::ask_while_waiting(bool (*interrupted)() noexcept) noexcept { ask_interrupted = interrupted; }

void Link::hand_over() noexcept {
  if (followers_ > 0) {
    turn_.notify_all();
  }
}

void Link::wake() noexcept {
  woken_ = true;
  signal(wake_descriptor_.get());
}

// Sends the bytes of the engine, as many as the driver takes.
void Link::flush(std::uint64_t now) noexcept {
  blocked_ = false;
  if (!leading_) {
    touch_steps();
  }
  if (now < silent_until_ns_) {
    return;
  }
  if (!program_lives() && line_ != Line::gone && !engine_->ended()) {
    lose(Status::closed,
         in_words([&] { return "the program gave no sign of life for " + duration_text(program_patience_ns_); }));
  }
  while (!engine_->ended() && line_ != Line::gone) {
    // the clock is read here, and not earlier: a request may have a time after which it must not be sent
    const std::span<const std::uint8_t> bytes = engine_->transmit(std::max(now, now_ns()));
    if (bytes.empty()) {
      return;
    }
    const Transfer transfer = driver_->send(bytes);
    if (transfer.status != Status::ok) {
      lose(transfer.status, in_words([&] { return driver_->reason(); }));
      return;
    }
    if (transfer.count == 0) {
      blocked_ = true;
      return;
    }
    engine_->sent(transfer.count);
  }
}

// Leads once: waits at the descriptor, reads, dispatches, sends. It gives the lock back only while it waits and reads.
// It also ends when `other` is readable (-1: none).
void Link::lead(Lock& lock, std::uint64_t until_ns, int other) noexcept {
  leading_ = true;
  const std::uint64_t until = std::min({until_ns, engine_->next_deadline_ns(), program_until_ns_.load()});
  leading_until_ns_ = until;
  const std::uint64_t completed = engine_->completed();
  const std::uint64_t published = engine_->statistics().publishes;
  pollfd waiting[3] = {{driver_->descriptor(), static_cast<short>(blocked_ ? POLLIN | POLLOUT : POLLIN), 0},
                       {wake_descriptor_.get(), POLLIN, 0},
                       {other, POLLIN, 0}};
  // not in robot time, because it advances only while the callers sleep
  const bool paced = callers_ > 0 && !reader_leading_ && clock_ == &real_ns;
  const std::uint64_t start = paced ? real_ns() : 0;
  const std::uint64_t look_until = std::min(until, start + (paced ? pace_.look_ns() : 0));
  lock.unlock();

  int ready = 0;
  while (ready == 0 && paced && real_ns() < look_until) {
    ready = poll_for(waiting, 0);
    if (ready == 0) {
      ::sched_yield();  // the one that replies may wait for this very processor
    }
  }
  if (ready == 0) {
    ready = poll_until(until, waiting);
  }
  const bool readable = driver_->local_line() != nullptr ||
                        (ready > 0 && (waiting[0].revents & (POLLIN | POLLHUP | POLLERR | POLLNVAL)) != 0);
  if (woken_.exchange(false) || (ready > 0 && waiting[1].revents != 0)) {
    std::uint64_t count = 0;
    static_cast<void>(!::read(wake_descriptor_.get(), &count, sizeof count));
  }
  Transfer transfer;
  if (readable) {
    transfer = driver_->receive(received_);
  }
  lock.lock();
  if (paced && readable) {
    pace_.waited(real_ns() - start);
  }

  for (int turn = 1; readable && !engine_->ended() && line_ != Line::gone; ++turn) {
    if (transfer.status != Status::ok) {
      lose(transfer.status, in_words([&] { return driver_->reason(); }));
    } else if (transfer.count > 0) {
      heard_ns_ = now_ns();
      engine_->receive(std::span<const std::uint8_t>(received_.data(), transfer.count), heard_ns_);
      if (transfer.count >= terminal_chunk && turn < reads_per_turn_max) {
        transfer = driver_->receive(received_);
        continue;
      }
    }
    break;
  }
  const std::uint64_t now = now_ns();
  engine_->advance(now);
  flush(now);
  notice_restarts();
  leading_ = false;
  if (engine_->completed() != completed || engine_->ended()) {
    hand_over();
  }
  if (engine_->statistics().publishes != published || engine_->ended()) {
    announce();
  }
}

// Wakes all threads that wait for publishes: there are new ones, or there will be no more.
void Link::announce() noexcept {
  published_.notify_all();
  if (leading_) {
    wake();  // otherwise the leader, which polls, would notice only at its own deadline
  }
  for (const int descriptor : notified_) {
    signal(descriptor);
  }
}

void Link::fail(Status status, std::string_view reason) noexcept {
  if (!engine_->ended()) {
    reason_ = in_words([&] { return std::string(reason); });
    engine_->end(status, now_ns());
  }
  turn_.notify_all();
  announce();
}

// ---- the end

bool Link::closed() {
  const std::scoped_lock lock(mutex_);
  return engine_->ended().has_value();
}

void Link::close() {
  bool publishing = false;
  {
    const std::scoped_lock lock(mutex_);
    publishing = !engine_->ended() &&
                 std::any_of(subscriptions_.begin(), subscriptions_.end(), [](const auto& s) { return s && s->open; });
  }
  bool listens = false;
  {
    const std::scoped_lock lock(mutex_);
    listens = !engine_->ended() && line_ == Line::up;
  }
  if (framed_ && listens) {  // then other hosts, and classic writes, may use the device
    Exchange exchange;
    prepare(exchange, {.checked = std::nullopt, .repeat = true, .timeout_ns = 0});
    exchange.operation = Operation::close_session;
    run(std::span(&exchange, 1), now_ns() + farewell_ns);
  } else if (publishing && listens) {  // otherwise the next program would receive these publishes
    Exchange exchange;
    prepare(exchange, {.checked = std::nullopt, .repeat = true, .timeout_ns = 0});
    exchange.operation = Operation::disable_publishing;
    run(std::span(&exchange, 1), now_ns() + farewell_ns);
  }
  {
    const std::scoped_lock lock(mutex_);
    fail(Status::closed, closed_here);
  }
  signal(cancel_descriptor_.get());
  stop_reader();
  leave_steps();
  Lock lock(mutex_);
  while (leading_) {
    wake();
    ++followers_;
    turn_.wait(lock);
    --followers_;
  }
  if (driver_ != nullptr) {
    driver_->close();
  }
  if (source_ != nullptr) {
    source_->close();
  }
}

void Link::disown() noexcept {
  // The old ones may be locked by threads that do not exist in this process.
  for (std::mutex* mutex : {&mutex_, &configuring_, &reader_mutex_}) {
    new (mutex) std::mutex;
  }
  for (std::condition_variable* condition : {&turn_, &published_, &idle_}) {
    new (condition) std::condition_variable;
  }
  if (reader_.joinable()) {
    reader_.detach();
  }
  leading_ = reader_leading_ = reader_rests_ = reader_wanted_ = false;
  followers_ = callers_ = listeners_ = 0;
  notified_.clear();
  reason_ = in_words(
      [] { return std::string("it belongs to the process that this one was forked from; open another here"); });
  engine_->forget(Status::closed);
  if (driver_ != nullptr) {
    driver_->disown();
  }
  if (source_ != nullptr) {
    source_->disown();
  }
}

std::string Link::warning() {
  const std::scoped_lock lock(mutex_);
  return driver_ != nullptr ? driver_->warning() : std::string();
}

Outcome Link::ending(bool& by_itself) {
  const std::scoped_lock lock(mutex_);
  by_itself = engine_->ended() && reason_ != closed_here;
  if (!engine_->ended()) {
    return {};
  }
  return end();
}

Outcome Link::end() const {
  const Status status = *engine_->ended();
  if (!reason_.empty()) {
    return {status, "the link is closed (" + reason_ + ")"};
  }
  return {status,
          status == Status::mismatch ? "another device now answers on this port; connect again" : status_text(status)};
}

Statistics Link::statistics() {
  const std::scoped_lock lock(mutex_);
  return engine_->statistics();
}

}  // namespace unitylink
