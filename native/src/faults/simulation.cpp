// SPDX-License-Identifier: BSD-3-Clause
#include "faults/simulation.hpp"

#include <algorithm>
#include <array>
#include <memory>

#include "device/device.hpp"
#include "device/rtl_device.hpp"
#include "faults/client.hpp"
#include "faults/faulty_wire.hpp"
#include "faults/lying_peer.hpp"
#include "layer2_message/classic_engine.hpp"
#include "layer2_message/framed_engine.hpp"

namespace unitylink::faults {
namespace {

using device::Device;
using device::DeviceConfiguration;

constexpr std::uint64_t ms = 1'000'000;
constexpr std::uint64_t recovery_ns = 50 * ms;  // after the last fault, the rate must recover within this time
// more timeouts to recover after a device that lied, because HELLO and OPEN come with pauses then
constexpr std::uint64_t recovery_timeouts = 4;
constexpr std::uint64_t line_ns = 10 * ms;  // extra time for the bytes of a request and its answer
constexpr std::size_t violations_most = 20;
constexpr std::uint32_t device_fifo = 2048;
// An engine that wants to act at once, but does nothing, would stop the virtual clock for ever. After so many turns
// this is a violation.
constexpr std::uint32_t turns_most = 1000;

class Simulation {
 public:
  explicit Simulation(const Plan& plan)
      : plan_(plan),
        random_(plan.seed),
        faults_(plan.profile),
        there_(random_, border(), byte_ns(), delay_ns()),
        back_(random_, border(), byte_ns(), delay_ns()),
        peer_(random_, plan.framed) {
    tally_.lied_to = faults_.peer != Peer::honest;
    if (faults_.drawn) {
      draw();
    }
    if (!plan.framed) {  // the classic protocol cannot recognise copies, and needs the order
      faults_.wire.repeat = faults_.wire.overtake = 0;
    }
    EngineSettings settings;
    settings.receive_fifo_bytes = settings.transmit_fifo_bytes = 512;
    settings.window = plan.window;
    settings.timeout_ns = timeout_ns();
    settings.byte_time_ns = byte_ns();
    settings.seed = random_();
    if (plan.framed) {
      auto framed = std::make_unique<FramedEngine>(settings, false);
      framed_ = framed.get();
      engine_ = std::move(framed);
    } else {
      engine_ = std::make_unique<ClassicEngine>(settings);
    }
    make_device();
    for (std::uint32_t number = 0; number < plan.clients; ++number) {
      clients_.push_back(
          std::make_unique<Client>(number, *engine_, framed_, random_, tally_, timeout_ns(), plan.framed ? 6u : 4u));
    }
  }

  Report run() {
    greet();
    std::uint64_t phase_begun = now_;
    std::uint64_t phase_messages = 0;
    enum class Phase { calm, faulty, recovering, recovered } phase = Phase::calm;
    const auto rate = [&] {
      return now_ > phase_begun ? double(tally_.messages - phase_messages) * 1e9 / double(now_ - phase_begun) : 0;
    };
    const auto enter = [&](Phase next) {
      phase = next;
      phase_begun = now_;
      phase_messages = tally_.messages;
    };
    while (tally_.messages < plan_.messages && report_.violations.size() < violations_most) {
      if (phase == Phase::calm && tally_.messages * 10 >= plan_.messages) {
        report_.calm_rate_hz = rate();
        set_faults(true);
        enter(Phase::faulty);
      } else if (phase == Phase::faulty && tally_.messages * 10 >= plan_.messages * 8) {
        report_.faulty_rate_hz = rate();
        set_faults(false);
        tally_.trusted_ns = now_ + patience_ns();
        enter(Phase::recovering);
      } else if (phase == Phase::recovering && now_ >= phase_begun + recovery_ns + patience_ns()) {
        enter(Phase::recovered);
      }
      if (!step()) {
        break;
      }
      if (phase == Phase::faulty) {
        maybe_reset();
      }
    }
    if (phase == Phase::recovered) {
      report_.recovered_rate_hz = rate();
    }
    set_faults(false);
    draining_ = true;  // every operation must end
    while (report_.violations.empty() && busy() && step()) {}
    collect();
    return report_;
  }

 private:
  [[nodiscard]] std::uint8_t border() const noexcept {
    return static_cast<std::uint8_t>(plan_.framed ? protocol::frame::delimiter
                                                  : static_cast<std::uint32_t>(protocol::bytes::line_feed));
  }
  [[nodiscard]] static std::uint64_t byte_ns() noexcept { return 833; }       // 12 MBd
  [[nodiscard]] static std::uint64_t delay_ns() noexcept { return 125'000; }  // a USB microframe
  [[nodiscard]] static std::uint64_t timeout_ns() noexcept { return 20 * ms; }
  [[nodiscard]] std::uint64_t patience_ns() const noexcept {
    return tally_.lied_to ? recovery_timeouts * timeout_ns() : 0;
  }

  void draw() {
    const auto rate = [this](double most) {
      return random_() % 3 == 0
                 ? 0
                 : most * static_cast<double>(random_() % 1000) / 1000 * static_cast<double>(random_() % 1000) / 1000;
    };
    faults_.wire = {.flip = rate(0.01),
                    .burst = rate(0.005),
                    .lose_byte = rate(0.005),
                    .double_byte = rate(0.005),
                    .swap_bytes = rate(0.005),
                    .insert_byte = rate(0.005),
                    .lose = rate(0.3),
                    .repeat = rate(0.5),
                    .cut = rate(0.1),
                    .late = rate(0.01),
                    .late_ns = 1 * ms + random_() % (100 * ms),
                    .overtake = plan_.framed ? rate(0.2) : 0};
    faults_.reset = random_() % 4 == 0 ? rate(0.003) : 0;
    faults_.pause = rate(0.001);
    faults_.pause_ns = 500 * ms;
  }

  void make_device() {
    const auto observer = [this](std::uint32_t address, std::uint32_t value) { on_write(address, value); };
    if (rtl_ != nullptr) {
      rtl_->reset();
      return;
    }
    device_begun_ = now_;
    if (plan_.gateware) {
      std::unique_ptr<device::RtlDevice> made = plan_.gateware();
      rtl_ = made.get();
      rtl_->observe(observer);
      device_ = std::move(made);
    } else {
      DeviceConfiguration configuration;
      configuration.address_bits = 16;
      configuration.fifo = device_fifo;
      configuration.window = plan_.window;
      configuration.offers = twin_ != nullptr ? twin_->offers() : std::uint16_t{0};
      auto made = std::make_unique<Device>(configuration);
      twin_ = made.get();
      twin_->bus().observe(observer);
      device_ = std::move(made);
    }
    clock_ns_ = 1'000'000'000 / device_->configuration().clock_hz;
    tally_.lists = device_->configuration().lists;
  }

  void on_write(std::uint32_t address, std::uint32_t value) {
    report_.bus_writes += 1;
    note(now_);
    note(address);
    note(value);
    for (auto& client : clients_) {
      if (client->journal().owns(address)) {
        client->journal().on_write(address, value);
        return;
      }
    }
    report_.violations.push_back("a write to an address that no client uses");
  }

  void greet() {
    Exchange exchange;
    exchange.operation = Operation::resynchronise;
    exchange.timeout_ns = timeout_ns();
    exchange.attempts_max = 5;
    engine_->submit(exchange, now_);
    while (!exchange.done() && step()) {}
    if (exchange.status != Status::ok) {
      report_.violations.push_back("the device could not be greeted");
    }
    engine_->configure({.address_bytes = (device_->configuration().address_bits + 7) / 8,
                        .data_bytes = 4,
                        .read_many = 32,
                        .publish_mode = 2,
                        .base_hz = 1000,
                        .groups = 2,
                        .group_size = 16,
                        .rate_bytes = 2,
                        .discovered = true});
    greeted_ = true;
  }

  [[nodiscard]] bool busy() const {
    return std::any_of(clients_.begin(), clients_.end(), [](const auto& client) { return client->busy(); });
  }

  void set_faults(bool on) {
    there_.set(on ? faults_.wire : WireFaults{});
    back_.set(on ? faults_.wire : WireFaults{});
    peer_.set(on ? faults_.peer : Peer::honest);
    faulty_ = on;
  }

  bool chance(double probability) {
    return probability > 0 && static_cast<double>(random_() >> 11) * 0x1p-53 < probability;
  }

  void maybe_reset() {
    if (tally_.messages == looked_at_) {
      return;
    }
    const auto sent = static_cast<double>(tally_.messages - looked_at_);
    looked_at_ = tally_.messages;
    if (chance(faults_.pause * sent)) {
      report_.faults += 1;
      paused_until_ = now_ + random_() % faults_.pause_ns;
    }
    if (chance(faults_.reset * sent)) {
      report_.faults += 1;
      report_.resets += 1;
      // The reset comes at a random moment of its work.
      device_->run_until(device_->clock() + random_() % 2000);
      carry_back();
      back_.break_off(now_);
      make_device();
      for (auto& client : clients_) {
        client->journal().on_reset();
      }
    }
  }

  // Adds a word to the digest (FNV-1a).
  void note(std::uint64_t word) noexcept { report_.digest = (report_.digest ^ word) * 0x100'0000'01B3u; }
  void note(std::span<const std::uint8_t> bytes) noexcept {
    note(now_);
    for (const std::uint8_t byte : bytes) {
      note(byte);
    }
  }

  // Does everything that happens now, then goes to the next time with an event. False: there will be none.
  bool step() {
    const bool host = now_ >= paused_until_;
    if (host) {
      back_.take(now_, [this](std::span<const std::uint8_t> bytes) { engine_->receive(bytes, now_); });
      engine_->advance(now_);
      if (greeted_) {
        for (auto& client : clients_) {
          if (client->busy() || !draining_) {
            stepped_ = client->step(now_) || stepped_;
          }
        }
      }
      for (auto bytes = engine_->transmit(now_); !bytes.empty(); bytes = engine_->transmit(now_)) {
        note(bytes);
        there_.send(bytes, now_);
        engine_->sent(bytes.size());
      }
    }
    stepped_ = std::exchange(completed_, engine_->completed()) != engine_->completed() || stepped_;
    there_.take(now_, [this](std::span<const std::uint8_t> bytes) {
      for (const std::uint8_t byte : bytes) {
        say(peer_.heard(byte));
        if (!device_->receive(byte)) {
          device_->run_until(device_->clock() + 100);  // the wire waits for room, as with flow control
          static_cast<void>(device_->receive(byte));
        }
      }
    });
    carry_back();
    if (engine_->ended()) {
      report_.violations.push_back("the engine has given up the link");
      return false;
    }
    if (host && late()) {
      report_.violations.push_back("an operation has not ended within attempts x timeout");
      return false;
    }
    const std::uint64_t next = next_ns(host);
    if (next == FaultyWire::never) {
      if (draining_ && !busy()) {
        return false;
      }
      report_.violations.push_back("nothing is under way, and nobody waits");
      return false;
    }
    turns_ = next > now_ ? 0 : turns_ + 1;
    if (turns_ > turns_most) {
      report_.violations.push_back("a turn at once is asked for again and again, and nothing is done with it");
      return false;
    }
    now_ = std::max(now_ + 1, next);
    return true;
  }

  // Whether an operation is too late: no client was answered for so long that it should have ended.
  bool late() {
    const std::uint64_t answers = plan_.framed ? framed_->posts().confirmed() : engine_->statistics().replies;
    if (std::exchange(answers_, answers) != answers) {
      tally_.answered_ns = now_;
    }
    const std::uint64_t slack_ns = line_ns + (plan_.framed ? 0 : timeout_ns());
    return std::any_of(clients_.begin(), clients_.end(), [&](const auto& client) {
      return client->busy() && now_ > client->limit_ns(tally_.answered_ns) + slack_ns;
    });
  }

  std::uint64_t next_ns(bool host) {
    if (host && std::exchange(stepped_, false)) {
      return now_ + 1000;  // the program computes for a microsecond
    }
    std::uint64_t next = there_.next_ns();
    const device::Clock due = std::min(device_->next_event(), device_->next_output());
    if (due != device::never) {
      next = std::min(next, device_begun_ + due * clock_ns_);
    }
    if (!host) {
      return std::min(next, paused_until_);
    }
    return std::min({next, back_.next_ns(), engine_->next_deadline_ns()});
  }

  void carry_back() {
    device_->run_until(std::max(device_->clock(), (now_ - device_begun_) / clock_ns_));
    device::TimedByte timed;
    while (device_->take(timed)) {
      say(peer_.say(timed.byte));
    }
  }

  void say(const Bytes& bytes) {
    if (!bytes.empty()) {
      note(bytes);
      back_.send(bytes, now_);
    }
  }

  void collect() {
    for (auto& client : clients_) {
      for (Violation& violation : client->journal().violations()) {
        if (!plan_.framed && faults_.wire.damages() && violation.damage) {
          report_.undetected += 1;
        } else if (report_.violations.size() < violations_most) {
          report_.violations.push_back(std::move(violation.text));
        }
      }
    }
    report_.messages = tally_.messages;
    report_.good = tally_.good;
    report_.failed = tally_.failed;
    report_.unknown = tally_.unknown;
    report_.faults += there_.faults() + back_.faults() + peer_.lies();
    report_.sessions = framed_ != nullptr ? framed_->sessions() : 0;
    report_.retries = engine_->statistics().retries;
    report_.virtual_s = static_cast<double>(now_) * 1e-9;
  }

  Plan plan_;
  Random random_;
  Profile faults_;
  FaultyWire there_;
  FaultyWire back_;
  LyingPeer peer_;
  std::unique_ptr<Engine> engine_;
  FramedEngine* framed_ = nullptr;
  std::unique_ptr<device::ServedDevice> device_;
  Device* twin_ = nullptr;            // the device is either this
  device::RtlDevice* rtl_ = nullptr;  // or this
  std::uint64_t device_begun_ = 0;
  std::uint64_t clock_ns_ = 20;  // one clock of the device
  Tally tally_;
  std::vector<std::unique_ptr<Client>> clients_;
  Report report_;
  std::uint64_t now_ = 1000 * ms;
  std::uint64_t answers_ = 0;
  std::uint64_t paused_until_ = 0;
  std::uint64_t looked_at_ = 0;
  std::uint64_t completed_ = 0;
  std::uint32_t turns_ = 0;
  bool faulty_ = false;
  bool greeted_ = false;
  bool draining_ = false;
  bool stepped_ = false;
};

}  // namespace

Report run(const Plan& plan) { return Simulation(plan).run(); }

}  // namespace unitylink::faults
