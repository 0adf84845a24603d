// SPDX-License-Identifier: BSD-3-Clause
// Reads and writes: they are checked before anything is sent, then run, then their result is returned.
#include <algorithm>
#include <limits>

#include "layer2_message/failure.hpp"
#include "layer2_message/link.hpp"
#include "layer2_message/send_limit.hpp"

namespace unitylink {
namespace {

std::string hex(std::uint32_t value) { return hex_address(value, 0); }

Outcome no_room(std::size_t addresses, std::size_t values) {
  return {Status::range,
          "room for " + std::to_string(values) + " values, but " + std::to_string(addresses) + " addresses"};
}

Outcome at(Outcome outcome, std::size_t index) {
  outcome.index = static_cast<std::uint32_t>(index);
  return outcome;
}

}  // namespace

void Link::prepare(Exchange& exchange, const RequestOptions& how) const noexcept {
  exchange.checked = how.checked.value_or(options_.checked);
  exchange.repeat = how.repeat;
  exchange.timeout_ns = how.timeout_ns;
  exchange.attempts_max = options_.attempts;
  if (const std::uint64_t limit = sending_limit(); limit != 0) {
    const std::uint64_t now = now_ns();  // the link's own time may be another one. It is read first: rather too early
    exchange.expires_ns = std::max<std::uint64_t>(1, now + limit - std::min(real_ns(), limit));
  }
}

Outcome Link::check_address(std::uint32_t address, std::size_t index) const {
  // an address beyond mapped memory is reported when it is accessed
  if (address <= highest(configuration_.address_bytes) || mapped_) {
    return {};
  }
  Outcome outcome(Status::range, "address " + hex(address) + " does not fit the device's " +
                                     std::to_string(8 * configuration_.address_bytes) + "-bit addresses (at most " +
                                     hex(highest(configuration_.address_bytes)) + ")");
  outcome.has_address = true;
  outcome.address = address;
  return at(std::move(outcome), index);
}

Outcome Link::check_value(std::uint32_t address, std::uint32_t value, std::size_t index) const {
  if (value <= highest(configuration_.data_bytes)) {
    return {};
  }
  Outcome outcome(Status::range, "value " + hex(value) + " for " + hex_address(address, configuration_.address_bytes) +
                                     " does not fit the device's " + std::to_string(8 * configuration_.data_bytes) +
                                     "-bit words (at most " + hex(highest(configuration_.data_bytes)) + ")");
  outcome.has_address = true;
  outcome.address = address;
  return at(std::move(outcome), index);
}

// The error for the first address that does not fit the device. `index` is the number of the first address in its call.
Outcome Link::check_addresses(std::span<const std::uint32_t> addresses, std::size_t index) const {
  const std::uint32_t most = highest(configuration_.address_bytes);
  const auto wrong =
      std::find_if(addresses.begin(), addresses.end(), [most](std::uint32_t address) { return address > most; });
  return wrong == addresses.end() ? Outcome{}
                                  : check_address(*wrong, index + static_cast<std::size_t>(wrong - addresses.begin()));
}

Outcome Link::check_writes(std::span<const std::uint32_t> addresses, std::span<const std::uint32_t> values,
                           std::size_t index) const {
  const std::uint32_t address_most = highest(configuration_.address_bytes);
  const std::uint32_t value_most = highest(configuration_.data_bytes);
  for (std::size_t word = 0; word < addresses.size(); ++word) {
    if (addresses[word] > address_most || values[word] > value_most) {
      Outcome outcome = check_address(addresses[word], index + word);
      return outcome.ok() ? check_value(addresses[word], values[word], index + word) : outcome;
    }
  }
  return {};
}

Outcome Link::check(const Exchange& exchange, std::size_t index) {
  if (exchange.checked && !checksums_ && !framed_) {
    return {Status::mismatch, "the device has no checksums (it refuses '$'); ask without"};
  }
  if (exchange.operation == Operation::transfer) {
    Outcome outcome = check_writes(exchange.write_addresses, exchange.write_values, index);
    return outcome.ok() ? check_addresses(exchange.addresses, exchange.write_addresses.size()) : outcome;
  }
  if (exchange.operation == Operation::read_many) {
    if (exchange.addresses.empty() || exchange.addresses.size() > words_at_once(exchange.repeat)) {
      return {Status::mismatch, "the device reads at most " + std::to_string(configuration_.read_many) +
                                    " words in one message, not " + std::to_string(exchange.addresses.size())};
    }
    return check_addresses(exchange.addresses, index);
  }
  if (Outcome outcome = check_address(exchange.address, index); !outcome.ok()) {
    return outcome;
  }
  if (exchange.operation != Operation::write) {
    return {};
  }
  if (Outcome outcome = check_value(exchange.address, exchange.value, index); !outcome.ok()) {
    return outcome;
  }
  return may_write();
}

// 2012 gateware whose words are not 32 bits writes wrong values, mostly 0. So a device with such words is asked, once,
// which gateware it has.
Outcome Link::may_write() {
  if (configuration_.data_bytes == 4 || framed_) {
    return {};
  }
  if (gateware_ == Gateware::automatic && !checksums_) {  // the question is a '$', so it needs a device with checksums
    return {
        Status::mismatch,
        "2012 gateware with " + std::to_string(8 * configuration_.data_bytes) +
            "-bit words writes 0 whatever value it is sent, and gateware without checksums cannot be asked which it "
            "is; add gateware=2012 or gateware=corrected to the URL"};
  }
  if (gateware_ == Gateware::automatic) {
    Exchange question;
    question.operation = Operation::empty_message;
    question.attempts_max = options_.attempts;
    run(std::span(&question, 1));
    if (question.status == Status::ok && question.datalink_code == protocol::datalink_error::checksum) {
      gateware_ = Gateware::corrected;
      const std::scoped_lock lock(mutex_);
      classic_.expect_corrected_gateware();
    } else if (question.error == protocol::application_error::incomplete_command) {
      gateware_ = Gateware::published_2012;
    } else {
      return outcome_of(question).ok() ? Outcome{Status::protocol_error,
                                                 "the device did not say whether its gateware is corrected; "
                                                 "add gateware=2012 or gateware=corrected to the URL"}
                                       : outcome_of(question);
    }
  }
  if (gateware_ == Gateware::published_2012) {
    return {Status::mismatch,
            "this is 2012 gateware with " + std::to_string(8 * configuration_.data_bytes) +
                "-bit words: it writes 0 whatever value it is sent, so writes are refused; use 32-bit words or "
                "corrected gateware (gateware=corrected in the URL if it is)"};
  }
  return {};
}

Outcome Link::outcome_of(const Exchange& exchange) {
  if (exchange.status == Status::ok) {
    return {};
  }
  const std::scoped_lock lock(mutex_);
  if (mapped_ && (exchange.status == Status::bus_error || exchange.status == Status::mismatch)) {
    return mapped_->describe(exchange);
  }
  return describe(exchange,
                  {.address_bytes = configuration_.address_bytes,
                   .last_answer_ns = engine_->last_answer_ns(),
                   .reason = !reason_.empty()                                                   ? reason_
                             : exchange.status == Status::down || exchange.ended_ns == lost_ns_ ? lost_because_
                                                                                                : std::string_view{}});
}

Outcome Link::run_one(Exchange& exchange) {
  if (Outcome outcome = check(exchange, 0); !outcome.ok()) {
    return outcome;
  }
  run(std::span(&exchange, 1));
  return outcome_of(exchange);
}

Outcome Link::read(std::uint32_t address, std::uint32_t& value, const RequestOptions& how) {
  if (read_at_once(address, value)) {
    return {};
  }
  Exchange exchange;
  prepare(exchange, how);
  exchange.address = address;
  Outcome outcome = run_one(exchange);
  value = exchange.value;
  return outcome;
}

Outcome Link::write(std::uint32_t address, std::uint32_t value, const RequestOptions& how) {
  if (write_at_once(address, value)) {
    return {};
  }
  Exchange exchange;
  prepare(exchange, how);
  exchange.operation = Operation::write;
  exchange.address = address;
  exchange.value = value;
  return run_one(exchange);
}

bool Link::read_at_once(std::uint32_t address, std::uint32_t& value) noexcept {
  if (!mapped_) {
    return false;
  }
  const Lock lock(mutex_, std::try_to_lock);
  return lock.owns_lock() && mapped_->read(address, value);
}

bool Link::read_at_once(std::span<const std::uint32_t> addresses, std::span<std::uint32_t> values,
                        bool atomic) noexcept {
  if (!mapped_) {
    return false;
  }
  const Lock lock(mutex_, std::try_to_lock);
  return lock.owns_lock() && mapped_->read_many(addresses, values, atomic);
}

bool Link::write_at_once(std::uint32_t address, std::uint32_t value) noexcept {
  if (!mapped_) {
    return false;
  }
  const Lock lock(mutex_, std::try_to_lock);
  return lock.owns_lock() && mapped_->write(address, value);
}

// ---- vectors

// The most words of one request; 0: each word needs its own request.
std::size_t Link::words_at_once(bool repeat) const noexcept {
  return framed_ ? words_read(repeat) : mapped_ ? std::numeric_limits<std::size_t>::max() : configuration_.read_many;
}

Outcome Link::plan_read_many(Call& call, std::span<const std::uint32_t> addresses, std::span<std::uint32_t> values,
                             bool atomic, const RequestOptions& how) {
  const std::size_t block = words_at_once(how.repeat);
  if (atomic && addresses.size() > std::max<std::size_t>(block, 1)) {
    return {Status::mismatch, "the device reads at most " + std::to_string(std::max<std::size_t>(block, 1)) +
                                  " words at once, not " + std::to_string(addresses.size()) +
                                  "; read them in parts, or without atomic"};
  }
  if (block == 0 || (framed_ && addresses.size() == 1)) {
    return plan_read_each(call, addresses, values, how);
  }
  if (values.size() < addresses.size()) {
    return no_room(addresses.size(), values.size());
  }
  call.block = block;
  call.exchanges.resize(addresses.empty() ? 0 : (addresses.size() - 1) / block + 1);
  for (std::size_t index = 0; index < call.exchanges.size(); ++index) {
    Exchange& exchange = call.exchanges[index];
    const std::size_t begin = index * block;
    const std::size_t count = std::min(block, addresses.size() - begin);
    prepare(exchange, how);
    exchange.operation = Operation::read_many;
    exchange.atomic = atomic;
    exchange.addresses = addresses.subspan(begin, count);
    exchange.values = values.subspan(begin, count);
    exchange.batch = &call.batch;
    if (Outcome outcome = check(exchange, begin); !outcome.ok()) {
      return outcome;
    }
  }
  return {};
}

Outcome Link::plan_read_each(Call& call, std::span<const std::uint32_t> addresses, std::span<std::uint32_t> values,
                             const RequestOptions& how) {
  if (values.size() < addresses.size()) {
    return no_room(addresses.size(), values.size());
  }
  call.values = values;
  call.exchanges.resize(addresses.size());
  for (std::size_t index = 0; index < addresses.size(); ++index) {
    Exchange& exchange = call.exchanges[index];
    prepare(exchange, how);
    exchange.address = addresses[index];
    exchange.batch = &call.batch;
    if (Outcome outcome = check(exchange, index); !outcome.ok()) {
      return outcome;
    }
  }
  return {};
}

Outcome Link::plan_write_many(Call& call, std::span<const std::uint32_t> addresses,
                              std::span<const std::uint32_t> values, const RequestOptions& how) {
  if (values.size() != addresses.size()) {
    return {Status::range,
            std::to_string(addresses.size()) + " addresses but " + std::to_string(values.size()) + " values"};
  }
  if (const std::size_t block = words_written(); block > 1 && addresses.size() > 1) {
    call.block = block;
    call.exchanges.resize((addresses.size() + block - 1) / block);
    for (std::size_t index = 0; index < call.exchanges.size(); ++index) {
      Exchange& exchange = call.exchanges[index];
      const std::size_t begin = index * block;
      const std::size_t count = std::min(block, addresses.size() - begin);
      prepare(exchange, how);
      exchange.operation = Operation::transfer;
      exchange.write_addresses = addresses.subspan(begin, count);
      exchange.write_values = values.subspan(begin, count);
      exchange.chained = index > 0;
      exchange.batch = &call.batch;
      if (Outcome outcome = check(exchange, begin); !outcome.ok()) {
        return outcome;
      }
    }
    return {};
  }
  call.exchanges.resize(addresses.size());
  for (std::size_t index = 0; index < addresses.size(); ++index) {
    Exchange& exchange = call.exchanges[index];
    prepare(exchange, how);
    exchange.operation = Operation::write;
    exchange.chained = framed_ && index > 0;
    exchange.address = addresses[index];
    exchange.value = values[index];
    exchange.batch = &call.batch;
    if (Outcome outcome = check(exchange, index); !outcome.ok()) {
      return outcome;
    }
  }
  return {};
}

// The first failure decides. All requests after it are cancelled or void.
Outcome Link::result(const Call& call) {
  const std::span<const Exchange> exchanges(call.exchanges);
  if (!call.values.empty()) {
    for (std::size_t index = 0; index < exchanges.size(); ++index) {
      call.values[index] = exchanges[index].value;
    }
  }
  const std::size_t index = first_failed(exchanges);
  if (index == exchanges.size()) {
    return {};
  }
  const auto failed = exchanges.begin() + static_cast<std::ptrdiff_t>(index);
  Outcome outcome = at(outcome_of(*failed), index * call.block + failed->words);
  if (std::any_of(exchanges.begin(), failed, [](const Exchange& e) { return e.writes(); })) {
    outcome = behind_writes(std::move(outcome));
  }
  if (failed->writes() && exchanges.size() > 1) {
    const auto kept = std::count_if(exchanges.begin(), exchanges.end(),
                                    [](const Exchange& e) { return e.status == Status::cancelled; });
    outcome.text = in_words([&] {
      return (failed->operation == Operation::write ? "write " : "message ") + std::to_string(index + 1) + " of " +
             std::to_string(exchanges.size()) + ": " + outcome.text +
             (kept > 0 ? "; " + std::to_string(kept) + " later ones were not sent" : "");
    });
  }
  return outcome;
}

Outcome Link::read_many(std::span<const std::uint32_t> addresses, std::span<std::uint32_t> values, bool atomic,
                        const RequestOptions& how) {
  Call call;
  if (Outcome outcome = plan_read_many(call, addresses, values, atomic, how); !outcome.ok()) {
    return outcome;
  }
  run(call.exchanges);
  return result(call);
}

Outcome Link::read_each(std::span<const std::uint32_t> addresses, std::span<std::uint32_t> values,
                        const RequestOptions& how) {
  Call call;
  if (Outcome outcome = plan_read_each(call, addresses, values, how); !outcome.ok()) {
    return outcome;
  }
  run(call.exchanges);
  return result(call);
}

Outcome Link::write_many(std::span<const std::uint32_t> addresses, std::span<const std::uint32_t> values,
                         const RequestOptions& how) {
  Call call;
  if (Outcome outcome = plan_write_many(call, addresses, values, how); !outcome.ok()) {
    return outcome;
  }
  run(call.exchanges);
  return result(call);
}

void Link::submit(Call& call) {
  start_reader();
  const std::scoped_lock lock(mutex_);
  reader_kept_ = true;
  submit_all(call.exchanges);
  if (reader_patient_) {  // the answer must not wait for it, if a callback takes long
    idle_.notify_one();
  }
  if (leading_ && (blocked_ || engine_->next_deadline_ns() < leading_until_ns_)) {
    wake();
  }
}

void Link::withdraw(Call& call) {
  const std::scoped_lock lock(mutex_);
  const std::uint64_t now = now_ns();
  engine_->withdraw(call.exchanges, now);
  flush(now);
  wake();  // the next deadline may be earlier now
}

}  // namespace unitylink
