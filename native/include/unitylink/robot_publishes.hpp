// SPDX-License-Identifier: BSD-3-Clause
//
// The publishes of a robot. Each group has a thread that drains and decodes them, and passes them on. The newest values
// are kept for one real-time thread.
#pragma once

#include <unitylink.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "unitylink/robot_life.hpp"
#include "unitylink/robot_table.hpp"
#include "unitylink/triple_buffer.hpp"

namespace unitylink {

class Publishes {
 public:
  // `raws` are the values of the group, in order. `time_s` is a time of CLOCK_MONOTONIC.
  using OnPublish = std::function<void(std::size_t group, double time_s, const std::uint64_t* raws)>;

  Publishes(const Table& table, OnPublish on_publish, Life& life)
      : table_(table), on_publish_(std::move(on_publish)), newest_(table.value_count) {
    for (std::size_t group = 0; group < table.group_count; ++group)
      signs_.push_back(&life.expect("a thread that publishes", Life::patience_s));
  }

  // Subscribes to all groups. The subscriptions survive a loss of the line. False: see ul_last_error_text().
  bool start(ul_link* link) {
    ul_configuration configuration{};
    configuration.size = sizeof configuration;
    ul_get_configuration(link, &configuration);
    const double base_hz = configuration.base_hz != 0 ? static_cast<double>(configuration.base_hz) : 1000.0;
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
        if (ul_subscribe(link, addresses.data(), addresses.size(), &options, &subscription) != UL_OK) return false;
      }
      readers_.emplace_back([this, link, group, addresses, subscription, base_hz] {
        follow(link, group, addresses, subscription, base_hz);
      });
    }
    return true;
  }
  // Waits for the threads. Call it after ul_close.
  void join() {
    for (auto& thread : readers_) thread.join();
    readers_.clear();
  }

  // Gets the newest published numbers of the values. All values of a group are of the same moment. Never allocates,
  // locks, waits or throws.
  void newest(const std::uint16_t* values, double* numbers, std::size_t count) noexcept {
    newest_.update();
    const auto& raws = newest_.front();
    for (std::size_t i = 0; i < count; ++i) numbers[i] = number(table_.values[values[i]], raws[values[i]]);
  }

  std::atomic<std::uint64_t> taken{0};

 private:
  // Runs in the thread of a group: drains, decodes and passes on.
  void follow(ul_link* link, std::size_t group, const std::vector<std::uint32_t>& addresses, std::uint32_t subscription,
              double base_hz) {
    const auto& wanted = table_.groups[group];
    std::vector<double> times(64);
    std::vector<std::uint32_t> words(times.size() * addresses.size());
    std::vector<std::uint64_t> raws(wanted.count);
    auto due = std::chrono::steady_clock::now();
    while (true) {
      std::size_t come = 0;
      if (wanted.polled) {
        due += std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 * wanted.divisor / base_hz));
        std::this_thread::sleep_until(due);
        const auto status = ul_read_many(link, addresses.data(), addresses.size(), words.data(), 0, nullptr);
        if (status == UL_CLOSED) return;
        times[0] = now_s();
        come = status == UL_OK ? 1 : 0;
      } else {
        if (ul_wait_publish(link, subscription, 100'000'000) == UL_CLOSED) return;
        if (ul_drain(link, subscription, times.data(), words.data(), times.size(), &come) != UL_OK) return;
      }
      for (std::size_t i = 0; i < come; ++i) {
        const std::uint32_t* word = words.data() + i * addresses.size();
        for (std::size_t k = 0; k < wanted.count; ++k) {
          const auto& value = table_.values[wanted.values[k]];
          raws[k] = 0;
          for (unsigned part = 0; part < value.words; ++part)
            raws[k] |= static_cast<std::uint64_t>(*word++) << part * table_.data_bits;
        }
        {
          const std::lock_guard<std::mutex> lock(mutex_);
          for (std::size_t k = 0; k < wanted.count; ++k) copy_[wanted.values[k]] = raws[k];
          std::copy(copy_.begin(), copy_.end(), newest_.back().begin());
          newest_.publish();
        }
        ++taken;
        signs_[group]->beat();
        on_publish_(group, times[i], raws.data());
        signs_[group]->rest();
      }
    }
  }

  const Table& table_;
  const OnPublish on_publish_;
  TripleBuffer<std::uint64_t> newest_;  // passes values from the groups' threads to the real-time thread
  std::vector<std::uint64_t> copy_ = std::vector<std::uint64_t>(table_.value_count);
  std::mutex mutex_;
  std::vector<Sign*> signs_;
  std::vector<std::thread> readers_;
};

}  // namespace unitylink
