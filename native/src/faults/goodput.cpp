// SPDX-License-Identifier: BSD-3-Clause
#include "faults/goodput.hpp"

#include <algorithm>
#include <memory>

#include "device/device.hpp"
#include "faults/faulty_wire.hpp"
#include "layer2_message/framed_engine.hpp"

namespace unitylink::faults {
namespace {

using device::Device;

constexpr std::uint64_t second = 1'000'000'000;
constexpr std::uint64_t patience_ns = 10 * second;
constexpr std::uint64_t clock_ns = 20;  // one clock of the device at 50 MHz

class Line {
 public:
  explicit Line(const GoodputPlan& plan)
      : plan_(plan),
        random_(plan.seed),
        there_(random_, protocol::frame::delimiter, plan.byte_ns, plan.delay_ns),
        back_(random_, protocol::frame::delimiter, plan.byte_ns, plan.delay_ns) {
    EngineSettings settings;
    settings.byte_time_ns = plan.byte_ns;
    settings.seed = random_();
    settings.window = plan.window;
    engine_ = std::make_unique<FramedEngine>(settings, false);
    device::DeviceConfiguration configuration;
    configuration.address_bits = 16;
    configuration.window = plan.window;
    device_ = std::make_unique<Device>(configuration);
    traffic_ = make_traffic(plan.kind, plan.message_words, plan.window, *engine_, *device_);
    device_->bus().observe([this](std::uint32_t address, std::uint32_t value) { traffic_->on_write(address, value); });
  }

  GoodputReport run() {
    Exchange opening;
    opening.operation = Operation::resynchronise;
    opening.attempts_max = 5;
    engine_->submit(opening, now_);
    while (!opening.done()) {
      step();
    }
    there_.set({.lose = plan_.lose});
    back_.set({.lose = plan_.lose});
    const std::uint64_t begun_ns = next_;
    std::uint64_t progressed_ns = next_;
    const Statistics before = engine_->statistics();
    wanted_ = plan_.words;
    while (traffic_->through() < plan_.words) {
      const std::uint64_t through = traffic_->through();
      step();
      progressed_ns = traffic_->through() != through ? now_ : progressed_ns;
      if (next_ - progressed_ns > patience_ns) {
        return report_;
      }
    }
    const auto words = static_cast<double>(plan_.words);
    const Statistics& after = engine_->statistics();
    report_.words_per_s = words * 1e9 / static_cast<double>(progressed_ns - begun_ns);
    report_.sent_bytes_per_word = static_cast<double>(after.bytes_sent - before.bytes_sent) / words;
    report_.returned_bytes_per_word = static_cast<double>(after.bytes_received - before.bytes_received) / words;
    report_.lost = there_.faults() + back_.faults();
    report_.wrong = traffic_->wrong();
    return report_;
  }

 private:
  // Goes to the next time with an event, and does all that happens then.
  void step() {
    now_ = next_;
    back_.take(now_, [this](std::span<const std::uint8_t> bytes) { engine_->receive(bytes, now_); });
    engine_->advance(now_);
    traffic_->offer(wanted_, now_);
    const std::uint64_t room_ns = plan_.buffer_bytes * plan_.byte_ns;
    while (there_.free_ns() <= now_ + room_ns) {
      const auto bytes = engine_->transmit(now_);
      if (bytes.empty()) {
        break;
      }
      const std::size_t count = std::min<std::size_t>(bytes.size(), 64);  // a driver takes so much at once
      there_.send(bytes.first(count), now_);
      engine_->sent(count);
    }
    there_.take(now_, [this](std::span<const std::uint8_t> bytes) {
      for (const std::uint8_t byte : bytes) {
        static_cast<void>(device_->receive(byte));  // without a line it has room for all
      }
    });
    device_->run_until(std::max(device_->clock(), now_ / clock_ns));
    device::TimedByte timed;
    while (device_->take(timed)) {
      back_.send(std::span(&timed.byte, 1), now_);
    }
    std::uint64_t next = std::min({there_.next_ns(), back_.next_ns(), engine_->next_deadline_ns(), now_ + second});
    if (there_.free_ns() > now_ + room_ns) {
      next = std::min(next, there_.free_ns() - room_ns);
    }
    const device::Clock due = std::min(device_->next_event(), device_->next_output());
    if (due != device::never) {
      next = std::min(next, due * clock_ns);
    }
    next_ = std::max(now_ + 1, next);
  }

  GoodputPlan plan_;
  Random random_;
  FaultyWire there_;
  FaultyWire back_;
  std::unique_ptr<FramedEngine> engine_;
  std::unique_ptr<Device> device_;
  std::unique_ptr<Traffic> traffic_;
  GoodputReport report_;
  std::uint64_t now_ = second;
  std::uint64_t next_ = second;
  std::uint64_t wanted_ = 0;
};

}  // namespace

GoodputReport goodput(GoodputPlan plan) {
  plan.message_words = std::clamp<std::uint32_t>(plan.message_words, 1, FramedEngine::post_words_max);
  plan.words += (plan.message_words - plan.words % plan.message_words) % plan.message_words;  // whole messages
  return Line(plan).run();
}

}  // namespace unitylink::faults
