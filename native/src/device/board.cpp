// SPDX-License-Identifier: BSD-3-Clause
#include "device/board.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <unistd.h>
#include <utility>

#include "device/board_time.hpp"
#include "device/device.hpp"
#include "layer0_driver/polling.hpp"

namespace unitylink::device {

namespace {

// Without a line, the device may run so far ahead of real time. So a reply is sent at once, and not after a timer.
constexpr std::uint64_t lead_ns = 200'000;
constexpr std::uint64_t pause_least_ns = 100'000;  // the thread's shortest pause when only the clock can give it work
// How often the thread checks for a client that makes no descriptor readable.
constexpr std::uint64_t look_ns = 5'000'000;
// A board that is later than this delays its device clock, so that the other boards need not wait.
constexpr std::uint64_t lag_most_ns = 2 * RobotTime::lag_alone_ns;

}  // namespace

Board::Board(const DeviceConfiguration& configuration, std::unique_ptr<Endpoint> endpoint)
    : Board(std::make_unique<Device>(configuration), std::move(endpoint)) {}

Board::Board(std::unique_ptr<ServedDevice> device, std::unique_ptr<Endpoint> endpoint)
    : device_(std::move(device)), endpoint_(std::move(endpoint)), wake_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  output_.reserve(chunk_bytes);
  lead_ = configuration().byte_clocks() > 0 ? 0 : whole_clocks(lead_ns, configuration().clock_hz);
}

Board::~Board() {
  stop();
  ::close(wake_);
}

void Board::start() {
  const bool in_steps = endpoint_->listen(this);
  RobotTime::here().claim(in_steps);
  started_ = true;
  in_steps_ = in_steps;
  started_ns_ = real_ns();
  start_ns_ = RobotTime::here().now_ns(started_ns_);
  if (in_steps) {
    lead_ = 0;
    Lockstep::here().join(*this);
  } else {
    thread_ = std::thread([this] { serve(); });
  }
}

void Board::stop() {
  stop_ = true;
  wake();
  if (thread_.joinable() && thread_.get_id() != std::this_thread::get_id()) {
    thread_.join();
  }
  if (in_steps_) {
    Lockstep::here().leave(*this);
    const auto lock = enter();
    end();
  }
  if (!thread_.joinable() && std::exchange(started_, false)) {
    RobotTime::here().release(in_steps_);
  }
}

void Board::wake() {
  if (in_steps_) {  // enter() has touched it
    return;
  }
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(wake_, &one, sizeof one);
}

Clock Board::clock_now() const noexcept {
  return whole_clocks(RobotTime::here().now_ns() - start_ns_, configuration().clock_hz) - slip_;
}

std::uint64_t Board::robot_ns(Clock clock) const noexcept {
  return clock == never ? RobotTime::idle : start_ns_ + nanoseconds(clock + slip_, configuration().clock_hz);
}

// Reports when the next work of this board is due. The other boards need not wait until then.
void Board::tell_due() { follower_.due(robot_ns(std::min(device_->next_event(), plant_due()))); }

std::unique_lock<std::mutex> Board::enter() {
  board_waits_.wait(true);
  ++callers_;
  std::unique_lock lock(mutex_);
  --callers_;
  callers_.notify_one();
  if (in_steps_) {
    catch_up();
  } else if (leaves_out_ && start_ns_ > 0 && !stop_) {  // its thread may sleep. What is due is left to it
    const Clock event = device_->next_event();
    run_to_plant(std::min(within_reach(clock_now()), event - std::min<Clock>(event, 1)));
  }
  return lock;
}

void Board::let_in(std::unique_lock<std::mutex>& lock) {
  if (const int callers = callers_; callers > 0) {
    lock.unlock();
    callers_.wait(callers);
    come_back(lock);
  }
}

void Board::come_back(std::unique_lock<std::mutex>& lock) {
  board_waits_ = true;
  lock.lock();
  board_waits_ = false;
  board_waits_.notify_all();
}

void Board::serve() {
  ::prctl(PR_SET_TIMERSLACK, 1000UL, 0UL, 0UL, 0UL);
  std::unique_lock lock(mutex_);
  while (!stop_) {
    bool more = fed_ = false;
    if (look_) {
      if (endpoint_->admit(at_rest_)) {
        ++statistics_.clients;
        forget_output();
      }
      more = feed();
    }
    const Clock now = clock_now();
    Clock target = now + lead_;
    if (fed_) {  // new input is processed at once, even if the device is already a little ahead
      target = std::max(target, std::min(device_->clock() + lead_, now + 4 * lead_));
    }
    const Clock wanted = in_time(target);
    target = within_reach(wanted);
    step_plant(lock, target);
    device_->run_until(target);
    flush();
    tell_due();
    if (stop_ || more || target < wanted || device_->next_event() <= target) {
      let_in(lock);
      look_ = true;
    } else {
      look_ = wait(lock);
    }
  }
  end();
}

void Board::end() {
  endpoint_.reset();  // this shows the client that the board has ended
  follower_.due(RobotTime::idle);
}

// Returns `target`, or an earlier time if the other boards have waited too long for this one. So work cannot pile up.
Clock Board::in_time(Clock target) {
  const Clock due = std::min(plant_due(), device_->next_event());
  const Clock lag_most = whole_clocks(lag_most_ns, configuration().clock_hz);
  if (due == never || target <= due + lag_most) {
    return target;
  }
  const Clock lost = target - due - lag_most;
  slip_ += lost;
  statistics_.time_slipped_s += static_cast<double>(lost) / configuration().clock_hz;
  return target - lost;
}

// Returns `target`, or an earlier time, so that the client does not wait for long.
Clock Board::within_reach(Clock target) const noexcept {
  const Clock clock = device_->clock();
  return target > clock && target - clock > device_->most_at_once() ? clock + device_->most_at_once() : target;
}

// Waits for the time of the next work, for the client and for wake(). False: only the time has come, so that the
// endpoint need not be asked.
bool Board::wait(std::unique_lock<std::mutex>& lock) {
  std::array<pollfd, 3> polled{};
  nfds_t count = 0;
  polled[count++] = {wake_, POLLIN, 0};
  if (const int listener = endpoint_->listener(); listener >= 0) {
    polled[count++] = {listener, POLLIN, 0};
  }
  if (const int client = endpoint_->client(); client >= 0) {
    const bool more = device_->room() > 0 && !endpoint_->ended();
    const short wanted = static_cast<short>((more ? POLLIN : 0) | (output_blocked_ ? POLLOUT : 0));
    polled[count++] = {client, wanted, 0};
  }
  Clock next = std::min(device_->next_event(), plant_due());
  if (!output_blocked_) {
    next = std::min(next, device_->next_output());
  }
  std::uint64_t pause_ns = never;
  if (next != never) {
    const std::uint64_t due = robot_ns(next - std::min(next, lead_));
    const std::uint64_t now = RobotTime::here().now_ns();
    pause_ns = std::max(pause_least_ns, due > now ? due - now : 0);
  }
  if (endpoint_->must_look() || endpoint_->ended()) {
    pause_ns = std::min(pause_ns, look_ns);
  }
  lock.unlock();
  const int ready = poll_for(std::span(polled).first(count), pause_ns == never ? for_ever : pause_ns);
  come_back(lock);
  if (polled[0].revents != 0) {
    std::uint64_t ignored = 0;
    [[maybe_unused]] const ssize_t cleared = ::read(wake_, &ignored, sizeof ignored);
  }
  return ready != 0 || full_ || endpoint_->must_look() || endpoint_->ended();
}

std::string Board::url() {
  const auto lock = enter();
  if (!endpoint_) {
    throw EndpointError("the board is closed");
  }
  std::string place = endpoint_->url();
  wake();  // there may be a new descriptor to poll
  return place;
}

double Board::time_s() {
  const auto lock = enter();
  return static_cast<double>(device_->clock()) / configuration().clock_hz;
}

BusReply Board::get(std::uint32_t address) {
  const auto lock = enter();
  return device_->get(address);
}

BusStatus Board::set(std::uint32_t address, std::uint32_t value) {
  const auto lock = enter();
  const Clock before = device_->next_event();
  const BusStatus status = device_->set(address, value);
  if (device_->next_event() < before) {
    wake();  // the event line of a slave has changed
  }
  return status;
}

std::size_t Board::get(std::span<const std::uint32_t> addresses, std::span<std::uint32_t> words) {
  const auto lock = enter();
  for (std::size_t index = 0; index < std::min(addresses.size(), words.size()); ++index) {
    const BusReply reply = device_->get(addresses[index]);
    if (reply.status != BusStatus::ok) {
      return index;
    }
    words[index] = reply.value;
  }
  return std::min(addresses.size(), words.size());
}

std::size_t Board::set(std::span<const std::uint32_t> addresses, std::span<const std::uint32_t> words) {
  const auto lock = enter();
  const Clock before = device_->next_event();
  std::size_t done = 0;
  while (done < std::min(addresses.size(), words.size()) &&
         device_->set(addresses[done], words[done]) == BusStatus::ok) {
    ++done;
  }
  if (device_->next_event() < before) {
    wake();
  }
  return done;
}

void Board::set_event(std::uint32_t group, bool high) {
  const auto lock = enter();
  device_->set_event(group, high);
  wake();
}

void Board::pulse_event(std::uint32_t group) {
  const auto lock = enter();
  device_->set_event(group, true);  // no clock runs between the two, so a level counts once, like an edge
  device_->set_event(group, false);
  wake();
}

void Board::receive_error(std::uint8_t bits) {
  const auto lock = enter();
  device_->receive_error(bits);
  wake();
}

void Board::hang_up() {
  const auto lock = enter();
  if (endpoint_) {
    endpoint_->dismiss();
    forget_output();
    wake();
  }
}

bool Board::async_take(AsyncWord& word) {
  const auto lock = enter();
  Tosnet* tosnet = device_->tosnet();
  return tosnet != nullptr && tosnet->async_take(word, device_->clock());
}

bool Board::async_give(const AsyncWord& word) {
  const auto lock = enter();
  Tosnet* tosnet = device_->tosnet();
  return tosnet != nullptr && tosnet->async_give(word, device_->clock());
}

void Board::set_online(bool online) {
  const auto lock = enter();
  if (Tosnet* tosnet = device_->tosnet(); tosnet != nullptr) {
    tosnet->set_online(online, device_->clock());
  }
}

bool Board::set_ring(std::uint32_t ring, bool whole) {
  const auto lock = enter();
  Tosnet* tosnet = device_->tosnet();
  return tosnet != nullptr && tosnet->set_ring(ring, whole, device_->clock());
}

bool Board::set_node(std::uint32_t id, bool present) {
  const auto lock = enter();
  Tosnet* tosnet = device_->tosnet();
  return tosnet != nullptr && tosnet->set_node(id, present, device_->clock());
}

void Board::damage_cycle() {
  const auto lock = enter();
  if (Tosnet* tosnet = device_->tosnet(); tosnet != nullptr) {
    tosnet->damage_cycle(device_->clock());
  }
}

BoardStatistics Board::statistics() {
  const auto lock = enter();
  statistics_.device = device_->statistics();
  BoardStatistics told = statistics_;
  const std::uint64_t real = real_ns();
  const std::uint64_t robot = RobotTime::here().now_ns(real) - start_ns_;
  told.time_slipped_s += in_steps_ ? 0.0
                                   : static_cast<double>(real - started_ns_ - std::min(real - started_ns_, robot)) /
                                         static_cast<double>(second_ns);
  return told;
}

std::string Board::failure() {
  const auto lock = enter();
  return device_->failure();
}

}  // namespace unitylink::device
