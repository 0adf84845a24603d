// SPDX-License-Identifier: BSD-3-Clause
// A hostile client at a server: its login, and its frames.  fuzz_server --seconds N --seed S
// It checks these promises. Nothing reaches the board that the client may not do. A request that changes something is
// alone at the board. No id is executed twice. All that is sent to the client is whole frames. Memory is limited.
#include <algorithm>
#include <array>
#include <deque>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "fuzzing.hpp"
#include "layer0_driver/login.hpp"
#include "server/session.hpp"

using namespace unitylink;
using namespace unitylink::server;
namespace kinds = unitylink::protocol::request_kind;

namespace {

constexpr const char* program = "fuzz_server";
constexpr std::uint32_t readable_to = 0x3F, writable_from = 0x20, leased_from = 0x30, writable_to = 0x3F;
constexpr std::size_t output_most = 1u << 20;

class Fuzz final : public Host {
 public:
  explicit Fuzz(std::uint64_t seed) : random_(seed), seed_(seed) {
    facts_.configuration = {.address_bytes = 2, .data_bytes = 4, .base_hz = 1000, .groups = 4, .group_size = 8};
    facts_.description.features = 0x3F & ~protocol::control_value::feature_long_frames;
    facts_.description.request_max = facts_.description.reply_max = 250;
    facts_.description.window = 64;
    facts_.description.cache = 16;
  }

  void round() {
    try_login();
    session_ = std::make_unique<Session>(*this, grant(leased_from), std::uint16_t{7}, strings);
    key_ = {};
    decoder_ = {};
    id_ = post_ = 0;
    under_way_.clear();
    executed_.clear();
    errands_.clear();
    std::vector<std::uint8_t> hello, open;
    frame(hello, kinds::hello, {1, 1});
    give(hello);
    frame(open, kinds::open,
          {static_cast<std::uint8_t>(nonce_ >> 8), static_cast<std::uint8_t>(nonce_), 0x12, 0x34, 0});
    give(open);
    for (int step = 0; step < 200 && !session_->lost(); ++step) {
      hostile();
      if (chance(2)) {
        answer();
      }
      if (chance(4)) {
        session_->publish(pick(4), pick(3), pick(1u << 31), std::array<std::uint8_t, 8>{});
      }
      if (asked_ != Session::Ask::nothing && chance(3)) {
        session_->resume(std::exchange(asked_, Session::Ask::nothing),
                         chance(2) ? protocol::reply_status::ok : protocol::serve::lease_held);
      }
      take_output(!chance(3));
    }
    session_.reset();
  }

  std::uint64_t strings = 0, bytes = 0, understood = 0;

  // Called by the decoder.
  void on_frame(const Frame& told) {
    understood += 1;
    const std::span<const std::uint8_t> payload = told.payload;
    if (told.kind == protocol::device_kind::hello) {
      nonce_ = static_cast<std::uint16_t>(payload[1] << 8 | payload[2]);
    } else if (told.kind == protocol::device_kind::open) {
      key_.epoch = static_cast<std::uint16_t>(payload[0] << 8 | payload[1]);
      decoder_.set_key(key_);
      executed_.clear();
      id_ = post_ = 0;
    }
  }
  void on_discard(Discard, std::uint8_t, std::size_t) { fail("the client got what is no frame"); }

  // Host
  [[nodiscard]] const Facts& facts() const noexcept override { return facts_; }
  [[nodiscard]] Errand& errand() override {
    errands_.push_back(std::make_unique<Errand>());
    return *errands_.back();
  }
  void discard(Errand&) override { errands_.pop_back(); }
  void submit(Errand& errand) override {
    device::FrameRequest request;
    std::vector<std::uint8_t> payload{0, 0};
    payload.insert(payload.end(), errand.body.begin(), errand.body.end());
    if (!request.parse(errand.exchange.kind, payload, {2, 4})) {
      fail("the board gets a request of a wrong form");
    }
    bool writes = request.operation == kinds::write;
    check(request.operation == kinds::read || writes, request.address, writes);
    for (const device::ListWord& word : request.words) {
      check(true, word.address, word.writes());
      writes = writes || word.writes();
    }
    if (writes && !errand.exchange.changes) {
      fail("a write that is not known as one");
    }
    if (errand.exchange.changes ? !under_way_.empty() : under_way_.size() == 1 && under_way_[0]->exchange.changes) {
      fail("a request that changes something is not alone");
    }
    if (errand.posts.empty() && !executed_.insert(errand.id).second) {
      fail("an id is executed twice");
    }
    under_way_.push_back(&errand);
  }
  void abandon(const Session&) override { under_way_.clear(); }
  [[nodiscard]] std::uint32_t define_group(Session&, std::uint32_t, std::span<const std::uint32_t> addresses,
                                           std::uint32_t, bool) override {
    for (const std::uint32_t address : addresses) {
      check(true, address, false);
    }
    return chance(5) ? protocol::reply_status::no_group : protocol::reply_status::ok;
  }
  [[nodiscard]] std::uint32_t set_dead_man() override { return protocol::reply_status::ok; }
  void ask_for_lease(Session&, std::uint32_t address) override {
    if (address < writable_from || address >= leased_from) {
      fail("a lease is asked for that is there, or cannot be had");
    }
    asked_ = Session::Ask::lease;
  }
  void ask_to_arm(Session&, std::uint32_t age_us) override {
    if (age_us > INT32_MAX) {
      fail("an arm was asked for later than now");
    }
    asked_ = Session::Ask::arm;
  }
  [[nodiscard]] std::uint32_t clock_us() const noexcept override { return static_cast<std::uint32_t>(strings << 28); }
  void trip() noexcept override {}
  [[nodiscard]] std::uint64_t trips() const noexcept override { return 0; }
  void notice_trip() noexcept override {}

 private:
  [[noreturn]] void fail(const char* what) { fuzzing::fail(program, what, seed_, strings, last_); }
  bool chance(std::uint32_t of) { return pick(of) == 0; }
  std::uint32_t pick(std::uint32_t below) { return static_cast<std::uint32_t>(random_() % below); }

  static Grant grant(std::uint32_t from) {
    return {.reads = Addresses({{0, readable_to}}),
            .writes = Addresses({{writable_from, writable_to}}),
            .leased = Addresses({{from, writable_to}}),
            .arm = true};
  }
  void check(bool is_access, std::uint32_t address, bool writes) {
    if (is_access && (writes ? address < leased_from || address > writable_to : address > readable_to)) {
      fail("the board gets what the client may not do");
    }
  }

  // Random lines, and damaged ones, must be refused or mean what they say.
  void try_login() {
    std::string line = Login{.version = pick(3), .board = chance(2) ? "arm" : "", .token = chance(2) ? "x" : ""}.line();
    line.pop_back();
    for (std::uint32_t damage = pick(3); damage > 0; --damage) {
      line[pick(static_cast<std::uint32_t>(line.size()))] = static_cast<char>(pick(256));
    }
    strings += 1;
    bytes += line.size();
    last_.assign(line.begin(), line.end());
    if (const auto login = Login::parse(line)) {
      const bool words =
          (login->board.empty() || is_word(login->board)) && (login->token.empty() || is_word(login->token));
      if (!words ||
          Login::parse(std::string_view(login->line()).substr(0, login->line().size() - 1))->token != login->token) {
        fail("a login is not what its line says");
      }
    }
    static_cast<void>(LoginAnswer::parse(line));
  }

  void frame(std::vector<std::uint8_t>& into, std::uint8_t kind, const std::vector<std::uint8_t>& payload) {
    std::array<std::uint8_t, 600> room;
    FrameEncoder encoder(room, kind, key_);
    const std::size_t size = encoder.bytes(payload).finish();
    into.insert(into.end(), room.begin(), room.begin() + static_cast<std::ptrdiff_t>(size));
  }

  // Frames of all kinds with random contents, some of them damaged.
  void hostile() {
    std::vector<std::uint8_t> text;
    for (std::uint32_t count = 1 + pick(6); count > 0; --count) {
      std::vector<std::uint8_t> payload;
      const std::uint8_t kind = static_cast<std::uint8_t>(kinds::read + pick(12));
      const bool post = kind == kinds::post || kind == kinds::post_list;
      const std::uint16_t number = static_cast<std::uint16_t>(post        ? (chance(4) ? pick(0x10000) : post_++)
                                                              : chance(6) ? id_ - pick(70)
                                                                          : id_++);
      append(payload, number, 2);
      switch (kind) {
        case kinds::read: append(payload, pick(0x48), 2); break;
        case kinds::post:
        case kinds::write:
          append(payload, 0x1C + pick(0x28), 2);
          append(payload, pick(1u << 31), 4);
          break;
        case kinds::write_control:
          append(payload, chance(2) ? protocol::serve::dated_arm : pick(0x50), 2);
          append(payload, chance(2) ? 1 : static_cast<std::uint32_t>(random_()), 4);
          break;
        case kinds::list: append(payload, pick(2), 1); [[fallthrough]];
        case kinds::post_list:
          for (std::uint32_t operations = 1 + pick(3); operations > 0; --operations) {
            append(payload, post || chance(2) ? 0x11 : 0x01, 1);
            append(payload, 1, 1);
            append(payload, 0x1C + pick(0x28), 2);
            if (payload[payload.size() - 4] == 0x11) {
              append(payload, pick(1u << 31), 4);
            }
          }
          break;
        default:
          for (std::uint32_t more = pick(24); more > 0; --more) {
            append(payload, chance(2) ? pick(4) : pick(256), 1);
          }
      }
      const std::size_t before = text.size();
      frame(text, static_cast<std::uint8_t>(kind | (post ? 0 : (chance(5) ? 0x10 : 0) | (chance(9) ? 0x20 : 0))),
            payload);
      if (chance(12)) {
        text[before + pick(static_cast<std::uint32_t>(text.size() - before))] ^=
            static_cast<std::uint8_t>(1 + pick(255));
      }
    }
    give(text);
  }

  static void append(std::vector<std::uint8_t>& into, std::uint32_t value, std::size_t count) {
    for (std::size_t left = count; left > 0; --left) {
      into.push_back(static_cast<std::uint8_t>(value >> (8 * (left - 1))));
    }
  }

  void give(const std::vector<std::uint8_t>& text) {
    strings += 1;
    bytes += text.size();
    last_ = text;
    for (std::span<const std::uint8_t> left(text); !left.empty();) {
      const std::size_t piece = std::min<std::size_t>(left.size(), 1 + pick(64));
      session_->take(left.first(piece), strings);
      left = left.subspan(piece);
    }
    if (session_->output().size() > output_most) {
      fail("a client that does not read fills the memory");
    }
    take_output(true);
  }

  // The board answers the oldest request: well, badly, or not at all.
  void answer() {
    if (under_way_.empty()) {
      return;
    }
    Errand& errand = *under_way_.front();
    under_way_.pop_front();
    errand.exchange.status = Status::ok;
    errand.exchange.reply_status = 0;
    if (chance(8)) {
      errand.exchange.status = Status::bus_error;
      errand.exchange.reply_status = protocol::reply_status::bus_error;
      errand.exchange.words = pick(3);
    } else if (chance(400)) {
      errand.exchange.status = Status::unknown;
      errand.exchange.reply_status = Exchange::no_reply;
    }
    session_->finish(errand);
  }

  void take_output(bool all) {
    const auto ready = session_->output();
    const std::size_t count = all ? ready.size() : ready.size() / 2;
    decoder_.feed(ready.first(count), *this);
    session_->sent(count);
  }

  std::mt19937_64 random_;
  std::uint64_t seed_;
  Facts facts_;
  std::unique_ptr<Session> session_;
  std::deque<std::unique_ptr<Errand>> errands_;
  std::deque<Errand*> under_way_;
  std::set<std::uint16_t> executed_;
  std::vector<std::uint8_t> last_;
  FrameKey key_;
  FrameDecoder decoder_;
  std::uint16_t nonce_ = 0, id_ = 0, post_ = 0;
  Session::Ask asked_ = Session::Ask::nothing;
};

}  // namespace

int main(int count, char** arguments) { return fuzzing::run<Fuzz>(program, "answers", count, arguments); }
