// SPDX-License-Identifier: BSD-3-Clause
#include "faults/client.hpp"

#include <algorithm>
#include <cstdio>

#include "layer2_message/framed_engine.hpp"

namespace unitylink::faults {
namespace {

constexpr std::uint32_t words_apart = 16;  // each client has so many words of its own
constexpr std::size_t posts_most = 20;
constexpr std::size_t post_words_most = 4;  // words in one post

Journal::Told told_of(Status status) noexcept {
  switch (status) {
    case Status::ok: return Journal::Told::executed;
    case Status::unknown: return Journal::Told::unknown;
    default: return Journal::Told::not_executed;
  }
}

}  // namespace

Client::Client(std::uint32_t number, Engine& engine, FramedEngine* framed, Random& random, Tally& tally,
               std::uint64_t timeout_ns, std::uint32_t attempts)
    : engine_(engine),
      framed_(framed),
      random_(random),
      tally_(tally),
      timeout_ns_(timeout_ns),
      attempts_(attempts),
      journal_(words_apart * (number + 1), words) {}

bool Client::step(std::uint64_t now_ns) {
  if (!begun_) {
    begin(now_ns);
    return begun_;
  }
  if (!std::all_of(exchanges_.begin(), exchanges_.begin() + static_cast<std::ptrdiff_t>(used_),
                   [](const Exchange& e) { return e.done(); })) {
    return false;
  }
  judge();
  begun_ = false;
  return true;
}

Exchange& Client::add(Operation operation) {
  Exchange& exchange = exchanges_[used_++];
  exchange = Exchange{};
  exchange.operation = operation;
  exchange.checked = true;
  exchange.repeat = operation != Operation::write;
  exchange.timeout_ns = timeout_ns_;
  exchange.attempts_max = attempts_;
  exchange.owner = &tally_;
  exchange.on_done = [](Exchange& done) noexcept {
    const bool answered =
        done.status == Status::ok || done.status == Status::protocol_error || done.status == Status::denied;
    Tally& tally = *static_cast<Tally*>(done.owner);
    tally.answered_ns = answered ? done.ended_ns : tally.answered_ns;
  };
  return exchange;
}

void Client::add_write(bool chained) {
  Exchange& exchange = add(Operation::write);
  exchange.address = any_address();
  exchange.value = next_value();
  exchange.chained = chained;
  exchange.batch = &batch_;
  journal_.wish(exchange.address, exchange.value);
}

void Client::post(std::uint64_t now_ns) {
  posts_ = 1 + random_() % posts_most;
  session_ = framed_->sessions();
  for (std::size_t index = 0; index < posts_;) {
    std::array<Post, post_words_most> made;
    const std::size_t drawn = 1 + random_() % post_words_most;
    const std::span<Post> list = std::span(made).first(std::min(tally_.lists ? drawn : 1, posts_ - index));
    for (Post& word : list) {
      word = {any_address(), next_value()};
    }
    if (!framed_->post(list, now_ns)) {
      posts_ = index;
      return;
    }
    for (const Post& word : list) {
      journal_.wish(word.address, word.value);
    }
    index += list.size();
  }
}

void Client::begin(std::uint64_t now_ns) {
  begun_ns_ = now_ns;
  const std::uint64_t draw = random_() % 10;
  kind_ = draw < 3   ? Kind::read
          : draw < 6 ? Kind::write
          : draw < 7 ? Kind::read_many
          : draw < 8 ? Kind::chain
          : draw < 9 ? (framed_ != nullptr ? Kind::transfer : Kind::read_many)
                     : (framed_ != nullptr ? Kind::posts : Kind::write);
  if (framed_ != nullptr && !tally_.lists) {
    kind_ = kind_ == Kind::read_many ? Kind::read : kind_ == Kind::transfer ? Kind::chain : kind_;
  }
  used_ = posts_ = 0;
  batch_ = {};
  journal_.begin();
  const std::size_t count = 1 + random_() % words;
  for (std::size_t index = 0; index < count; ++index) {
    read_addresses_[index] = any_address();
  }
  switch (kind_) {
    case Kind::read: add(Operation::read).address = any_address(); break;
    case Kind::write: add_write(false); break;
    case Kind::read_many: {
      Exchange& exchange = add(Operation::read_many);
      exchange.addresses = std::span(read_addresses_).first(count);
      exchange.values = std::span(read_values_).first(count);
      break;
    }
    case Kind::transfer: {
      Exchange& exchange = add(Operation::transfer);
      const std::size_t writes = 1 + random_() % words;
      for (std::size_t index = 0; index < writes; ++index) {
        write_addresses_[index] = any_address();
        write_values_[index] = next_value();
        journal_.wish(write_addresses_[index], write_values_[index]);
      }
      exchange.repeat = false;
      exchange.write_addresses = std::span(write_addresses_).first(writes);
      exchange.write_values = std::span(write_values_).first(writes);
      exchange.addresses = std::span(read_addresses_).first(count);
      exchange.values = std::span(read_values_).first(count);
      break;
    }
    case Kind::chain:
      for (std::size_t index = 0; index < count; ++index) {
        add_write(index > 0);
      }
      break;
    case Kind::posts:
      post(now_ns);
      if (random_() % 2 == 0) {
        add(Operation::synchronise);
      } else {
        add_write(false);  // this write must not overtake the posts
      }
      break;
  }
  tally_.messages += used_ + posts_;
  for (std::size_t index = 0; index < used_; ++index) {
    engine_.submit(exchanges_[index], now_ns);
  }
  begun_ = true;
}

void Client::judge() {
  const Status last = exchanges_[used_ - 1].status;
  for (std::size_t index = 0; index < used_; ++index) {
    const Status status = exchanges_[index].status;
    (status == Status::ok ? tally_.good : status == Status::unknown ? tally_.unknown : tally_.failed) += 1;
    const bool late = status == Status::timeout || status == Status::unknown || status == Status::cancelled;
    if (framed_ != nullptr && status != Status::ok && !late && !tally_.lied_to) {  // the engine could have repeated it
      journal_.accuse(std::string("an operation ended with: ") + status_text(status));
    }
    if (tally_.lied_to && status != Status::ok && begun_ns_ >= tally_.trusted_ns) {
      journal_.accuse(std::string("an operation that began after the device's last false answer ended with: ") +
                      status_text(status));
    }
  }
  // The request after posts is answered only when they were executed. Otherwise, and in another session, the result is
  // unknown.
  const bool confirmed = last == Status::ok && posts_ > 0 && framed_->sessions() == session_;
  for (std::size_t index = 0; index < posts_; ++index) {
    journal_.settle(confirmed ? Journal::Told::executed : Journal::Told::unknown);
  }
  (confirmed ? tally_.good : tally_.unknown) += posts_;
  const Exchange& first = exchanges_[0];
  switch (kind_) {
    case Kind::read:
      if (first.status == Status::ok) {
        read_values_[0] = first.value;
        judge_reads(first, &first.address, 1);
      }
      break;
    case Kind::transfer:
    case Kind::read_many:
      while (journal_.wishes() > 0) {
        journal_.settle(told_of(first.status), status_text(first.status));
      }
      if (first.status == Status::ok) {
        judge_reads(first, first.addresses.data(), first.addresses.size());
      }
      break;
    default:
      for (std::size_t index = 0; journal_.wishes() > 0; ++index) {
        journal_.settle(told_of(exchanges_[index].status), status_text(exchanges_[index].status));
      }
      break;
  }
}

// No other client writes these words, so the values read must be right.
void Client::judge_reads(const Exchange& exchange, const std::uint32_t* addresses, std::size_t count) {
  for (std::size_t index = 0; index < count && !journal_.disturbed(); ++index) {
    const std::uint32_t truth = journal_.truth(addresses[index]);
    if (read_values_[index] != truth) {
      char text[160];
      std::snprintf(text, sizeof text, "read %08x at %04x, where %08x stands (attempt %u)", read_values_[index],
                    addresses[index], truth, exchange.attempts);
      journal_.accuse(text, true);
    }
  }
}

}  // namespace unitylink::faults
