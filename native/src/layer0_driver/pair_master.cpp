// SPDX-License-Identifier: BSD-3-Clause
#include "layer0_driver/pair_master.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <linux/serial.h>
#include <new>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <system_error>
#include <unistd.h>

#include "layer0_driver/pair_token.hpp"
#include "layer0_driver/polling.hpp"
#include "layer0_driver/serial_driver.hpp"

namespace unitylink::pair_bus {
namespace {

constexpr std::size_t turn_bytes = 1024;  // sent to one node in one turn; a longer frame is sent whole
// a node that had something to send is polled without a pause for so long
constexpr std::chrono::milliseconds linger{1};
constexpr std::chrono::milliseconds absent_poll{250};  // each poll of an absent node costs the time `silence`
constexpr unsigned misses_most = 3;

std::mutex masters_mutex;
std::map<std::string, std::weak_ptr<Master>>& masters() {
  static std::map<std::string, std::weak_ptr<Master>> all;
  return all;
}

// Asks the kernel to switch the transceiver by RTS. Adapters that switch it themselves refuse this, which does no harm.
void ask_direction(int descriptor) noexcept {
  serial_rs485 settings{};
  settings.flags = SER_RS485_ENABLED | SER_RS485_RTS_ON_SEND;
  static_cast<void>(::ioctl(descriptor, TIOCSRS485, &settings));
}

bool poll_until(std::span<pollfd> waiting, std::chrono::steady_clock::time_point until) noexcept {
  const auto left =
      std::max(std::chrono::nanoseconds(0), std::chrono::nanoseconds(until - std::chrono::steady_clock::now()));
  return poll_for(waiting, static_cast<std::uint64_t>(left.count())) > 0;
}

bool wait(const Driver& port, short events, std::chrono::steady_clock::time_point until) noexcept {
  pollfd waiting{port.descriptor(), events, 0};
  return poll_until(std::span(&waiting, 1), until);
}

}  // namespace

struct Master::Node {
  Node(const Settings& told, Descriptor end) : settings(told), far(std::move(end)) {}

  // `out` is what the link wants to send. `in` is for the link, which has not fetched it yet.
  void collect() {
    std::uint8_t bytes[4096];
    while (out.size() < 4 * turn_bytes) {
      const ssize_t count = ::recv(far.get(), bytes, sizeof bytes, MSG_DONTWAIT);
      if (count <= 0) {
        return;
      }
      out.insert(out.end(), bytes, bytes + count);
    }
  }
  [[nodiscard]] bool hand_on() {
    const ssize_t count = in.empty() ? 0 : ::send(far.get(), in.data(), in.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    in.erase(in.begin(), in.begin() + std::max<ssize_t>(count, 0));
    return in.empty();
  }
  // The bytes of the whole frames at the front of `out`, as many as fit into one turn.
  [[nodiscard]] std::size_t whole() const {
    const auto end = out.size() <= turn_bytes ? out.end() : out.begin() + turn_bytes;
    const auto last = std::find(std::make_reverse_iterator(end), out.rend(), border);
    if (last != out.rend()) {
      return static_cast<std::size_t>(last.base() - out.begin());
    }
    const auto first = std::find(end, out.end(), border);
    return first == out.end() ? 0 : static_cast<std::size_t>(first - out.begin()) + 1;
  }

  const Settings settings;
  const Descriptor far;
  std::vector<std::uint8_t> out, in;
  Clock::time_point next = Clock::now();  // when it is polled even if there is nothing to send
  Clock::time_point busy_until{};
  unsigned misses = 0;
};

Outcome Master::of(const Url& url, const Settings& settings, std::shared_ptr<Master>& shared) {
  char* const real = ::realpath(url.path.c_str(), nullptr);
  const std::string path = real != nullptr ? real : url.path;
  std::free(real);
  const std::scoped_lock lock(masters_mutex);
  shared = masters()[path].lock();
  if (shared != nullptr && shared->reason().empty()) {
    return shared->baud_ == settings.baud
               ? Outcome{}
               : Outcome{Status::mismatch, "RS-485 port " + url.path + ": the other nodes on it are spoken to at " +
                                               shared->baud_ + " baud, and " + settings.baud +
                                               " are asked; all on a pair have the same rate"};
  }
  std::unique_ptr<Driver> port;
  if (Outcome outcome = open_serial(url, {}, port); !outcome.ok()) {
    return outcome;
  }
  ask_direction(port->descriptor());
  shared = std::make_shared<Master>(std::move(port), settings.baud);
  masters()[path] = shared;
  return {};
}

void Master::disown(std::shared_ptr<Master> shared) {
  new (&masters_mutex) std::mutex;  // the old one may be locked by a thread that does not exist in this process
  masters().clear();
  // never deleted: its destructor would wait for a thread that does not exist here
  static_cast<void>(new std::shared_ptr<Master>(std::move(shared)));
}

Master::Master(std::unique_ptr<Driver> port, std::string baud)
    : port_(std::move(port)), baud_(std::move(baud)), wake_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (!wake_.open()) {
    throw std::system_error(errno, std::generic_category());
  }
  thread_ = std::thread([this] { serve(); });
}

Master::~Master() {
  stop_ = true;
  const std::uint64_t one = 1;
  static_cast<void>(!::write(wake_.get(), &one, sizeof one));
  thread_.join();
}

Outcome Master::join(const Settings& settings, Descriptor far) {
  auto node = std::make_shared<Node>(settings, std::move(far));
  const std::scoped_lock lock(mutex_);
  if (!why_.empty()) {
    return {Status::closed, why_};
  }
  if (!nodes_.emplace(settings.node, std::move(node)).second) {
    return {Status::busy, "node " + std::to_string(settings.node) + " on this pair has a link in this program already"};
  }
  const std::uint64_t one = 1;
  static_cast<void>(!::write(wake_.get(), &one, sizeof one));
  return {};
}

void Master::leave(unsigned node) {
  const std::scoped_lock lock(mutex_);
  nodes_.erase(node);
}

std::string Master::reason() const {
  const std::scoped_lock lock(mutex_);
  return why_;
}

void Master::fail(const std::string& why) noexcept {
  const std::scoped_lock lock(mutex_);
  try {
    why_ = why;
  } catch (const std::bad_alloc&) {
    why_ = "out of memory";  // short enough to need none
  }
  port_->close();  // now, so that another master can open the port even if a link of this one is not closed yet
  for (const auto& [number, node] : nodes_) {
    ::shutdown(node->far.get(), SHUT_RDWR);
  }
}

void Master::serve() noexcept {
  try {
    give_turns();
  } catch (const std::bad_alloc&) {
    fail("out of memory");
  }
}

void Master::give_turns() {
  while (!stop_) {
    std::vector<std::shared_ptr<Node>> nodes;
    {
      const std::scoped_lock lock(mutex_);
      for (const auto& [number, node] : nodes_) {
        nodes.push_back(node);
      }
    }
    Clock::time_point next = Clock::now() + absent_poll;
    for (const auto& node : nodes) {
      node->collect();
      const bool free = node->hand_on();  // false: its link does not fetch its bytes, so the node gets no turn, and its
                                          // gateware waits
      if (free && (node->whole() > 0 || Clock::now() >= node->next)) {
        if (!give_turn(*node)) {
          fail(port_->reason());
          return;
        }
        static_cast<void>(node->hand_on());
      }
      next = std::min(next, free ? node->next : Clock::now() + linger);
    }
    pause(next);
  }
}

// Waits until this time, or until there is something to send, or a node was added.
void Master::pause(Clock::time_point until) {
  std::vector<pollfd> waiting{{wake_.get(), POLLIN, 0}};
  {
    const std::scoped_lock lock(mutex_);
    for (const auto& [number, node] : nodes_) {
      waiting.push_back({node->far.get(), static_cast<short>(node->out.size() < 4 * turn_bytes ? POLLIN : 0), 0});
    }
  }
  if (poll_until(waiting, until) && waiting[0].revents != 0) {
    std::uint64_t count = 0;
    static_cast<void>(!::read(wake_.get(), &count, sizeof count));
  }
}

bool Master::give_turn(Node& node) {
  const auto add = [](std::vector<std::uint8_t>& bytes, const auto& more) {
    bytes.insert(bytes.end(), more.begin(), more.end());
  };
  const auto count = static_cast<std::ptrdiff_t>(node.whole());
  std::vector<std::uint8_t> bytes{border};
  if (count > 0) {
    add(bytes, token(node.settings.node, false));
    bytes.insert(bytes.end(), node.out.begin(), node.out.begin() + count);
    node.out.erase(node.out.begin(), node.out.begin() + count);
  }
  add(bytes, token(node.settings.node, true));
  if (!say(bytes)) {
    return false;
  }
  const std::chrono::nanoseconds silence(node.settings.silence_ns);
  Clock::time_point patience = Clock::now() + silence + std::chrono::nanoseconds(bytes.size() * byte_time_ns());
  Answer answer(node.settings.node);
  std::uint8_t room[4096];
  bool ended = false;
  while (!ended && !stop_ && wait(*port_, POLLIN, patience)) {
    const Transfer transfer = port_->receive(room);
    if (transfer.status != Status::ok) {
      return false;
    }
    ended = answer.take(std::span(room, transfer.count));
    patience = std::max(patience, Clock::now() + silence);
  }
  node.in.insert(node.in.end(), answer.frames().begin(), answer.frames().end());
  const Clock::time_point now = Clock::now();
  node.misses = answer.spoke() ? 0 : node.misses + 1;
  if (count > 0 || !answer.frames().empty()) {
    node.busy_until = now + linger;
  }
  node.next = node.misses > misses_most ? now + absent_poll
              : now < node.busy_until   ? now
                                        : now + std::chrono::nanoseconds(node.settings.poll_ns);
  return true;
}

bool Master::say(const std::vector<std::uint8_t>& bytes) {
  std::span<const std::uint8_t> left(bytes);
  while (!left.empty() && !stop_) {
    const Transfer transfer = port_->send(left);
    if (transfer.status != Status::ok) {
      return false;
    }
    left = left.subspan(transfer.count);
    if (transfer.count == 0) {
      static_cast<void>(wait(*port_, POLLOUT, Clock::now() + absent_poll));
    }
  }
  return true;
}

}  // namespace unitylink::pair_bus
