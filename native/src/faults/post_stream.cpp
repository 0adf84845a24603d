// SPDX-License-Identifier: BSD-3-Clause
#include "faults/post_stream.hpp"

#include <algorithm>
#include <array>
#include <memory>

#include "device/device.hpp"
#include "faults/faulty_wire.hpp"
#include "layer2_message/framed_engine.hpp"

namespace unitylink::faults {
namespace {

using device::Device;

constexpr std::uint64_t second = 1'000'000'000;
constexpr std::uint64_t patience_ns = 10 * second;
constexpr std::uint64_t clock_ns = 20;  // of the device: 50 MHz
constexpr std::uint32_t addresses = 256;

class PostStream {
 public:
  explicit PostStream(const PostPlan& plan)
      : plan_(plan),
        random_(plan.seed),
        there_(random_, protocol::frame::delimiter, plan.byte_ns, plan.delay_ns),
        back_(random_, protocol::frame::delimiter, plan.byte_ns, plan.delay_ns) {
    EngineSettings settings;
    settings.byte_time_ns = plan.byte_ns;
    settings.seed = random_();
    engine_ = std::make_unique<FramedEngine>(settings, false);
    device::DeviceConfiguration configuration;
    configuration.address_bits = 16;
    device_ = std::make_unique<Device>(configuration);
    device_->bus().observe([this](std::uint32_t address, std::uint32_t value) {
      report_.disorder += value != executed_ || address != executed_ % addresses ? 1 : 0;
      ++executed_;
      progressed_ns_ = now_;
    });
  }

  PostReport run() {
    Exchange opening;
    opening.operation = Operation::resynchronise;
    opening.attempts_max = 5;
    engine_->submit(opening, now_);
    while (!opening.done()) {
      step();
    }
    there_.set({.lose = plan_.lose});
    back_.set({.lose = plan_.lose});
    const std::uint64_t begun_ns = progressed_ns_ = now_;
    const std::uint64_t begun_bytes = engine_->statistics().bytes_sent;
    wanted_ = plan_.posts;
    while (executed_ < plan_.posts) {
      step();
      if (now_ - progressed_ns_ > patience_ns) {
        return report_;
      }
    }
    report_.posts_per_s = static_cast<double>(plan_.posts) * 1e9 / static_cast<double>(progressed_ns_ - begun_ns);
    report_.sent_bytes_per_post = static_cast<double>(engine_->statistics().bytes_sent - begun_bytes) / static_cast<double>(plan_.posts);
    report_.lost = there_.faults() + back_.faults();
    return report_;
  }

 private:
  // Everything that happens now, then to the next time at which something may.
  void step() {
    back_.take(now_, [this](std::span<const std::uint8_t> bytes) { engine_->receive(bytes, now_); });
    engine_->advance(now_);
    while (made_ < wanted_) {
      for (std::uint32_t word = 0; word < plan_.words; ++word) {
        next_[word] = {(made_ + word) % addresses, made_ + word};
      }
      if (!engine_->post(std::span<const Post>(next_).first(plan_.words), now_)) {
        break;
      }
      made_ += plan_.words;
    }
    const std::uint64_t room_ns = plan_.buffer_bytes * plan_.byte_ns;
    while (there_.free_ns() <= now_ + room_ns) {
      const auto bytes = engine_->transmit(now_);
      if (bytes.empty()) {
        break;
      }
      const std::size_t count = std::min<std::size_t>(bytes.size(), 64);  // as much as a driver takes at a time
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
    now_ = std::max(now_ + 1, next);
  }

  PostPlan plan_;
  Random random_;
  FaultyWire there_;
  FaultyWire back_;
  std::unique_ptr<FramedEngine> engine_;
  std::unique_ptr<Device> device_;
  PostReport report_;
  std::uint64_t now_ = second;
  std::uint64_t progressed_ns_ = 0;
  std::array<Post, FramedEngine::post_words_max> next_;
  std::uint64_t wanted_ = 0;
  std::uint32_t made_ = 0;
  std::uint32_t executed_ = 0;
};

}  // namespace

PostReport stream_posts(PostPlan plan) {
  plan.words = std::clamp<std::uint32_t>(plan.words, 1, FramedEngine::post_words_max);
  plan.posts += (plan.words - plan.posts % plan.words) % plan.words;  // whole messages
  return PostStream(plan).run();
}

}  // namespace unitylink::faults
