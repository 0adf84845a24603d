// SPDX-License-Identifier: BSD-3-Clause
// Subscriptions: each uses one group of the gateware. 2012 gateware needs a certain order of commands. Addresses come
// before a rate, an empty group has no rate, and the rate is 0 while addresses change. No group is filled to its
// advertised size.
#include <algorithm>
#include <chrono>

#include "layer1_stream/classic_encoder.hpp"
#include "layer1_stream/frame_heads.hpp"
#include "layer2_message/failure.hpp"
#include "layer2_message/link_state.hpp"
#include "layer2_message/shapes.hpp"

namespace unitylink {
namespace {

// The bytes of a publish. Framed: head and words of the payload. Classic: "&PUB:", group, count, words, "*hh", line
// feed.
std::uint64_t publish_bytes(std::size_t words, std::uint32_t data_bytes, bool checked, bool framed) noexcept {
  return framed ? frame_bytes(frame_head::publish + words * data_bytes)
                : encoded_bytes(protocol::reply::publish.size(), 2 + words * data_bytes, checked);
}

// A command that configures a group may be sent twice without harm.
constexpr RequestOptions repeatable{.checked = std::nullopt, .repeat = true, .timeout_ns = 0};
constexpr std::size_t ring_words_max = std::size_t{1} << 26;

Outcome cannot(std::string why) { return {Status::mismatch, "subscribe: " + std::move(why)}; }

}  // namespace

std::uint32_t Link::usable_group_size() const noexcept {
  if (framed_) {  // the definition and the publish must also fit into the device's buffers
    const auto words = [](std::uint32_t most, std::size_t head, std::uint32_t each) {
      return most > head ? static_cast<std::uint32_t>((most - head) / each) : 0;
    };
    return std::min({configuration_.group_size,
                     words(description_.request_max, frame_head::group_definition, configuration_.address_bytes),
                     words(description_.reply_max, frame_head::publish, configuration_.data_bytes)});
  }
  if (gateware_ == Gateware::corrected) {
    return configuration_.group_size;
  }
  return configuration_.group_size > 0 ? configuration_.group_size - 1 : 0;
}

Outcome Link::command(Operation operation) {
  Exchange exchange;
  prepare(exchange, repeatable);
  exchange.operation = operation;
  run(std::span(&exchange, 1));
  return outcome_of(exchange);
}

Outcome Link::set_rate(std::uint32_t group, std::uint32_t divisor) {
  if (framed_ || mapped_) {  // there the definition includes the rate; this call only switches the group off
    return define_group(group, {}, divisor, false, nullptr);
  }
  Exchange exchange;
  prepare(exchange, repeatable);
  exchange.operation = Operation::write_group_rate;
  exchange.address = group;
  exchange.value = divisor;
  run(std::span(&exchange, 1));
  return outcome_of(exchange);
}

Outcome Link::define_group(std::uint32_t group, std::span<const std::uint32_t> addresses, std::uint32_t divisor,
                           bool on_event, PublishRing* ring) {
  Exchange exchange;
  prepare(exchange, repeatable);
  exchange.operation = Operation::define_group;
  exchange.address = group;
  exchange.addresses = addresses;
  exchange.value = divisor;
  exchange.on_event = on_event;
  exchange.ring = ring;
  run(std::span(&exchange, 1));
  return outcome_of(exchange);
}

// Writes the mask from the host's copy, because 2012 gateware with 16-bit data reads it back wrongly.
Outcome Link::set_event(std::uint32_t group, bool on) {
  const std::size_t bytes = event_mask_bytes(configuration_.groups);
  auto& byte = event_mask_[bytes - 1 - group / 8];
  const auto bit = static_cast<std::uint8_t>(1u << (group % 8));
  byte = static_cast<std::uint8_t>(on ? byte | bit : byte & ~bit);
  Exchange exchange;
  prepare(exchange, repeatable);
  exchange.operation = Operation::write_event_mask;
  exchange.mask = std::span<const std::uint8_t>(event_mask_).first(bytes);
  run(std::span(&exchange, 1));
  return outcome_of(exchange);
}

// Switches off all publishes of an earlier program, once for each link.
Outcome Link::quiet_device() {
  if (quieted_ || framed_) {  // a new session publishes nothing
    return {};
  }
  if (Outcome outcome = command(Operation::disable_publishing); !outcome.ok()) {
    return outcome;
  }
  for (std::uint32_t group = 0; group < configuration_.groups; ++group) {
    if (Outcome outcome = set_rate(group, 0); !outcome.ok()) {
      return outcome;
    }
  }
  event_mask_.fill(0);
  if (Outcome outcome = set_event(0, false); !outcome.ok() && outcome.status != Status::protocol_error) {
    return outcome;  // gateware without events refuses the command, and needs none
  }
  quieted_ = true;
  return {};
}

Outcome Link::check_ring(std::size_t ring, std::size_t words) {
  if (ring == 0 || ring > ring_words_max / words) {
    return {Status::range, "subscribe: a ring of " + std::to_string(ring) + " publishes; 1 to " +
                               std::to_string(ring_words_max / words) + " of this size can be kept"};
  }
  return {};
}

Outcome Link::check_subscription(const SubscriptionRequest& request) {
  if (mapped_ && request.on_event) {
    return cannot("mapped memory has no events: publish at a rate, which is polled");
  }
  if (configuration_.publish_mode == 0 || configuration_.groups == 0) {
    return cannot("this gateware does not publish; poll with read_many instead");
  }
  if (request.addresses.empty()) {
    return {Status::range, "subscribe: no addresses"};
  }
  if (request.addresses.size() > usable_group_size()) {
    return cannot(std::to_string(request.addresses.size()) + " addresses, but a group of this gateware can hold " +
                  std::to_string(usable_group_size()) +
                  (usable_group_size() == configuration_.group_size ? ""
                   : framed_ ? " (of " + std::to_string(configuration_.group_size) +
                                   ": its frames hold no more; make it several groups)"
                             : " (one less than it reports: a full group never stops publishing; "
                               "gateware=corrected in the URL if it is corrected)"));
  }
  if (request.divisor == 0 && !request.on_event) {
    return {Status::range, "subscribe: with divisor 0 and no event nothing would ever be published"};
  }
  const std::uint64_t divisor_max = (std::uint64_t{1} << (8 * configuration_.rate_bytes)) - 1;
  if (request.divisor > divisor_max) {
    return {Status::range, "subscribe: divisor " + std::to_string(request.divisor) + " is above " +
                               std::to_string(divisor_max) + ", the most this gateware can count (base " +
                               std::to_string(configuration_.base_hz) + " Hz)"};
  }
  if (Outcome outcome = check_ring(request.ring, request.addresses.size()); !outcome.ok()) {
    return outcome;
  }
  for (std::size_t index = 0; index < request.addresses.size(); ++index) {
    if (Outcome outcome = check_address(request.addresses[index], index); !outcome.ok()) {
      return outcome;
    }
  }
  if (options_.engine.byte_time_ns > 0 && request.divisor > 0) {
    const bool checked = options_.publish_checked;
    double load =
        static_cast<double>(publish_bytes(request.addresses.size(), configuration_.data_bytes, checked, framed())) /
        request.divisor;
    const std::scoped_lock lock(mutex_);
    for (const auto& other : subscriptions_) {
      if (other && other->open && other->divisor > 0) {
        load +=
            static_cast<double>(publish_bytes(other->addresses.size(), configuration_.data_bytes, checked, framed())) /
            other->divisor;
      }
    }
    const double needed = load * static_cast<double>(configuration_.base_hz);
    const double line = 1e9 / static_cast<double>(options_.engine.byte_time_ns);
    if (needed > line) {
      return cannot("publishes would need " + std::to_string(static_cast<std::uint64_t>(needed)) +
                    " bytes/s, the line carries " + std::to_string(static_cast<std::uint64_t>(line)) +
                    ", and requests would never be answered again; use a larger divisor or a higher baud rate");
    }
  }
  return {};
}

Outcome Link::configure_group(std::uint32_t group, Subscription& subscription) {
  if (framed_ || mapped_) {
    return define_group(group, subscription.addresses, subscription.divisor, subscription.on_event, &subscription.ring);
  }
  if (Outcome outcome = set_rate(group, 0); !outcome.ok()) {
    return outcome;
  }
  Exchange addresses;
  prepare(addresses, repeatable);
  addresses.operation = Operation::write_group_addresses;
  addresses.address = group;
  addresses.addresses = subscription.addresses;
  addresses.ring = &subscription.ring;
  run(std::span(&addresses, 1));
  if (Outcome outcome = outcome_of(addresses); !outcome.ok()) {
    return outcome;
  }
  if (subscription.divisor > 0) {
    if (Outcome outcome = set_rate(group, subscription.divisor); !outcome.ok()) {
      return outcome;
    }
  }
  return subscription.on_event ? set_event(group, true) : Outcome{};
}

Outcome Link::verify(std::span<const std::uint32_t> addresses) {
  std::vector<std::uint32_t> values(addresses.size());
  Outcome outcome = read_each(addresses, values, repeatable);
  if (!outcome.ok()) {
    outcome.text = "subscribe: every address is read once before it is published, and " + outcome.text;
  }
  return outcome;
}

Outcome Link::subscribe(const SubscriptionRequest& request, std::uint32_t& id) {
  const std::scoped_lock one_at_a_time(configuring_);
  if (Outcome outcome = check_subscription(request); !outcome.ok()) {
    return outcome;
  }
  if (request.verify) {
    if (Outcome outcome = verify(request.addresses); !outcome.ok()) {
      return outcome;
    }
  }
  if (Outcome outcome = quiet_device(); !outcome.ok()) {
    return outcome;
  }
  if (request.group && *request.group >= configuration_.groups) {
    return cannot("group " + std::to_string(*request.group) + " is asked for, and this gateware has " +
                  std::to_string(configuration_.groups) + ", numbered from 0");
  }
  std::uint32_t free = configuration_.groups;
  bool first = true;
  const auto subscription = std::make_shared<Subscription>(request);
  {
    const std::scoped_lock lock(mutex_);
    for (std::uint32_t index = configuration_.groups; index-- > 0;) {
      const bool taken = subscriptions_[index] && subscriptions_[index]->open;
      first = first && !taken;
      free = taken || index != request.group.value_or(index) ? free : index;
    }
    if (free == configuration_.groups && request.group) {
      return cannot("group " + std::to_string(*request.group) + " is in use; close its subscription first");
    }
    if (free == configuration_.groups) {
      return cannot("all " + std::to_string(configuration_.groups) +
                    " groups of this gateware are in use; close a subscription first");
    }
    if (!takes_requests()) {
      return {Status::down, "subscribe: the line is gone (" + lost_because_ + ") and is being opened again"};
    }
    engine_->claim(free, nullptr);
    if (!framed_ || !framed_->restoring()) {
      released_subscriptions_.clear();
    }
    released_subscriptions_.push_back(subscriptions_[free]);
    subscription->id = subscriptions_[free] ? subscriptions_[free]->id + protocol::limits::groups_max : free;
    subscriptions_[free] = subscription;
    subscription->open = true;
  }
  const bool checked = options_.publish_checked && checksums_;
  Outcome outcome = configure_group(free, *subscription);
  if (outcome.ok() && first) {
    {
      const std::scoped_lock lock(mutex_);
      classic_.expect_checked_publishes(checked);
    }
    outcome = framed_   ? write_control(protocol::control::publish, 1, repeatable)
              : checked ? command(Operation::enable_checked_publishing)
                        : command(Operation::enable_publishing);
  }
  if (!outcome.ok()) {
    static_cast<void>(set_rate(free, 0));
    const std::scoped_lock lock(mutex_);
    engine_->claim(free, nullptr);
    subscription->open = false;
    return outcome;
  }
  id = subscription->id;
  start_reader();
  return {};
}

// Stops the device first, and waits for its answer. Then all publishes that it sent before have arrived, and can be
// drained.
Outcome Link::stop_group(const Subscription& subscription, bool last) {
  const std::uint32_t group = group_of(subscription.id);
  Outcome outcome;
  if (last) {
    outcome =
        framed_ ? write_control(protocol::control::publish, 0, repeatable) : command(Operation::disable_publishing);
  } else if (framed_) {  // asked first, because publishes that arrive after the new definition are unclaimed
    std::uint32_t state = 0;
    outcome = read_control(protocol::control::publish, std::span(&state, 1), repeatable);
  }
  Outcome rate = framed_ || subscription.divisor > 0 ? set_rate(group, 0) : Outcome{};
  Outcome event = !framed_ && subscription.on_event ? set_event(group, false) : Outcome{};
  return !outcome.ok() ? outcome : !rate.ok() ? rate : event;
}

Outcome Link::unsubscribe(std::uint32_t id) {
  const std::uint32_t group = group_of(id);
  const std::scoped_lock one_at_a_time(configuring_);
  std::shared_ptr<Subscription> subscription;
  bool last = true;
  {
    const std::scoped_lock lock(mutex_);
    subscription = subscriptions_[group];
    if (!subscription || subscription->id != id || !subscription->open) {
      return {};
    }
    for (const auto& other : subscriptions_) {
      last = last && !(other && other != subscription && other->open);
    }
  }
  bool unheard = false;
  Outcome outcome = closed() ? Outcome{} : stop_group(*subscription, last);
  if (outcome.status == Status::down || outcome.status == Status::unknown) {  // the group will not be set up again
    outcome = {};
    unheard = true;
  }
  bool last_user = false;
  {
    const std::scoped_lock lock(mutex_);
    subscription->closed_unheard = unheard;
    subscription->open = false;
    engine_->claim(group, nullptr);
    subscriptions_ended_ += 1;
    last_user = last && !reader_kept_;
    announce();
  }
  if (last_user) {
    stop_reader();
  }
  return outcome;
}

// ---- publishes that have arrived

// nullptr for an id whose group was given to a later subscription.
Link::Subscription* Link::find(std::uint32_t id) const noexcept {
  Subscription* const subscription = subscriptions_[group_of(id)].get();
  return subscription != nullptr && subscription->id == id ? subscription : nullptr;
}

bool Link::subscribed(std::uint32_t id) {
  const std::scoped_lock lock(mutex_);
  const Subscription* subscription = find(id);
  return subscription != nullptr && subscription->heard();
}

std::size_t Link::words(std::uint32_t id) {
  const std::scoped_lock lock(mutex_);
  const Subscription* subscription = find(id);
  return subscription != nullptr ? subscription->ring.words() : 0;
}

std::size_t Link::available(std::uint32_t id) {
  const std::scoped_lock lock(mutex_);
  const Subscription* subscription = find(id);
  return subscription != nullptr ? subscription->ring.size() : 0;
}

std::uint64_t Link::lost(std::uint32_t id) {
  const std::scoped_lock lock(mutex_);
  const Subscription* subscription = find(id);
  return subscription != nullptr ? subscription->ring.lost() : 0;
}

std::uint64_t Link::missing(std::uint32_t id) {
  const std::scoped_lock lock(mutex_);
  const Subscription* subscription = find(id);
  return subscription != nullptr ? subscription->ring.missing() : 0;
}

std::size_t Link::drain(std::uint32_t id, std::span<double> times_s, std::span<std::uint32_t> values) {
  const std::scoped_lock lock(mutex_);
  Subscription* const subscription = find(id);
  if (subscription == nullptr) {
    return 0;
  }
  PublishRing& ring = subscription->ring;
  return ring.drain(times_s.first(std::min(times_s.size(), values.size() / ring.words())), values);
}

void Link::drain(std::uint32_t id, Drained& to) {
  const std::scoped_lock lock(mutex_);
  Subscription* const subscription = find(id);
  if (subscription == nullptr) {
    to.count = 0;
    return;
  }
  PublishRing& ring = subscription->ring;
  if (to.times_s.size() < ring.size() || to.values.size() < ring.size() * ring.words()) {
    to.times_s.resize(ring.size());
    to.values.resize(ring.size() * ring.words());
  }
  to.words = ring.words();
  to.before = ring.missing() + ring.lost();
  to.count = ring.drain(to.times_s, to.values);
}

void Link::notify_publishes(int descriptor) {
  const std::scoped_lock lock(mutex_);
  notified_.push_back(descriptor);
}

void Link::forget_notification(int descriptor) {
  const std::scoped_lock lock(mutex_);
  notified_.erase(std::remove(notified_.begin(), notified_.end(), descriptor), notified_.end());
}

}  // namespace unitylink
