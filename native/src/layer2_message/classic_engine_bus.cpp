// SPDX-License-Identifier: BSD-3-Clause
// After a bus timeout (E_BAT), 2012 gateware stays in its bus cycle, at address 0. If no slave answers there either,
// the next access gives the cycle its address, but the cycle keeps its own direction. So a read that timed out swallows
// the next write. A write that timed out writes 0 where the next request reads or writes. No answer shows this.
//
// So after a read has timed out, a word that is known to answer is read. This happens before anything else is sent, and
// before the caller gets the timeout. It ends the cycle and does no harm. After a write nothing can be done from here,
// and its error names the hazard. Requests that were sent after a timeout are not accepted: they are repeated if that
// does no harm.
#include "layer2_message/classic_engine.hpp"

namespace unitylink {
namespace {

bool uses_bus(Operation operation) noexcept {
  return operation == Operation::read || operation == Operation::read_many || operation == Operation::write;
}

}  // namespace

// The bus has acknowledged an access, perhaps with an error. So a cycle that was left over has ended.
void ClassicEngine::on_bus_answer(Exchange& exchange, bool done) noexcept {
  if (!uses_bus(exchange.operation)) {
    return;
  }
  const StrayCycle before = stray_cycle_;
  stray_cycle_ = StrayCycle::none;
  exchange.stray_cycle = done && (before == StrayCycle::write || (before == StrayCycle::read && exchange.writes()));
  // the cycle did no harm, so the earlier requests need not report it
  if (before == StrayCycle::read && !exchange.writes()) {
    for (Exchange* other = in_flight_.front(); other != nullptr && other != &exchange;
         other = ExchangeList::after(*other)) {
      other->stray_cycle = other->stray_cycle && (other->writes() || other->status == Status::ok);
    }
  }
  if (done && !exchange.stray_cycle && exchange.repeat && !exchange.writes()) {
    harmless_address_ = exchange.operation == Operation::read ? exchange.address : exchange.addresses.front();
  }
}

void ClassicEngine::on_bus_timeout(Exchange& exchange) noexcept {
  if (corrected_ || !uses_bus(exchange.operation)) {
    return;
  }
  if (&exchange == &freeing_) {
    harmless_address_.reset();  // this address no longer answers
  }
  if (stray_cycle_ == StrayCycle::none || exchange.words > 0) {  // otherwise the earlier cycle is still open
    stray_cycle_ = exchange.writes() ? StrayCycle::write : StrayCycle::read;
  }
  exchange.stray_cycle = true;
}

bool ClassicEngine::wants_bus_freed() const noexcept {
  const bool under_way = freeing_.state_ == Exchange::State::waiting || freeing_.state_ == Exchange::State::in_flight;
  return stray_cycle_ == StrayCycle::read && harmless_address_ && !under_way && oldest_ == nullptr &&
         state_ == State::ready && !ended_ && !(in_flight_.empty() && waiting_.empty());
}

// Reads a word to free the bus. The requests before it get their results when the bus is free.
void ClassicEngine::free_bus() noexcept {
  const Exchange& cause = in_flight_.empty() ? *waiting_.front() : *in_flight_.front();
  const bool checked = cause.checked;
  const std::uint64_t timeout_ns = cause.timeout_ns;
  freeing_ = {};
  freeing_.address = *harmless_address_;
  freeing_.checked = checked;
  freeing_.timeout_ns = timeout_ns;
  prepare(freeing_);
  waiting_.push_front(freeing_);
}

}  // namespace unitylink
