// SPDX-License-Identifier: BSD-3-Clause
// One user of the link. It does one operation at a time on words of its own, and checks every result.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "faults/faulty_wire.hpp"
#include "faults/journal.hpp"
#include "layer2_message/engine.hpp"

namespace unitylink {
class FramedEngine;
}

namespace unitylink::faults {

// Counts shared by all clients.
struct Tally {
  std::uint64_t messages = 0;  // requests and posts
  std::uint64_t good = 0;
  std::uint64_t failed = 0;
  std::uint64_t unknown = 0;
  std::uint32_t nonce = 0;        // the last value written by any client
  std::uint64_t answered_ns = 0;  // when any client's request was last answered
  // the device gives false answers, so requests may end with errors although they could be repeated
  bool lied_to = false;
  std::uint64_t trusted_ns = ~std::uint64_t{0};  // from then on the device is honest again
  bool lists = true;                             // the device executes lists
};

class Client {
 public:
  static constexpr std::uint32_t words = 8;

  // `framed` is the engine, if it is a framed one.
  Client(std::uint32_t number, Engine& engine, FramedEngine* framed, Random& random, Tally& tally,
         std::uint64_t timeout_ns, std::uint32_t attempts);

  [[nodiscard]] Journal& journal() noexcept { return journal_; }
  [[nodiscard]] bool busy() const noexcept { return begun_; }
  // The latest end of its operation. `answered_ns` is when any client was last answered.
  [[nodiscard]] std::uint64_t limit_ns(std::uint64_t answered_ns) const noexcept {
    return std::max(begun_ns_, answered_ns) + timeout_ns_ * attempts_;
  }
  // Begins an operation if none is under way, and checks the current one if it is done. True: something was done.
  bool step(std::uint64_t now_ns);

 private:
  enum class Kind : std::uint8_t { read, write, read_many, transfer, chain, posts };
  static constexpr std::size_t exchanges_max = 8;

  void begin(std::uint64_t now_ns);
  void judge();
  void judge_reads(const Exchange& exchange, const std::uint32_t* addresses, std::size_t count);
  [[nodiscard]] std::uint32_t any_address() { return journal_.first() + static_cast<std::uint32_t>(random_() % words); }
  [[nodiscard]] std::uint32_t next_value() noexcept { return ++tally_.nonce; }
  Exchange& add(Operation operation);
  void add_write(bool chained);
  void post(std::uint64_t now_ns);

  Engine& engine_;
  FramedEngine* framed_;
  Random& random_;
  Tally& tally_;
  std::uint64_t timeout_ns_;
  std::uint32_t attempts_;
  Journal journal_;

  bool begun_ = false;
  std::uint64_t begun_ns_ = 0;
  Kind kind_ = Kind::read;
  std::size_t posts_ = 0;
  std::uint64_t session_ = 0;  // the session of these posts
  std::size_t used_ = 0;
  Batch batch_;
  std::array<Exchange, exchanges_max> exchanges_;
  std::array<std::uint32_t, words> read_addresses_{};
  std::array<std::uint32_t, words> read_values_{};
  std::array<std::uint32_t, words> write_addresses_{};
  std::array<std::uint32_t, words> write_values_{};
};

}  // namespace unitylink::faults
