// SPDX-License-Identifier: BSD-3-Clause
// The bus slave of a TosNet network, as its master sees it: 11-bit word map, mirrored memory, commits, asynchronous
// channel.
//
// Time is the network cycle. At the strobe that begins a cycle, a pending commit takes effect. The outputs of the nodes
// then appear in the memory that the PC reads, or at the end of the block that the PC is reading. Two hazards are those
// of the original, on purpose:
//   - the banks swap without a copy: a word that is not rewritten before a commit returns to its value of two commits
//     ago;
//   - a write while a commit is pending (CWP) aborts the commit (CWA), and is still written to the bank.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "device/bus.hpp"
#include "device/configuration.hpp"
#include "device/ring.hpp"

namespace unitylink::device {

// One word of the asynchronous channel: up to four bytes, the first in bits 31-24.
struct AsyncWord {
  std::uint32_t data = 0;
  std::uint8_t last = 3;  // index of the last valid byte
  std::uint8_t node = 0;
};

// One direction of the asynchronous channel: a queue whose words are passed on with the network cycle.
class TosnetChannel {
 public:
  // False if there is no room.
  bool put(const AsyncWord& word) noexcept { return queue_.push(word); }
  [[nodiscard]] bool full() const noexcept { return queue_.full(); }
  void travel(std::uint64_t cycles) noexcept {
    arrived_ =
        std::min<std::uint64_t>(queue_.size(), arrived_ + std::min<std::uint64_t>(cycles, depth) * words_a_cycle);
  }
  [[nodiscard]] bool arrived() const noexcept { return arrived_ > 0; }
  // With arrived().
  [[nodiscard]] const AsyncWord& front() const noexcept { return queue_.front(); }
  AsyncWord take() noexcept {
    const AsyncWord word = queue_.front();
    queue_.pop();
    --arrived_;
    return word;
  }

 private:
  static constexpr std::size_t depth = 128;
  static constexpr std::size_t words_a_cycle = 3;
  Ring<AsyncWord> queue_{depth};
  std::uint64_t arrived_ = 0;
};

class Tosnet final : public Bus {
 public:
  // `sink` gets the event of each exchange, if the configuration has a group for it.
  explicit Tosnet(const TosnetConfiguration& configuration, EventSink sink = {});

  BusReply read(std::uint32_t address, Clock now) override;
  BusStatus write(std::uint32_t address, std::uint32_t value, Clock now) override;
  void block(bool held, Clock now) override;
  // The nodes' side: `get` reads the committed IN words, `set` writes the OUT words of nodes other than the PC's.
  BusReply get(std::uint32_t address, Clock now) override;
  BusStatus set(std::uint32_t address, std::uint32_t value, Clock now) override;
  BusStatus preset(std::uint32_t address, std::uint32_t value, Clock now) override;
  [[nodiscard]] Clock settles(std::uint32_t address) const noexcept override;  // with the next cycle
  [[nodiscard]] Clock next_clock() const noexcept override;
  void advance(Clock now) override;

  // The network breaks (no strobes, ONLINE = 0, commits stay pending), or comes back (reset counter + 1).
  void set_online(bool online, Clock now);
  // One of the rings breaks, or is whole again. The network is online while one is. False: there is no such ring.
  bool set_ring(std::uint32_t ring, bool whole, Clock now);
  // A node leaves the ring, or comes back. The others find their ring anew (reset counter + 1). Meanwhile the PC reads
  // the node's last words. False: there is no such node.
  bool set_node(std::uint32_t id, bool present, Clock now);
  // Is this node in a ring that is complete? If not, it has its safe values.
  [[nodiscard]] bool is_commanded(std::uint32_t id) const noexcept { return online_ && (absent_ >> id & 1u) == 0; }
  // Components in the nodes: `exchanged` is called in each cycle, and when the network breaks or is whole again, or a
  // node leaves or comes. It may call `get` and `set`.
  using Exchanged = std::function<void(Clock now)>;
  void attach(Exchanged exchanged) { exchanged_ = std::move(exchanged); }

  // A cycle is damaged: error counter + 1, PCKERR until the next cycle.
  void damage_cycle(Clock now);

  // async_take() takes a word that the PC has sent, and the network has delivered. async_give() sends a word of a node.
  // False: no word, or no room.
  bool async_take(AsyncWord& word, Clock now);
  bool async_give(const AsyncWord& word, Clock now);

 private:
  using Bank = std::array<std::uint32_t, protocol::tosnet::memory_words>;

  void show();
  void set_rings_down(std::uint32_t down, Clock now);
  [[nodiscard]] std::uint32_t all_rings() const noexcept { return (1u << configuration_.rings) - 1; }
  void restart();
  void exchange(Clock now);
  [[nodiscard]] bool writable(std::uint32_t address) const noexcept;
  [[nodiscard]] std::uint32_t status() const noexcept;
  [[nodiscard]] std::uint32_t network_register(std::uint32_t index) const noexcept;

  TosnetConfiguration configuration_;
  EventSink sink_;
  Exchanged exchanged_;
  std::array<Bank, 2> banks_{};  // written by the PC; banks_[write_bank_] is the hidden one
  Bank outputs_{};               // the OUT words of the nodes
  Bank seen_{};                  // the same words as the PC reads them
  std::uint32_t write_bank_ = 0;
  std::uint32_t shown_bank_ = 1;  // the bank that the PC reads
  Clock cycles_ = 0;              // strobes since reset, also those of an offline network
  std::uint32_t packets_ = 0;
  std::uint32_t resets_ = 0;
  std::uint32_t errors_ = 0;
  std::uint32_t skipped_ = 0;
  std::uint32_t rings_down_ = 0;  // bit i: ring i is broken
  std::uint32_t absent_ = 0;      // bit i: the node with the id i has left
  bool online_ = true;
  bool halted_ = false;
  bool damaged_ = false;
  bool commit_pending_ = false;
  bool commit_aborted_ = false;
  bool read_refused_ = false;
  bool write_refused_ = false;
  bool held_ = false;
  bool stale_ = false;  // a cycle ended within a block, and its words are not shown yet
  AsyncWord async_control_{};
  TosnetChannel to_nodes_;
  TosnetChannel from_nodes_;
};

}  // namespace unitylink::device
