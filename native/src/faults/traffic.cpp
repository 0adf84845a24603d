// SPDX-License-Identifier: BSD-3-Clause
#include "faults/traffic.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace unitylink::faults {
namespace {

constexpr std::uint32_t addresses = 256;
constexpr std::uint32_t attempts_max = 100;     // a run ends by its time, not by its attempts
constexpr std::uint32_t first_value = 0x10000;  // the value of the first word to be read

// Word n has the value n, and is written to address n mod 256. So a missing word or a wrong order is noticed at once.
class Posts final : public Traffic {
 public:
  Posts(std::uint32_t message_words, FramedEngine& engine) : words_(message_words), engine_(engine) {}

  void offer(std::uint64_t words, std::uint64_t now_ns) override {
    while (made_ < words) {
      for (std::uint32_t word = 0; word < words_; ++word) {
        next_[word] = {(made_ + word) % addresses, made_ + word};
      }
      if (!engine_.post(std::span<const Post>(next_).first(words_), now_ns)) {
        return;
      }
      made_ += words_;
    }
  }
  void on_write(std::uint32_t address, std::uint32_t value) override {
    disorder_ += value != executed_ || address != executed_ % addresses ? 1 : 0;
    ++executed_;
  }
  [[nodiscard]] std::uint64_t through() const noexcept override { return executed_; }
  [[nodiscard]] std::uint64_t wrong() const noexcept override { return disorder_; }

 private:
  std::uint32_t words_;
  FramedEngine& engine_;
  std::array<Post, FramedEngine::post_words_max> next_;
  std::uint32_t made_ = 0;
  std::uint32_t executed_ = 0;
  std::uint64_t disorder_ = 0;
};

// There are more requests than fit into the window. Each is made again as soon as it is answered. No value is written
// twice.
class Requests final : public Traffic {
 public:
  Requests(bool writes, std::uint32_t message_words, std::uint32_t window, FramedEngine& engine, device::Device& device)
      : writes_(writes), words_(message_words), engine_(engine), requests_(std::size_t{2} * window) {
    for (std::uint32_t address = 0; !writes && address < addresses; ++address) {
      static_cast<void>(device.bus().write(address, first_value + address, 0));
    }
    for (Request& request : requests_) {
      request.places.resize(words_);
      request.values.resize(words_);
    }
  }

  void offer(std::uint64_t words, std::uint64_t now_ns) override {
    for (Request& request : requests_) {
      if (request.begun && request.exchange.done()) {
        judge(request);
      }
      if (!request.begun && made_ < words) {
        begin(request, now_ns);
      }
    }
  }
  void on_write(std::uint32_t address, std::uint32_t value) override {
    if (!writes_) {
      return;
    }
    const bool known = value < executed_.size() && address == value % addresses;
    wrong_ += !known || executed_[value] ? 1 : 0;
    if (known) {
      executed_[value] = true;
    }
  }
  [[nodiscard]] std::uint64_t through() const noexcept override { return through_; }
  [[nodiscard]] std::uint64_t wrong() const noexcept override { return wrong_; }

 private:
  struct Request {
    Exchange exchange;
    bool begun = false;
    std::vector<std::uint32_t> places;  // addresses
    std::vector<std::uint32_t> values;
  };

  void begin(Request& request, std::uint64_t now_ns) {
    for (std::uint32_t word = 0; word < words_; ++word) {
      request.places[word] = (made_ + word) % addresses;
      request.values[word] = writes_ ? made_ + word : 0;
    }
    made_ += words_;
    executed_.resize(made_);
    request.exchange = Exchange{};
    Exchange& exchange = request.exchange;
    exchange.attempts_max = attempts_max;
    exchange.repeat = !writes_;
    exchange.address = request.places[0];
    if (words_ == 1) {
      exchange.operation = writes_ ? Operation::write : Operation::read;
      exchange.value = request.values[0];
    } else {
      exchange.operation = writes_ ? Operation::transfer : Operation::read_many;
    }
    if (words_ > 1 && writes_) {
      exchange.write_addresses = request.places;
      exchange.write_values = request.values;
    } else if (words_ > 1) {
      exchange.addresses = request.places;
    }
    if (!writes_) {
      exchange.values = request.values;
    }
    request.begun = true;
    engine_.submit(exchange, now_ns);
  }

  void judge(Request& request) {
    request.begun = false;
    for (std::uint32_t word = 0; word < words_; ++word) {
      const std::uint32_t read = words_ == 1 ? request.exchange.value : request.values[word];
      const bool right = writes_ ? executed_[request.values[word]] : read == first_value + request.places[word];
      wrong_ += request.exchange.status != Status::ok || !right ? 1 : 0;
    }
    through_ += words_;
  }

  bool writes_;
  std::uint32_t words_;
  FramedEngine& engine_;
  std::vector<Request> requests_;
  std::vector<bool> executed_;  // by value
  std::uint32_t made_ = 0;
  std::uint64_t through_ = 0;
  std::uint64_t wrong_ = 0;
};

}  // namespace

std::optional<TrafficKind> find_traffic(std::string_view name) {
  if (name == "posts") {
    return TrafficKind::posts;
  }
  if (name == "writes") {
    return TrafficKind::writes;
  }
  return name == "reads" ? std::optional(TrafficKind::reads) : std::nullopt;
}

std::unique_ptr<Traffic> make_traffic(TrafficKind kind, std::uint32_t message_words, std::uint32_t window,
                                      FramedEngine& engine, device::Device& device) {
  if (kind == TrafficKind::posts) {
    return std::make_unique<Posts>(message_words, engine);
  }
  return std::make_unique<Requests>(kind == TrafficKind::writes, message_words, window, engine, device);
}

}  // namespace unitylink::faults
