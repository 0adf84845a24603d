// SPDX-License-Identifier: BSD-3-Clause
//
// A robot on a link that may come and go, for nodes and controllers in C++: publishes in, set-points out, newest wins.
//
//     unitylink::Robot robot(table, options, on_publish, say);
//     robot.set(values, numbers, count);      // from any thread: written soon, together, or refused whole
//
// Header-only on the C ABI (unitylink.h), C++17. Threads: one that keeps the link and writes, one per published group.
// read_newest() and write_newest() are for one real-time thread: they neither allocate, lock, wait nor throw.
// Loss: publishes stop, what is set is refused, the gateware's dead-man makes the outputs safe where it has one; when the device is back its
// safe values are written before anything else.
#pragma once

#include <unitylink.h>

#include <semaphore.h>
#include <time.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "unitylink/robot_device.hpp"
#include "unitylink/robot_outputs.hpp"
#include "unitylink/robot_table.hpp"
#include "unitylink/triple_buffer.hpp"

namespace unitylink {

struct RobotOptions {
  std::string url;
  double retry_s = 1.0;
  double command_timeout_s = 0.0;  // without a set-point for so long the safe values are written; 0: never
  double deadman_s = 1.0;          // without a sign of life for so long the gateware makes its outputs safe; 0: never
  bool safe_at_exit = true;
  bool armed = true;
};

class Robot {
 public:
  // `raws` are those of the group's values, in order; `time_s` is of CLOCK_MONOTONIC.
  using OnPublish = std::function<void(std::size_t group, double time_s, const std::uint64_t* raws)>;
  using Say = std::function<void(int level, const std::string& message)>;  // 0 information, 1 warning, 2 error

  Robot(const Table& table, RobotOptions options, OnPublish on_publish, Say say)
      : table_(table), options_(std::move(options)), on_publish_(std::move(on_publish)), say_(std::move(say)), armed(options_.armed),
        wanted_(table.value_count), newest_(table.value_count), written_(table.value_count), outputs_(table) {
    sem_init(&wake_, 0, 0);
    keeper_ = std::thread([this] { keep(); });
  }
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;
  ~Robot() {
    stop_ = true;
    sem_post(&wake_);
    keeper_.join();
    sem_destroy(&wake_);
  }

  // Have values written soon, together; false, with the reason, where one cannot be: then none is.
  bool set(const std::uint16_t* values, const double* numbers, std::size_t count, std::string& why) {
    const std::lock_guard<std::mutex> lock(setting_);
    if (!ready(why)) return false;
    std::vector<std::uint64_t> raws(count);
    for (std::size_t i = 0; i < count; ++i) {
      if (!encode(table_.values[values[i]], numbers[i], raws[i])) {
        why = std::string(table_.values[values[i]].path) + ": " + std::to_string(numbers[i]) + " is out of its limits; nothing was written";
        ++refused;
        return false;
      }
    }
    for (std::size_t i = 0; i < count; ++i) wanted_next_(values[i], raws[i]);
    publish_wanted();
    ++accepted;
    return true;
  }

  // The real-time thread's set(): a number that cannot be written is left out and counted as refused.
  bool write_newest(const std::uint16_t* values, const double* numbers, std::size_t count) noexcept {
    if (!up || !armed) return false;
    for (std::size_t i = 0; i < count; ++i) {
      std::uint64_t raw = 0;
      if (encode(table_.values[values[i]], numbers[i], raw)) {
        wanted_next_(values[i], raw);
      } else {
        ++refused;
      }
    }
    publish_wanted();
    ++accepted;
    return true;
  }

  // The newest published numbers of the values, each group's of one moment; false while the link is down.
  bool read_newest(const std::uint16_t* values, double* numbers, std::size_t count) noexcept {
    newest_.update();
    const auto& raws = newest_.front();
    for (std::size_t i = 0; i < count; ++i) numbers[i] = number(table_.values[values[i]], raws[values[i]]);
    return up;
  }

  // Write the safe values now, and forget what was to be written.
  bool make_safe(std::string& said) {
    const std::lock_guard<std::mutex> lock(link_mutex_);
    if (link_ == nullptr) return said = state(), false;
    forget();
    if (device_.tripped()) return said = "the outputs are safe already: the dead-man has tripped", true;
    return outputs_.write_safe(said);
  }

  // Take set-points from now on; without `on` take none, and write the safe values.
  bool arm(bool on, std::string& said) {
    if (on) {
      const std::lock_guard<std::mutex> lock(link_mutex_);
      if (link_ != nullptr && !device_.arm()) return said = failure(), false;
      armed = true;
      return said = "armed: commands are taken", true;
    }
    armed = false;
    const bool done = make_safe(said);
    said = "disarmed: no commands are taken; " + said;
    return done;
  }

  // Read or write a value by its name; false, with the reason, where that fails.
  bool read(const std::string& path, double& found, std::string& why) {
    const std::lock_guard<std::mutex> lock(link_mutex_);
    const Value* value = find(path, why);
    if (value == nullptr || link_ == nullptr) return why = value == nullptr ? why : state(), false;
    std::uint64_t raw = 0;
    if (!outputs_.read_raw(*value, raw)) return why = failure(), false;
    found = number(*value, raw);
    return true;
  }
  bool write(const std::string& path, double wanted, std::string& why) {
    const Value* value = find(path, why);
    if (value == nullptr) return false;
    if (!value->writable) return why = path + " cannot be written", false;
    const auto index = static_cast<std::uint16_t>(value - table_.values);
    return set(&index, &wanted, 1, why);
  }

  // 0 all is well, 1 something was refused or failed, 2 there is no link; and what the diagnostics tell beside it.
  int health(Facts& facts) {
    const std::pair<const char*, std::uint64_t> counted[] = {
        {"commands accepted", accepted}, {"commands refused", refused}, {"writes", writes}, {"writes failed", failed},
        {"publishes taken", publishes},  {"links lost", losses},        {"armed", armed ? 1 : 0}};
    for (const auto& [name, count] : counted) facts.emplace_back(name, std::to_string(count));
    if (!up) return 2;
    const std::lock_guard<std::mutex> lock(link_mutex_);
    if (link_ == nullptr) return 2;
    facts.emplace_back("gateware", gateware_);
    device_.tell(facts);
    return !armed || device_.tripped() || refused > 0 || failed > 0 ? 1 : 0;
  }
  std::string state() const {
    const std::lock_guard<std::mutex> lock(state_mutex_);
    return state_;
  }
  const Table& table() const noexcept { return table_; }

 private:
  const Table& table_;
  const RobotOptions options_;
  const OnPublish on_publish_;
  const Say say_;

 public:
  std::atomic<bool> up{false}, armed;
  std::atomic<std::uint64_t> accepted{0}, refused{0}, writes{0}, failed{0}, publishes{0}, losses{0};

 private:
  struct Wanted {
    std::uint64_t raw = 0;
    std::uint64_t version = 0;  // counts what was set: the writer sees by it what it has not written
  };

  void wanted_next_(std::uint16_t value, std::uint64_t raw) noexcept {
    setting_copy_[value].raw = raw;
    ++setting_copy_[value].version;
  }
  void publish_wanted() noexcept {
    std::copy(setting_copy_.begin(), setting_copy_.end(), wanted_.back().begin());
    wanted_.publish();
    sem_post(&wake_);
  }
  bool ready(std::string& why) {
    if (up && armed) return true;
    ++refused;
    why = up ? "a command was not taken: the robot is not armed (service arm)" : "a command was not taken: " + state();
    return false;
  }
  const Value* find(const std::string& path, std::string& why) const {
    for (std::size_t i = 0; i < table_.value_count; ++i) {
      if (path == table_.values[i].path) return &table_.values[i];
    }
    why = "no value is called '" + path + "'";
    return nullptr;
  }
  static std::string failure() { return ul_last_error_text(); }
  void become(int level, const std::string& state) {
    {
      const std::lock_guard<std::mutex> lock(state_mutex_);
      if (state_ == state) return;
      state_ = state;
    }
    say_(level, state);
  }

  // ---- the link

  void keep() {
    bool again = false;
    while (!stop_) {
      ul_link* link = nullptr;
      if (ul_open(options_.url.c_str(), &link) != UL_OK) {
        become(1, "waiting for the device: " + failure());
        wait_s(options_.retry_s);
        continue;
      }
      link_mutex_.lock();
      link_ = link;
      link_mutex_.unlock();
      const std::string trouble = begin(again);
      if (trouble.empty()) {
        again = true;
        become(0, "connected to " + options_.url);
        up = true;
        const std::string lost = serve();
        up = false;
        if (!stop_) {
          ++losses;
          become(2, "the link is lost: " + lost);
        } else if (options_.safe_at_exit && accepted > 0) {
          std::string said;
          make_safe(said);
        }
      } else {
        become(1, "waiting for the device: " + trouble);
      }
      ul_close(link);
      for (auto& thread : readers_) thread.join();
      readers_.clear();
      link_mutex_.lock();
      link_ = nullptr;
      link_mutex_.unlock();
      ul_free(link);
      if (!trouble.empty()) wait_s(options_.retry_s);
    }
  }

  void wait_s(double seconds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (!stop_ && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }

  std::string begin(bool again) {
    const std::lock_guard<std::mutex> lock(link_mutex_);
    ul_configuration configuration{};
    configuration.size = sizeof configuration;
    ul_get_configuration(link_, &configuration);
    if (configuration.data_bytes * 8 != table_.data_bits) return "the device has words of another width: this is not the board the spec is for";
    const char* unverified = "";
    if (ul_check_spec(link_, table_.spec, table_.gateware, table_.gateware_count, &unverified) != UL_OK) return failure();
    gateware_ = *unverified == '\0' ? "verified" : std::string("not verified: ") + unverified;
    if (*unverified != '\0') say_(1, gateware_);
    base_hz_ = configuration.base_hz != 0 ? static_cast<double>(configuration.base_hz) : 1000.0;
    outputs_.open(link_);
    forget();
    bool writable = false, safe = false;
    for (std::size_t i = 0; i < table_.value_count; ++i) {
      writable = writable || table_.values[i].writable;
      safe = safe || (table_.values[i].writable && !std::isnan(table_.values[i].safe));
    }
    if (!device_.open(link_, options_.deadman_s, safe)) return failure();
    if (device_.tripped() && armed) {
      if (!device_.arm()) return failure();
      say_(1, "the dead-man had tripped and made the outputs safe; they are armed again");
    }
    if (device_.tripped()) {
      say_(1, "the dead-man has tripped: the outputs are safe until the service arm is called");
    } else if (!again && writable && !device_.lacking().empty()) {
      say_(0, device_.lacking() + ": outputs stay when the link is lost; back again, they are made safe first");
    } else if (again) {
      std::string said;
      if (!outputs_.write_safe(said)) return said;
      say_(1, "the device is back; " + said + "; commands of before are forgotten");
    }
    last_s_ = now_s();
    for (std::size_t group = 0; group < table_.group_count; ++group) {
      const auto& wanted = table_.groups[group];
      std::vector<std::uint32_t> addresses;
      for (std::size_t i = 0; i < wanted.count; ++i) {
        const auto& value = table_.values[wanted.values[i]];
        for (std::uint32_t word = 0; word < value.words; ++word) addresses.push_back(value.address + word);
      }
      std::uint32_t subscription = 0;
      if (!wanted.polled) {
        ul_subscription_options options{};
        options.size = sizeof options;
        options.divisor = wanted.divisor;
        options.on_event = wanted.divisor == 0 ? 1 : 0;
        options.verify = 1;
        options.ring = 4096;
        if (ul_subscribe(link_, addresses.data(), addresses.size(), &options, &subscription) != UL_OK) return failure();
      }
      readers_.emplace_back([this, group, addresses, subscription] { follow(group, addresses, subscription); });
    }
    return "";
  }

  // A group's thread: drain, decode, hand on.
  void follow(std::size_t group, const std::vector<std::uint32_t>& addresses, std::uint32_t subscription) {
    const auto& wanted = table_.groups[group];
    std::vector<double> times(64);
    std::vector<std::uint32_t> words(times.size() * addresses.size());
    std::vector<std::uint64_t> raws(wanted.count);
    auto due = std::chrono::steady_clock::now();
    while (true) {
      std::size_t taken = 0;
      if (wanted.polled) {
        due += std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 * wanted.divisor / base_hz_));
        std::this_thread::sleep_until(due);
        if (stop_) return;
        const auto status = ul_read_many(link_, addresses.data(), addresses.size(), words.data(), 0, nullptr);
        if (status == UL_CLOSED) return;
        times[0] = now_s();
        taken = status == UL_OK ? 1 : 0;
      } else {
        if (ul_wait_publish(link_, subscription, 100'000'000) == UL_CLOSED) return;
        if (ul_drain(link_, subscription, times.data(), words.data(), times.size(), &taken) != UL_OK) return;
      }
      for (std::size_t i = 0; i < taken; ++i) {
        const std::uint32_t* word = words.data() + i * addresses.size();
        for (std::size_t k = 0; k < wanted.count; ++k) {
          const auto& value = table_.values[wanted.values[k]];
          raws[k] = 0;
          for (unsigned part = 0; part < value.words; ++part) raws[k] |= static_cast<std::uint64_t>(*word++) << part * table_.data_bits;
        }
        {
          const std::lock_guard<std::mutex> lock(newest_mutex_);
          for (std::size_t k = 0; k < wanted.count; ++k) newest_copy_[wanted.values[k]] = raws[k];
          std::copy(newest_copy_.begin(), newest_copy_.end(), newest_.back().begin());
          newest_.publish();
        }
        ++publishes;
        last_s_ = now_s();
        on_publish_(group, times[i], raws.data());
      }
    }
  }

  // The keeper's thread while the link is up: write what is wanted, look whether the device is there. Returns why it is lost.
  std::string serve() {
    double checked_s = now_s();
    double asked_s = now_s(), silent_s = 0.0;
    while (!stop_) {
      timespec until{};
      clock_gettime(CLOCK_REALTIME, &until);
      until.tv_nsec += 50'000'000;
      if (until.tv_nsec >= 1'000'000'000) until.tv_nsec -= 1'000'000'000, ++until.tv_sec;
      sem_timedwait(&wake_, &until);
      while (sem_trywait(&wake_) == 0) {}  // newest wins: one write for all that was set
      const std::lock_guard<std::mutex> lock(link_mutex_);
      const double now = now_s();
      if (wanted_.update() && up) {
        silent_s = now;
        if (write_wanted()) {
          ++writes;
        } else {
          say_(1, "a command was not written: " + failure());
        }
      } else if (silent_s != 0.0 && options_.command_timeout_s > 0.0 && now - silent_s > options_.command_timeout_s) {
        silent_s = 0.0;
        std::string said;
        outputs_.write_safe(said);
        say_(1, "no command came for command_timeout: " + said);
      }
      if (now - last_s_ > 0.5 && now - asked_s > 0.5) {
        asked_s = now;
        std::uint32_t word = 0;
        if (table_.value_count > 0 && ul_read(link_, probe(), &word, nullptr) != UL_OK) return failure();
      }
      if (now - checked_s > 0.1) {
        checked_s = now;
        if (std::string changed = device_.check(); !changed.empty()) return changed;
      }
    }
    return "";
  }
  std::uint32_t probe() const noexcept { return table_.group_count > 0 ? table_.values[table_.groups[0].values[0]].address : table_.values[0].address; }

  // ---- writing, with the mutex held

  void forget() {
    wanted_.update();
    const auto& now = wanted_.front();
    for (std::size_t i = 0; i < now.size(); ++i) written_[i] = now[i].version;
  }
  bool write_wanted() {
    std::vector<std::uint16_t> changed;
    const auto& wanted = wanted_.front();
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      if (wanted[i].version == written_[i]) continue;
      written_[i] = wanted[i].version;
      outputs_.want(i, wanted[i].raw);
      changed.push_back(static_cast<std::uint16_t>(i));
    }
    if (changed.empty()) return true;
    for (int tries = 0; tries < 3 && !stop_; ++tries) {  // the link is up, and it is still what is wanted
      if (outputs_.burst(changed)) return true;
      ++failed;
    }
    return false;
  }
  TripleBuffer<Wanted> wanted_;           // what is set -> the keeper
  TripleBuffer<std::uint64_t> newest_;    // what is published -> the real-time thread
  std::vector<Wanted> setting_copy_ = std::vector<Wanted>(table_.value_count);
  std::vector<std::uint64_t> newest_copy_ = std::vector<std::uint64_t>(table_.value_count);
  std::vector<std::uint64_t> written_;
  Outputs outputs_;
  Device device_;
  std::string gateware_ = "not verified: there is no link";
  std::mutex setting_, link_mutex_, newest_mutex_;
  mutable std::mutex state_mutex_;
  std::string state_ = "waiting for the device";
  ul_link* link_ = nullptr;
  sem_t wake_{};
  std::atomic<bool> stop_{false};
  std::atomic<double> last_s_{0.0};
  double base_hz_ = 1000.0;
  std::vector<std::thread> readers_;
  std::thread keeper_;
};

}  // namespace unitylink
