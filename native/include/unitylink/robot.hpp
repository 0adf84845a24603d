// SPDX-License-Identifier: BSD-3-Clause
//
// A robot on a link that may be lost and come back. For nodes and controllers in C++: publishes come in, set-points go
// out, and the newest values win.
//
//     unitylink::Robot robot(table, options, on_publish, say);
//     robot.set(values, numbers, count);      // from any thread: all are written soon and together, or none is
//
// Header-only on the C ABI (unitylink.h), C++17.
// Threads: one keeps the link and writes, one per published group receives, and one checks that these work.
// read_newest(), write_newest() and alive() are for one real-time thread: they never allocate, lock, wait or throw.
// Loss: without a link no publishes come, set() is refused, and the gateware's dead-man makes the outputs safe if it
// has one. Layer 2 opens the line again (reconnect=1). When the device is back, its safe values are written before
// anything else.
// Life: a program that calls alive() must call it again within a second, until rest(). If it does not, or if a thread
// of the robot hangs, the dead-man trips.
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
#include "unitylink/robot_life.hpp"
#include "unitylink/robot_options.hpp"
#include "unitylink/robot_outputs.hpp"
#include "unitylink/robot_publishes.hpp"
#include "unitylink/robot_table.hpp"
#include "unitylink/robot_wanted.hpp"

namespace unitylink {

class Robot {
 public:
  using OnPublish = Publishes::OnPublish;
  using Say = std::function<void(int level, const std::string& message)>;  // 0 information, 1 warning, 2 error

  Robot(const Table& table, RobotOptions options, OnPublish on_publish, Say say)
      : table_(table),
        options_(std::move(options)),
        say_(std::move(say)),
        armed(options_.armed),
        wanted_(table.value_count),
        outputs_(table),
        publishes_(table, std::move(on_publish), life_) {
    sem_init(&wake_, 0, 0);
    life_.start();
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

  // Signs of life of the thread that sets values, and of the one that answers services; see above.
  enum Thread : std::uint8_t { setting, answering };
  void alive(Thread thread = setting) noexcept { (thread == setting ? program_ : answerer_).beat(); }
  void rest() noexcept {
    program_.rest();
    answerer_.rest();
  }

  // Writes values soon and together. If one cannot be written, none is: then it returns false, and the reason.
  bool set(const std::uint16_t* values, const double* numbers, std::size_t count, std::string& why) {
    const std::lock_guard<std::mutex> lock(setting_);
    if (!ready(why)) return false;
    std::vector<std::uint64_t> raws(count);
    for (std::size_t i = 0; i < count; ++i) {
      if (!encode(table_.values[values[i]], numbers[i], raws[i])) {
        why = std::string(table_.values[values[i]].path) + ": " + shown(numbers[i]) +
              " is not one of its values, or is out of its limits; nothing was written";
        ++refused;
        return false;
      }
    }
    for (std::size_t i = 0; i < count; ++i) wanted_.next(values[i], raws[i]);
    publish_wanted();
    ++accepted;
    return true;
  }

  // Like set(), for the real-time thread. A number that cannot be written is left out, and counted as refused.
  bool write_newest(const std::uint16_t* values, const double* numbers, std::size_t count) noexcept {
    if (!up || !armed || hanging_) return false;
    for (std::size_t i = 0; i < count; ++i) {
      std::uint64_t raw = 0;
      if (encode(table_.values[values[i]], numbers[i], raw)) {
        wanted_.next(values[i], raw);
      } else {
        ++refused;
      }
    }
    publish_wanted();
    ++accepted;
    return true;
  }

  // Gets the newest published numbers of the values. All values of a group are of the same moment. Returns false while
  // the link is down.
  bool read_newest(const std::uint16_t* values, double* numbers, std::size_t count) noexcept {
    publishes_.newest(values, numbers, count);
    return up;
  }

  // Writes the safe values now, and drops values that are still to be written.
  bool make_safe(std::string& said) {
    const std::lock_guard<std::mutex> lock(link_mutex_);
    if (!up) return said = state(), false;
    forget();
    if (device_.tripped()) return said = "the outputs are safe already: the dead-man has tripped", true;
    return outputs_.write_safe(said);
  }

  // Like make_safe(), for the real-time thread: the keeper's thread writes them soon, if the link is up.
  void make_safe_soon() noexcept {
    safe_soon_ = true;
    sem_post(&wake_);
  }

  // Takes set-points from now on. Without `on` it takes none, and writes the safe values.
  bool arm(bool on, std::string& said) {
    if (on) {
      if (hanging_) return said = state(), false;
      const std::lock_guard<std::mutex> lock(link_mutex_);
      if (up && !device_.arm()) return said = failure(), false;
      armed = true;
      return said = "armed: commands are taken", true;
    }
    armed = false;
    const bool done = make_safe(said);
    said = "disarmed: no commands are taken; " + said;
    return done;
  }

  // Reads or writes a value by its name. On failure it returns false, and the reason.
  bool read(const std::string& path, double& found, std::string& why) {
    const std::lock_guard<std::mutex> lock(link_mutex_);
    const Value* value = find(path, why);
    if (value == nullptr || !up) return why = value == nullptr ? why : state(), false;
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

  // Returns 0 if all is well, 1 if something was refused or failed, 2 without a link. `facts` gets the diagnostics.
  int health(Facts& facts) {
    const std::pair<const char*, std::uint64_t> counted[] = {
        {"commands accepted", accepted}, {"commands refused", refused},    {"writes", writes},
        {"writes failed", failed},       {"publishes taken", publishes()}, {"links lost", losses},
        {"armed", armed ? 1 : 0}};
    for (const auto& [name, count] : counted) facts.emplace_back(name, std::to_string(count));
    if (!up || hanging_) return 2;
    const std::lock_guard<std::mutex> lock(link_mutex_);
    facts.emplace_back("gateware", gateware_);
    device_.tell(facts);
    return !armed || device_.tripped() || refused > 0 || failed > 0 ? 1 : 0;
  }
  std::string state() const {
    const std::lock_guard<std::mutex> lock(state_mutex_);
    return trouble_.empty() ? state_ : trouble_;
  }
  std::uint64_t publishes() const noexcept { return publishes_.taken; }
  const Table& table() const noexcept { return table_; }

 private:
  const Table& table_;
  const RobotOptions options_;
  const Say say_;

 public:
  std::atomic<bool> up{false}, armed;
  std::atomic<std::uint64_t> accepted{0}, refused{0}, writes{0}, failed{0}, losses{0};
  // How often values that were set are no longer what the device has: after a loss, a hang, or because it was made
  // safe.
  std::atomic<std::uint64_t> drops{0};

 private:
  void publish_wanted() noexcept {
    wanted_.publish();
    sem_post(&wake_);
  }
  bool ready(std::string& why) {
    if (up && armed && !hanging_) return true;
    ++refused;
    why = up && !hanging_ ? "a command was not taken: the robot is not armed (service arm)"
                          : "a command was not taken: " + state();
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

  void hangs(const std::string& trouble) {
    {
      const std::lock_guard<std::mutex> lock(state_mutex_);
      trouble_ = trouble;
    }
    hanging_ = !trouble.empty();
    say_(hanging_ ? 2 : 1,
         hanging_ ? trouble + ": no commands are taken, and the dead-man may trip" : "all threads work again");
  }

  // ---- the link

  void keep() {
    for (bool again = false; !stop_; wait_s(options_.retry_s)) {
      ul_link* link = nullptr;
      if (ul_open(options_.lasting_url().c_str(), &link) != UL_OK) {
        become(1, "waiting for the device: " + failure());
        continue;
      }
      const std::string trouble = begin(link, again);
      if (trouble.empty()) {
        again = true;
        const std::string ended = serve();
        if (!stop_) {
          fall(ended);
        } else if (options_.safe_at_exit && accepted > 0) {
          std::string said;
          make_safe(said);
        }
      } else {
        become(1, "waiting for the device: " + trouble);
      }
      up = false;
      life_.serve(nullptr);
      ul_close(link);
      publishes_.join();
      const std::lock_guard<std::mutex> lock(link_mutex_);
      link_ = nullptr;
      ul_free(link);
    }
  }

  void wait_s(double seconds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (!stop_ && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }

  void rise() {
    become(0, "connected to " + options_.url);
    safe_soon_ = false;  // the device is safe
    up = true;
  }
  void fall(const std::string& why) {
    if (up.exchange(false)) ++losses;
    become(2, "the link is lost: " + why);
  }

  std::string begin(ul_link* link, bool again) {
    const std::lock_guard<std::mutex> lock(link_mutex_);
    link_ = link;
    ul_configuration configuration{};
    configuration.size = sizeof configuration;
    ul_get_configuration(link_, &configuration);
    if (configuration.data_bytes * 8 != table_.data_bits)
      return "the device has words of another width: this is not the board the spec is for";
    if (const std::string notice = ul_notice(link_); !notice.empty()) {
      if (*table_.asks_for_frames != '\0') {
        return std::string(table_.asks_for_frames) + ", which needs the framed protocol, but " + options_.url +
               " has fallen back to the classic one: " + notice +
               ". Use gateware with the framed protocol, or add protocol=classic to the URL if you want that";
      }
      say_(1, notice);
    }
    const char* unverified = "";
    if (ul_check_spec(link_, table_.spec, table_.gateware, table_.gateware_count, &unverified) != UL_OK)
      return failure();
    gateware_ = *unverified == '\0' ? "verified" : std::string("not verified: ") + unverified;
    if (*unverified != '\0') say_(1, gateware_);
    bool writable = false, safe = false;
    for (std::size_t i = 0; i < table_.value_count; ++i) {
      writable = writable || table_.values[i].writable;
      safe = safe || (table_.values[i].writable && !std::isnan(table_.values[i].safe));
    }
    if (!device_.open(link_, options_.deadman_s, safe)) return failure();
    if (std::string trouble = make_fit(again); !trouble.empty()) return trouble;
    if (!device_.tripped() && !again && writable && !device_.lacking().empty()) {
      say_(0,
           device_.lacking() + ": outputs keep their values when the link is lost, and are made safe when it is back");
    }
    if (!publishes_.start(link_)) return failure();
    // mapped memory has no line, so UL_MISMATCH is no failure
    if (const ul_status watched = life_.serve(link_); watched != UL_OK && watched != UL_MISMATCH) return failure();
    rise();
    return "";
  }

  // Arms a gateware that has tripped, if the robot is armed. Then writes the safe values of a device that is `old`,
  // because its values are old, too.
  std::string make_fit(bool old) {
    outputs_.open(link_);
    forget();
    if (device_.tripped() && armed) {
      if (!device_.arm()) return failure();
      say_(1, "the dead-man had tripped and made the outputs safe; they are armed again");
    }
    generation_ = device_.generation();  // after a later loss, all of this is done again
    if (device_.tripped()) {
      say_(1, "the dead-man has tripped: the outputs are safe until the service arm is called");
    } else if (old) {
      std::string said;
      if (!outputs_.write_safe(said)) return said;
      say_(1, "the device is back; " + said + "; earlier commands are dropped");
    }
    return "";
  }

  // The keeper's thread while there is a link: it writes the wanted values, and watches the line. Returns why the link
  // has ended.
  std::string serve() {
    double checked_s = now_s(), silent_s = 0.0;
    bool made_safe = false;
    for (; !stop_; writer_.rest()) {
      timespec until{};
      clock_gettime(CLOCK_REALTIME, &until);
      until.tv_nsec += 50'000'000;
      if (until.tv_nsec >= 1'000'000'000) until.tv_nsec -= 1'000'000'000, ++until.tv_sec;
      sem_timedwait(&wake_, &until);
      while (sem_trywait(&wake_) == 0) {}  // one write for all calls of set() so far, because the newest values win
      writer_.beat();
      const std::lock_guard<std::mutex> lock(link_mutex_);
      if (const ul_status line = ul_wait_up(link_, 0); line != UL_OK) {
        if (line != UL_DOWN) return failure();
        fall(failure());
        continue;
      }
      const double now = now_s();
      // done here while the link still works, because not all gateware has a dead-man
      if (up && hanging_ && !made_safe && !device_.tripped()) {
        std::string said;
        made_safe = outputs_.write_safe(said);
        forget();
      }
      made_safe = made_safe && hanging_;
      if (up && safe_soon_.exchange(false) && !device_.tripped()) {
        std::string said;
        outputs_.write_safe(said);
        forget();
      }
      const bool look = now - checked_s > 0.1;
      checked_s = look ? now : checked_s;
      if (up && (device_.generation() != generation_ || (look && device_.has_tripped())))
        fall("the device has lost the values that were written to it");
      if (!up) {
        silent_s = 0.0;
        if (!look) continue;
        if (!device_.renew()) continue;  // layer 2 decides whether the line is gone
        if (const std::string trouble = make_fit(true); trouble.empty()) {
          rise();
        } else {
          become(2, "the link is lost: " + trouble);
        }
      } else if (wanted_.update()) {
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
    }
    return "";
  }

  // ---- writing, with the mutex held

  void forget() {
    ++drops;
    wanted_.forget();
  }
  bool write_wanted() {
    const auto changed = wanted_.take([this](std::size_t value, std::uint64_t raw) { outputs_.want(value, raw); });
    if (changed.empty()) return true;
    for (int tries = 0; tries < 3 && !stop_; ++tries) {  // as long as the link is up and the values are still wanted
      if (outputs_.burst(changed)) return true;
      ++failed;
      // values from before a loss are not written after it
      if (device_.generation() != generation_ || ul_wait_up(link_, 0) != UL_OK) return false;
    }
    return false;
  }
  Wanted wanted_;  // from set() to the keeper's thread
  Outputs outputs_;
  Device device_;
  std::uint64_t generation_ = 0;  // generation() of the device at the last make_fit()
  std::string gateware_ = "not verified: there is no link";
  std::mutex setting_, link_mutex_;
  mutable std::mutex state_mutex_;
  std::string state_ = "waiting for the device", trouble_;
  ul_link* link_ = nullptr;
  sem_t wake_{};
  std::atomic<bool> stop_{false};
  std::atomic<bool> hanging_{false}, safe_soon_{false};
  Life life_{[this](const std::string& trouble) { hangs(trouble); }};
  Sign& program_ = life_.expect("the program's thread", Life::patience_s);
  Sign& answerer_ = life_.expect("the thread that answers services", Life::device_s);
  Sign& writer_ = life_.expect("the thread that writes commands", Life::device_s);
  Publishes publishes_;
  std::thread keeper_;
};

}  // namespace unitylink
