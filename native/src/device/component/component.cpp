// SPDX-License-Identifier: BSD-3-Clause
#include "device/component/component.hpp"

#include <algorithm>
#include <utility>

namespace unitylink::device {

namespace {
constexpr Clock access_clocks = 2;  // of register_slave
}

Component::Component(const ComponentConfiguration& configuration, std::string writable, bool snapshot)
    : writable_(std::move(writable)),
      snapshot_(snapshot),
      words_(writable_.size()),
      write_words_(writable_.size()),
      frozen_(writable_.size()),
      thawed_(writable_.size()),
      inputs_(configuration.bits(true)),
      outputs_(configuration.bits(false)),
      events_(configuration.event_groups.size()),
      wires_in_(configuration.count_wires(true)),
      wires_(configuration.count_wires(false)) {
  for (std::size_t number = 0; number < events_.size(); ++number) {
    events_[number].group = configuration.event_groups[number];
  }
}

void Component::advance(Clock state) {
  for (Component* source : sources_) {
    source->advance(state);  // then all that leads here until then is waiting
  }
  while (state_ < state) {
    const Clock edge = next_edge();
    if (!waiting_.empty() && waiting_.front().edge <= edge && waiting_.front().edge < state) {
      deliver(waiting_.front().edge);
      continue;
    }
    if (edge >= state) {
      break;
    }
    lower(edge);
    state_ = edge + 1;
    step(edge);
  }
  state_ = std::max(state_, state);
  arrive(state_);
  lower(state_);
}

Clock Component::next_edge() const noexcept {
  const Clock written = written_edge_ != never && written_edge_ >= state_ ? written_edge_ : never;
  return std::min(std::max(next(), state_), written);
}

// What leads here in state `edge` or before.
void Component::deliver(Clock edge) {
  while (!waiting_.empty() && waiting_.front().edge <= edge) {
    const Waiting one = waiting_.front();
    waiting_.pop_front();
    wired(one.input, one.value, std::max(one.edge, state_));
  }
}

void Component::connect(std::uint32_t output, Component& sink, std::uint32_t input) {
  OutputWire& one = wires_.at(output);
  one.leads.push_back({&sink, input});
  sink.sources_.push_back(this);
  sink.lead(input, one.value, 0);
}

void Component::watch_wire(std::uint32_t output, WireWatcher watcher) {
  OutputWire& one = wires_.at(output);
  one.watcher = std::move(watcher);
  if (one.watcher) {
    one.watcher(one.value, 0);
  }
}

void Component::lead(std::uint32_t input, WireValue value, Clock state) {
  constexpr std::size_t most = 1024;
  const auto later = [](Clock edge, const Waiting& other) { return edge < other.edge; };
  waiting_.insert(std::upper_bound(waiting_.begin(), waiting_.end(), state, later), {state, input, value});
  if (waiting_.size() > most) {  // nobody has looked for long
    advance(waiting_[most / 2].edge);
  }
}

void Component::wire(std::uint32_t output, WireValue value, Clock edge) {
  if (output >= wires_.size()) {
    return;
  }
  OutputWire& one = wires_[output];
  if (one.value.word() == value.word()) {
    return;
  }
  one.value = value;
  for (const Lead& lead : one.leads) {
    lead.sink->lead(lead.input, value, edge + 1);
  }
  if (one.watcher) {
    one.watcher(value, edge + 1);
  }
}

void Component::initial_word(std::uint32_t address, std::uint32_t value) noexcept {
  write_words_[address] = value;
  words_[address].value = value;
}

bool Component::is_heard() const noexcept {
  const auto leads_on = [](const OutputWire& wire) {
    return std::any_of(wire.leads.begin(), wire.leads.end(), [](const Lead& one) { return one.sink->is_heard(); });
  };
  return std::any_of(wires_.begin(), wires_.end(), leads_on) ||
         (sink_ &&
          std::any_of(events_.begin(), events_.end(), [](const Event& one) { return one.group.has_value(); })) ||
         std::any_of(outputs_.begin(), outputs_.end(), [](const OutputPin& pin) { return pin.is_watched(); });
}

Clock Component::next_clock() const noexcept {
  if (!is_heard()) {
    const Clock edge = next_edge();
    return edge == never ? never : std::max(edge, state_ + lag_most) + 1;
  }
  Clock soonest = never;
  for (const Event& one : events_) {
    soonest = std::min(soonest, one.falls);
  }
  const Clock edge = next_edge();
  return edge == never ? soonest : std::min(soonest, edge + 1);
}

Clock Component::begun(Clock at) {
  const Clock start = std::max({at, free_at_, state_});
  advance(start);
  deliver(start);
  free_at_ = start + access_clocks;
  return start;
}

// With a snapshot the slave reads the state before the edge at which it answers, which is one clock older.
std::uint32_t Component::seen(std::uint32_t address, Clock at) const noexcept {
  const Word& one = words_[address];
  return snapshot_ && one.changed != never && one.changed + 1 == at ? one.before : one.value;
}

BusReply Component::read(std::uint32_t address, Clock at) {
  Clock start = begun(at);
  if (address >= words_.size() || writable_[address] == '-') {
    return {BusStatus::error, 0};
  }
  start = admitted(address, false, start);
  free_at_ = start + access_clocks;
  look(address, start);
  const bool frozen = held_ && snapshot_ && thawed_[address] == 0;
  return {BusStatus::ok, frozen ? frozen_[address] : seen(address, start)};
}

BusStatus Component::write(std::uint32_t address, std::uint32_t value, Clock at) {
  Clock edge = begun(at);
  if (address >= words_.size() || writable_[address] != '1' || refuses(address, value)) {
    return BusStatus::error;
  }
  edge = admitted(address, true, edge);
  const Clock answered = offered(address, value, edge);
  free_at_ = answered + access_clocks;
  advance(edge + 1);  // this edge does not see the new word yet
  write_words_[address] = value;
  if (answered == edge) {
    thawed_[address] = 1;
  } else {
    thaw();
  }
  written_ = address;
  written_edge_ = edge + 1;
  stored(address, edge);
  return BusStatus::ok;
}

void Component::block(bool held, Clock at) {
  const Clock start = std::max({at, free_at_, state_});
  advance(start);
  held_ = held;
  if (!held || !snapshot_) {
    return;
  }
  for (std::uint32_t address = 0; address < words_.size(); ++address) {
    frozen_[address] = seen(address, start);
    thawed_[address] = 0;
  }
}

BusReply Component::get(std::uint32_t address, Clock at) {
  advance(at);
  deliver(at);
  if (address >= words_.size()) {
    return {BusStatus::error, 0};
  }
  look(address, at);
  return {BusStatus::ok, words_[address].value};
}

void Component::drive(std::uint32_t pin, bool level, Clock at) {
  const Clock edge = std::max(at, state_);
  advance(edge);
  driven(pin, level, edge);
}

OutputPin* Component::output_at(std::uint32_t pin, Clock state) {
  advance(state);
  if (pin >= outputs_.size()) {
    return nullptr;
  }
  show(pin, state);
  return &outputs_[pin];
}

bool Component::draw_bits(std::uint32_t pin, Modulator* source, Clock at) {
  const Clock edge = std::max(at, state_);
  advance(edge);
  return drawn(pin, source, edge);
}

void Component::word(std::uint32_t address, std::uint32_t value, Clock edge) noexcept {
  Word& one = words_[address];
  if (one.changed != edge) {
    one.before = one.value;
    one.changed = edge;
  }
  one.value = value;
}

// An event in each of two clocks is one long pulse, and so one rising edge.
void Component::event(std::uint32_t number, Clock edge) {
  Event& one = events_[number];
  if (one.falls != edge + 1) {
    lower(edge);
    send(one, true, edge + 1);
  }
  one.falls = edge + 2;
}

void Component::lower(Clock state) {
  for (Event& one : events_) {
    if (one.falls <= state) {
      send(one, false, std::exchange(one.falls, never));
    }
  }
}

void Component::send(const Event& one, bool high, Clock state) const {
  if (sink_ && one.group) {
    sink_(*one.group, high, state);
  }
}

}  // namespace unitylink::device
