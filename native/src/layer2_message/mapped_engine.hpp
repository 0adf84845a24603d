// SPDX-License-Identifier: BSD-3-Clause
// MappedEngine is the engine for registers that are memory of this machine. There is no protocol, so there are no
// bytes, answers or repeats. submit() executes a request at once. advance() polls the groups that are due, because
// nothing publishes them.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "layer0_driver/mapped_memory.hpp"
#include "layer0_driver/status.hpp"
#include "layer2_message/engine.hpp"

namespace unitylink {

class MappedEngine final : public Engine {
 public:
  explicit MappedEngine(MappedMemory& memory) noexcept : memory_(memory) {}

  // One access, like submit() but without an Exchange. False: the engine has ended, or the address is beyond the
  // memory.
  [[nodiscard]] bool read(std::uint32_t address, std::uint32_t& value) noexcept;
  [[nodiscard]] bool write(std::uint32_t address, std::uint32_t value) noexcept;
  [[nodiscard]] bool read_many(std::span<const std::uint32_t> addresses, std::span<std::uint32_t> values,
                               bool atomic) noexcept;
  // The error of a request that this engine refused: bus_error or mismatch.
  [[nodiscard]] Outcome describe(const Exchange& exchange) const;

  void configure(const Configuration& configuration) noexcept override { configuration_ = configuration; }
  void submit(Exchange& exchange, std::uint64_t now_ns) noexcept override;
  void receive(std::span<const std::uint8_t>, std::uint64_t) noexcept override {}
  [[nodiscard]] std::span<const std::uint8_t> transmit(std::uint64_t) noexcept override { return {}; }
  void sent(std::size_t) noexcept override {}
  void advance(std::uint64_t now_ns) noexcept override;
  [[nodiscard]] std::uint64_t next_deadline_ns() const noexcept override { return next_due_ns_; }
  // No request is ever in flight, so these have nothing to do.
  void abandon(std::span<Exchange>, std::uint64_t) noexcept override {}
  void withdraw(std::span<Exchange>, std::uint64_t) noexcept override {}
  void claim(std::uint32_t group, PublishRing* ring) noexcept override;
  void end(Status status, std::uint64_t) noexcept override { forget(status); }
  void cut(Status, std::uint64_t) noexcept override {}
  void forget(Status status) noexcept override;

 private:
  // A group: its words, and when they are read next.
  struct Group {
    std::span<const std::uint32_t> addresses;  // owned by the subscription
    std::uint64_t period_ns = 0;               // 0: it is not polled
    std::uint64_t due_ns = 0;
  };

  [[nodiscard]] Status execute(Exchange& exchange, std::uint64_t now_ns) noexcept;
  [[nodiscard]] Status read_words(Exchange& exchange) noexcept;
  void define(const Exchange& exchange, std::uint64_t now_ns) noexcept;
  void poll(Group& group, PublishRing& ring, std::uint64_t now_ns) noexcept;
  void find_next() noexcept;
  void forget_groups() noexcept;

  MappedMemory& memory_;
  std::uint64_t next_due_ns_ = no_deadline;
  std::array<Group, protocol::limits::groups_max> groups_{};
  std::array<std::uint32_t, protocol::limits::group_size_max> words_{};
};

}  // namespace unitylink
