// SPDX-License-Identifier: BSD-3-Clause
// How a link begins: it resynchronises with the device, and finds out its protocol and its abilities.
#include <algorithm>
#include <array>
#include <cstdio>
#include <tuple>

#include "layer2_message/link.hpp"

namespace unitylink {
namespace {

using namespace protocol;

constexpr std::uint64_t beginning_bytes = 8192;                // the beginning of a link needs fewer bytes than this
constexpr std::size_t described = control::spec_hash_low + 1;  // the description is in the registers from 0 on

std::string hash_text(std::uint64_t hash) {
  char text[24];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

}  // namespace

// Ends within 4 x attempts x timeout, whatever the device answers: one part for the fence, one for HELLO, and two for
// the description of the device. If the protocol is not known, one HELLO comes before the fence: gateware of frames
// alone does not answer a fence, and would cost its timeouts.
Outcome Link::begin() {
  if (MappedMemory* const memory = driver_->memory(); memory != nullptr) {
    begin_mapped(*memory);
    return {};
  }
  const std::uint64_t line_ns = 2 * options_.engine.byte_time_ns * beginning_bytes;
  const std::uint64_t until_ns = now_ns() + 4 * options_.attempts * options_.engine.timeout_ns + line_ns;
  std::optional<Configuration> reported;
  if (options_.gateware == Gateware::corrected) {
    const std::scoped_lock lock(mutex_);
    classic_.expect_corrected_gateware();
  }
  // Frames may contain a '$', so gateware that may hang on it must not get any.
  const bool known_classic = options_.protocol == Protocol::classic || options_.gateware == Gateware::published_2012 ||
                             !options_.engine.checksums;
  bool knows_none = false;  // it answered the classic question behind each HELLO
  if (options_.protocol == Protocol::automatic && !known_classic) {
    Outcome outcome = begin_framed(until_ns, 1);
    knows_none = outcome.status == Status::mismatch && !framed_;
    const bool silent = outcome.status == Status::timeout && !framed_;  // the HELLO or its answer may have been lost
    if (!knows_none && !silent) {
      return outcome;
    }
  }
  if (options_.protocol != Protocol::framed) {
    Exchange exchange;
    exchange.operation = Operation::resynchronise;
    exchange.attempts_max = options_.attempts;
    run(std::span(&exchange, 1), until_ns);
    if (exchange.status != Status::ok) {
      Outcome silent = outcome_of(exchange);
      if (exchange.status == Status::timeout && !known_classic && !knows_none) {
        Outcome outcome = begin_framed(until_ns, options_.attempts);
        return outcome.ok() || framed_ ? outcome : silent;
      }
      return silent;
    }
    const std::scoped_lock lock(mutex_);
    checksums_ = classic_.checksums();
    reported = classic_.reported();
  }
  if (!known_classic && !knows_none) {
    Outcome outcome = begin_framed(until_ns, options_.attempts);
    // this does not prove that it knows no frames
    if (options_.protocol == Protocol::automatic && outcome.status == Status::timeout && !framed_) {
      outcome.text +=
          "; it sometimes answered in the classic protocol, but too seldom to be sure that it knows no other: is the "
          "line disturbed? "
          "Add protocol=classic or protocol=framed to the URL";
    }
    knows_none = options_.protocol == Protocol::automatic && outcome.status == Status::mismatch && !framed_;
    if (!knows_none) {
      return outcome;
    }
  }
  if (knows_none) {
    notice_ =
        "the device answers the classic protocol only: no exactly-once writes, no time stamps, and its spec is not "
        "verified";
  }
  const std::scoped_lock lock(mutex_);
  if (!checksums_ && options_.checked) {
    return {Status::mismatch, "the device has no checksums (it refuses '$'); remove crc=1 from the URL"};
  }
  if (options_.deadman_s > 0) {
    return {Status::mismatch,
            "deadman= needs gateware with the framed protocol, and this device has only the classic one"};
  }
  if (options_.spec_hash) {
    return {Status::mismatch,
            "spec_hash= needs gateware of a certain spec, but classic gateware cannot report its spec; leave it out"};
  }
  Outcome outcome = settle_configuration(options_, reported, configuration_);
  if (outcome.ok()) {
    engine_->configure(configuration_);
  }
  return outcome;
}

// Mapped memory cannot be asked. The URL gives its widths. For the rest, the limits of the protocol are used.
void Link::begin_mapped(MappedMemory& memory) {
  const std::scoped_lock lock(mutex_);
  mapped_ = std::make_unique<MappedEngine>(memory);
  engine_ = mapped_.get();
  configuration_ = {
      .address_bytes = memory.window().address_bytes,
      .data_bytes = 4,
      .read_many = limits::read_many_max,
      .publish_mode = 1,
      .base_hz = memory.window().base_hz,
      .groups = limits::groups_max,
      .group_size = limits::group_size_max,
      .rate_bytes = limits::rate_bytes_max,
      .discovered = false,
  };
  engine_->configure(configuration_);
  gateware_ = Gateware::corrected;
  quieted_ = true;
}

// Tries the framed protocol. framed_ stays set only if the device speaks it, also if something else is wrong.
Outcome Link::begin_framed(std::uint64_t until_ns, std::uint32_t attempts) {
  {
    const std::scoped_lock lock(mutex_);
    framed_ = std::make_unique<FramedEngine>(options_.engine, options_.protocol == Protocol::automatic);
    engine_ = framed_.get();
    engine_->statistics() = classic_.statistics();
  }
  driver_->messages_end_with(static_cast<std::uint8_t>(frame::delimiter));
  Exchange exchange;
  exchange.operation = Operation::resynchronise;
  exchange.attempts_max = attempts;
  run(std::span(&exchange, 1), until_ns);
  Outcome outcome = outcome_of(exchange);
  if (!outcome.ok()) {
    const std::scoped_lock lock(mutex_);
    if (outcome.status == Status::mismatch) {
      outcome.text =
          "the device speaks no version of the framed protocol that this library knows; try protocol=classic";
    }
    if (!engine_->ended()) {
      classic_.statistics() = framed_->statistics();
      engine_ = &classic_;
      framed_.reset();
      driver_->messages_end_with(static_cast<std::uint8_t>(bytes::line_feed));
    }
    return outcome;
  }
  const RequestOptions how{.until_ns = until_ns};
  outcome = describe_device(how);
  if (outcome.ok() && options_.deadman_s > 0) {
    outcome = set_dead_man(options_.deadman_s, how);
    // it tripped earlier: the link opens all the same, so that the program can arm it
    if (outcome.status == Status::denied) {
      return {};
    }
  }
  return outcome;
}

Outcome Link::describe_device(const RequestOptions& how) {
  Greeting told;
  {
    const std::scoped_lock lock(mutex_);
    told = *framed_->greeting();
  }
  std::array<std::uint32_t, described> value{};
  const std::size_t block = std::clamp<std::size_t>((told.reply_max - 4) / 4, 1, described);
  for (std::size_t begin = 0; begin < described; begin += block) {
    const std::size_t count = std::min(block, described - begin);
    if (Outcome outcome = read_control(static_cast<std::uint32_t>(begin), std::span(value).subspan(begin, count), how);
        !outcome.ok()) {
      return outcome;
    }
  }
  if (value[control::magic] != control_value::magic) {
    return {Status::mismatch,
            "the device speaks the framed protocol but does not describe itself as gateware of Unity-Link"};
  }
  const std::array<std::tuple<const char*, std::optional<std::uint32_t>, std::uint32_t>, 2> widths{{
      {"address_bytes", options_.address_bytes, told.address_bytes},
      {"data_bytes", options_.data_bytes, told.data_bytes},
  }};
  for (const auto& [name, given, real] : widths) {
    if (given && *given != real) {
      return {Status::mismatch, std::string("the URL says ") + name + "=" + std::to_string(*given) +
                                    ", the device reports " + std::to_string(real) + "; is this the right device?"};
    }
  }
  description_ = {
      .version = value[control::version],
      .gateware_version = value[control::gateware_version],
      .build = value[control::build],
      .clock_hz = value[control::clock_hz],
      .features = value[control::features],
      .credit = told.credit,
      .request_max = told.request_max,
      .reply_max = told.reply_max,
      .window = told.window,
      .cache = told.cache,
      .exchanges = value[control::exchanges] >> 16,
      .exchange_size = value[control::exchanges] & 0xFFFF,
      .spec_hash = told.spec_hash,
  };
  const bool publishing = (description_.features & control_value::feature_publishing) != 0;
  configuration_ = {
      .address_bytes = told.address_bytes,
      .data_bytes = told.data_bytes,
      .read_many = 0,
      .publish_mode = publishing ? 2u : 0u,
      .base_hz = value[control::base_hz],
      .groups = publishing ? std::min<std::uint32_t>(value[control::groups] >> 16, limits::groups_max) : 0,
      .group_size = publishing ? std::min<std::uint32_t>(value[control::groups] & 0xFFFF, limits::group_size_max) : 0,
      .rate_bytes = 4,
      .discovered = true,
  };
  configuration_.read_many = static_cast<std::uint32_t>(words_read(true));
  if (options_.spec_hash) {
    std::string unverified;
    if (Outcome outcome = check_spec("the one of spec_hash=", std::span(&*options_.spec_hash, 1), unverified);
        !outcome.ok() || !unverified.empty()) {
      return {Status::mismatch, outcome.ok() ? unverified : outcome.text};
    }
  }
  const std::scoped_lock lock(mutex_);
  engine_->configure(configuration_);
  framed_->set_clock_hz(description_.clock_hz);
  return {};
}

Outcome Link::check_spec(std::string_view spec, std::span<const std::uint64_t> hashes, std::string& unverified) const {
  const std::uint64_t told = description_.spec_hash;
  if (told != 0 && std::ranges::find(hashes, told) != hashes.end()) {
    unverified.clear();
    return {};
  }
  if (told == 0) {
    unverified = framed()  ? "this gateware was built without the hash of its spec"
                 : mapped_ ? "mapped memory cannot report its spec; check that the two belong together"
                           : "classic gateware cannot report its spec; check that the two belong together";
    return {};
  }
  const std::string other = "the gateware was built from another spec than " + std::string(spec) +
                            ": its wire hash is " + hash_text(told) + ", and " +
                            (hashes.empty() ? "none" : hash_text(hashes.front())) + " is expected";
  if (options_.any_spec) {
    unverified = other + "; spec_hash=any goes on";
    return {};
  }
  return {
      Status::mismatch,
      other +
          ", so names, addresses, types, units, limits or safe values differ; build the gateware from this spec, use "
          "the "
          "spec that it was built from, or, where you know that they belong together, add spec_hash=any to the URL"};
}

}  // namespace unitylink
