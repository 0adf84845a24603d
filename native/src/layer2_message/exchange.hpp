// SPDX-License-Identifier: BSD-3-Clause
// One request and its result. The caller owns it, and the buffers that it points to, until done().
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string_view>

#include "layer0_driver/status.hpp"
#include "unitylink/protocol.hpp"

namespace unitylink {

class PublishRing;

// The highest number that fits into so many bytes.
[[nodiscard]] constexpr std::uint32_t highest(std::uint32_t bytes) noexcept {
  return bytes >= 4 ? 0xFFFFFFFFu : (1u << (8 * bytes)) - 1;
}

enum class Operation : std::uint8_t {
  // both protocols
  resynchronise,  // sends only a fence, or opens a session; a link begins with it. Done when the device has answered
  read,
  read_many,
  write,
  // the classic protocol
  empty_message,  // "$": corrected gateware answers with a wrong checksum, 2012 gateware with an unknown command
  write_group_addresses,
  write_group_rate,
  read_group,
  enable_publishing,
  enable_checked_publishing,
  disable_publishing,
  write_event_mask,
  read_event_mask,
  // the framed protocol
  transfer,  // words to write, then words to read, in one message
  list,      // any operations of a list, in order, in one message
  define_group,
  define_exchange,  // the words of an exchange group
  exchange,         // writes all outputs of an exchange group and reads all its inputs
  read_control,
  write_control,
  forward,      // a request of another host, as it is
  synchronise,  // asks how many posts were executed
  close_session,
};

// One word of a list and its operation (protocol::list_operation: read, read_fifo, write, write_fifo, write_masked,
// add).
struct ListWord {
  std::uint32_t operation = protocol::list_operation::read;
  std::uint32_t address = 0;
  std::uint32_t value = 0;
  std::uint32_t mask = 0;

  [[nodiscard]] constexpr bool writes() const noexcept { return operation >= protocol::list_operation::write; }
};

// A word of an exchange group. Only its low `bytes` bytes are sent.
struct ExchangeWord {
  std::uint32_t address = 0;
  std::uint32_t bytes = 0;
};

// Requests of one call that stop after one of them has failed.
struct Batch {
  bool failed = false;
};

struct Exchange {
  // The request.
  Operation operation = Operation::read;
  bool checked = false;
  bool repeat = true;  // it may be sent twice without harm
  // read, write: the address; group and exchange commands: the group; control commands: the register
  std::uint32_t address = 0;
  std::uint32_t value = 0;                         // write: the word; define_group: the divisor
  std::span<const std::uint32_t> addresses;        // read_many, transfer; of a group
  std::span<const std::uint32_t> write_addresses;  // transfer
  std::span<const std::uint32_t> write_values;     // also for exchange: the words of the outputs
  std::span<const ListWord> steps;                 // list
  std::span<const ExchangeWord> outputs;           // define_exchange, exchange
  std::span<const ExchangeWord> inputs;
  bool atomic = false;                 // transfer, read_many: the bus is held from the first word to the last
  bool chained = false;                // only after the exchange submitted before it was executed
  bool on_event = false;               // define_group: also publish on its event input
  std::span<const std::uint8_t> mask;  // write_event_mask, most significant byte first
  std::span<std::uint32_t> values;     // room for the words read; read_group's rate and addresses
  std::uint8_t kind = 0;               // forward: the kind of its frame
  bool changes = false;                // forward: it may write
  std::span<const std::uint8_t> body;  // forward: what follows the id
  std::span<std::uint8_t> answer;      // forward: room for exactly what follows `posts` in a successful reply
  std::uint64_t timeout_ns = 0;        // per attempt
  std::uint32_t attempts_max = 1;      // 0 once the caller has given it up
  std::uint64_t expires_ns = 0;        // framed: from then on no copy of it is sent; 0: no such time
  Batch* batch = nullptr;
  PublishRing* ring = nullptr;                    // for a group: gets its publishes from now on
  void* owner = nullptr;                          // for on_done
  void (*on_done)(Exchange&) noexcept = nullptr;  // called once, with the engine's lock held; must not call the engine

  // The result.
  Status status = Status::ok;
  std::string_view error;                // the device's E_xxx; empty if it gave none
  std::uint8_t datalink_code = 0;        // the last ?xx that made the request void; 0: none
  std::uint32_t words = 0;               // words that were executed; read_group: addresses
  std::uint8_t first_failure = 0;        // synchronise: the status of the first failed post
  std::uint8_t reply_status = no_reply;  // of the framed protocol
  static constexpr std::uint8_t no_reply = 0xFF;
  // how often an answer was requested: by the request itself, or by a fence for it
  std::uint32_t attempts = 0;
  bool sent = false;  // at least one of its bytes was sent
  // 2012 gateware only: the request ended in a bus timeout, and its bus cycle may still be open. Or it was answered
  // while an earlier cycle may have been open.
  bool stray_cycle = false;
  std::uint64_t begun_ns = 0;
  std::uint64_t ended_ns = 0;

  [[nodiscard]] bool done() const noexcept { return state_ == State::done; }
  [[nodiscard]] bool expired(std::uint64_t now_ns) const noexcept { return expires_ns != 0 && now_ns >= expires_ns; }
  // Its status if it is not sent (again).
  [[nodiscard]] Status cut_off() const noexcept {
    return !sent ? Status::cancelled : writes() ? Status::unknown : Status::timeout;
  }
  // The same, but because another request of its call has failed. That request is reported, so a read here is only
  // cancelled.
  [[nodiscard]] Status left_out() const noexcept { return writes() ? cut_off() : Status::cancelled; }
  // Whether it changes something on the device's bus.
  [[nodiscard]] bool writes() const noexcept {
    return operation == Operation::write || !write_addresses.empty() || changes ||
           (operation == Operation::exchange && !outputs.empty()) ||
           std::any_of(steps.begin(), steps.end(), [](const ListWord& word) { return word.writes(); });
  }

 private:
  friend class Engine;
  friend class ClassicEngine;
  friend class FramedEngine;
  friend class ExchangeList;
  enum class State : std::uint8_t { idle, waiting, in_flight, replied, done };
  State state_ = State::idle;
  std::uint32_t failures_ = 0;       // failed attempts of this request itself
  std::uint32_t request_bytes_ = 0;  // classic
  std::uint32_t reply_bytes_ = 0;    // classic
  std::uint64_t begin_ = 0;          // classic: position of its first byte among all bytes sent
  std::uint64_t follows_ = 0;        // framed: posts made before it
  std::uint64_t limit_ns_ = 0;       // when it ends at the latest; 0: not yet decided
  Exchange* next_ = nullptr;
};

// A queue that links the exchanges themselves: it allocates nothing, and has no limit.
class ExchangeList {
 public:
  [[nodiscard]] bool empty() const noexcept { return first_ == nullptr; }
  [[nodiscard]] Exchange* front() const noexcept { return first_; }
  [[nodiscard]] static Exchange* after(const Exchange& exchange) noexcept { return exchange.next_; }
  void push_back(Exchange& exchange) noexcept {
    exchange.next_ = nullptr;
    (first_ == nullptr ? first_ : last_->next_) = &exchange;
    last_ = &exchange;
  }
  Exchange& pop_front() noexcept {
    Exchange& exchange = *first_;
    first_ = exchange.next_;
    exchange.next_ = nullptr;
    return exchange;
  }
  void push_front(Exchange& exchange) noexcept {
    exchange.next_ = first_;
    if (first_ == nullptr) {
      last_ = &exchange;
    }
    first_ = &exchange;
  }
  // Puts all of `list` before the exchanges here.
  void prepend(ExchangeList& list) noexcept {
    if (!list.empty()) {
      list.last_->next_ = first_;
      if (first_ == nullptr) {
        last_ = list.last_;
      }
      first_ = list.first_;
      list.first_ = nullptr;
    }
  }

 private:
  Exchange* first_ = nullptr;
  Exchange* last_ = nullptr;
};

}  // namespace unitylink
