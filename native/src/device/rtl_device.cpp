// SPDX-License-Identifier: BSD-3-Clause
#include "device/rtl_device.hpp"

#include <algorithm>
#include <dlfcn.h>
#include <utility>

namespace unitylink::device {

namespace {

constexpr Clock reset_clocks = 4;
constexpr Clock chunk_clocks = 4096;      // about a millisecond of work
constexpr Clock unseen_clocks = 10;       // in steps
constexpr Clock looks_per_second = 2000;  // for output without a request

// The library stays mapped, because a model may leave thread-local destructors behind.
const unitylink_rtl* load(const std::string& library, const RtlWords& words, std::uint32_t groups) {
  void* handle = ::dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) {
    throw RtlError(std::string("the compiled gateware cannot be loaded: ") + ::dlerror());
  }
  const auto entry = reinterpret_cast<const unitylink_rtl* (*)()>(::dlsym(handle, "unitylink_rtl_model"));
  if (entry == nullptr || entry()->abi != UNITYLINK_RTL_ABI) {
    throw RtlError(library + ": not compiled gateware for this version of Unity-Link");
  }
  const unitylink_rtl* model = entry();
  const bool has_events = model->groups > 0;  // a user's design may have no event inputs
  if (model->read_words != words.read.size() || model->write_words != words.write.size() ||
      (has_events && model->groups != groups)) {
    throw RtlError(library + ": compiled from another design (" + std::to_string(model->read_words) +
                   " words to read, " + std::to_string(model->write_words) + " to write, " +
                   std::to_string(model->groups) + " groups)");
  }
  return model;
}

std::unordered_map<std::uint32_t, std::uint32_t> indices(const std::vector<std::uint32_t>& addresses) {
  std::unordered_map<std::uint32_t, std::uint32_t> result;
  for (std::uint32_t index = 0; index < addresses.size(); ++index) {
    result.emplace(addresses[index], index);
  }
  return result;
}

}  // namespace

RtlDevice::RtlDevice(const std::string& library, RtlWords words, const DeviceConfiguration& configuration)
    : configuration_(configuration),
      model_(load(library, words, configuration.groups)),
      state_(model_->create(), model_->destroy),
      read_index_(indices(words.read)),
      write_index_(indices(words.write)),
      given_(words.read.size()),
      write_addresses_(words.write),
      input_(configuration_),
      output_(configuration_),
      outside_(model_, state_.get(), std::move(words.pins), configuration_.components) {
  if (!state_) {
    throw RtlError(library + ": no memory for the compiled gateware");
  }
  words_ = model_->words(state_.get());
  for (const std::uint32_t address : configuration_.flag_words) {
    if (read_index_.contains(address) && write_index_.contains(address)) {
      flags_.push_back({read_index_.at(address), write_index_.at(address)});
    }
  }
  hold_reset();
}

void RtlDevice::hold_reset() {
  pins_ = {};
  pins_.reset = 1;
  for (Clock clock = 0; clock < reset_clocks; ++clock) {
    model_->clock(state_.get(), &pins_);
  }
  pins_.reset = 0;
  pins_.tx_ready = 1;
  model_->clock(state_.get(), &pins_);
}

void RtlDevice::reset() {
  hold_reset();
  input_ = PhysicalReceiver(configuration_);
  output_ = PhysicalTransmitter(configuration_);
  remember();
}

void RtlDevice::observe(std::function<void(std::uint32_t, std::uint32_t)> on_change) {
  on_change_ = std::move(on_change);
  seen_.assign(write_addresses_.size(), 0);
  remember();
}

void RtlDevice::remember() { std::copy_n(words_, seen_.size(), seen_.begin()); }

void RtlDevice::look() {
  if (std::equal(seen_.begin(), seen_.end(), words_)) {
    return;
  }
  for (std::size_t index = 0; index < seen_.size(); ++index) {
    const std::uint32_t value = words_[index];
    if (std::exchange(seen_[index], value) != value) {
      on_change_(write_addresses_[index], value);
    }
  }
}

void RtlDevice::set_event(std::uint32_t group, bool high) {
  if (group >= configuration_.groups) {
    return;
  }
  std::erase(falling_, group);
  if (!high && std::find(rising_.begin(), rising_.end(), group) != rising_.end()) {
    falling_.push_back(group);
    return;
  }
  if (high) {
    rising_.push_back(group);
  }
  model_->set_event(state_.get(), group, high ? 1 : 0);
}

void RtlDevice::step() {
  if (pins_.rx_valid != 0 && pins_.rx_ready != 0) {
    input_.pop();
    pins_.rx_valid = 0;
    ++statistics_.bytes_received;
  }
  if (pins_.tx_valid != 0 && pins_.tx_ready != 0) {
    statistics_.datalink_errors += pins_.tx_data == '?' ? 1 : 0;  // only the report of an error has this character
    output_.put(static_cast<char>(pins_.tx_data), clock_);
  }
  if (input_.next_arrival() <= clock_ && !input_.arrive()) {
    ++statistics_.overruns;
    receive_error(overrun);
  }
  if (output_.next_departure() <= clock_) {
    output_.depart();
  }
  if (pins_.rx_valid == 0 && input_.readable() <= clock_) {
    pins_.rx_valid = 1;
    pins_.rx_data = input_.front();
  }
  pins_.tx_ready = output_.room() > 0 ? 1 : 0;
  pins_.rx_error = error_;
  error_ = 0;
  if (outside_.exist() && outside_.next_turn() <= clock_) {
    outside_.advance_turns(clock_);
  }
  model_->clock(state_.get(), &pins_);
  ++clock_;
  if (outside_.exist()) {
    outside_.look(clock_);
  }
  for (const Flags& flags : flags_) {
    if (model_->was_written(state_.get(), flags.write) != 0) {
      give(flags.read, given_[flags.read] & ~words_[flags.write]);
    }
  }
  if (on_change_) {
    look();
  }
  if (!rising_.empty()) {
    for (const std::uint32_t group : falling_) {
      model_->set_event(state_.get(), group, 0);
    }
    falling_.clear();
    rising_.clear();
  }
}

void RtlDevice::run_until(Clock clock) {
  if (has_failed()) {
    clock_ = std::max(clock_, clock);
  }
  while (clock_ < clock) {
    step();
  }
}

Clock RtlDevice::most_at_once() const noexcept { return chunk_clocks; }

Clock RtlDevice::most_unseen() const noexcept { return unseen_clocks; }

Clock RtlDevice::next_event() const noexcept {
  return has_failed() ? never : clock_ + std::max<Clock>(1, configuration_.clock_hz / looks_per_second);
}

bool RtlDevice::take(TimedByte& byte) noexcept {
  if (!output_.take(byte, clock_)) {
    return false;
  }
  ++statistics_.bytes_sent;
  return true;
}

BusReply RtlDevice::get(std::uint32_t address) {
  if (const auto place = read_index_.find(address); place != read_index_.end()) {
    // if both the PC and the FPGA write this word, it is the value that the PC reads, as on the twin
    return {BusStatus::ok, given_[place->second]};
  }
  if (const auto place = write_index_.find(address); place != write_index_.end()) {
    return {BusStatus::ok, words_[place->second]};
  }
  return {BusStatus::error, 0};
}

BusStatus RtlDevice::set(std::uint32_t address, std::uint32_t value) {
  const auto place = read_index_.find(address);
  if (place == read_index_.end()) {
    return BusStatus::error;
  }
  give(place->second, value);
  return BusStatus::ok;
}

void RtlDevice::give(std::uint32_t index, std::uint32_t value) {
  given_[index] = value;
  model_->set_word(state_.get(), index, value);
}

bool RtlDevice::has_failed() const noexcept { return *model_->failure(state_.get()) != '\0'; }

std::string RtlDevice::failure() const { return model_->failure(state_.get()); }

}  // namespace unitylink::device
