// SPDX-License-Identifier: BSD-3-Clause
// Only a client that receives the answers to HELLO may open a session. Another one, which sends in its name but
// receives nothing, can only guess.
#include <array>
#include <random>
#include <set>

#include "device/framed/session_offer.hpp"
#include "device_bench.hpp"
#include "layer1_stream/frame_encoder.hpp"

using namespace unitylink;
using namespace unitylink::device::test;
using unitylink::device::SessionOffer;

namespace {

constexpr device::Clock second = 50'000'000;

std::string hello() {
  std::array<std::uint8_t, 32> room{};
  const std::size_t size = FrameEncoder(room, protocol::request_kind::hello, FrameKey{}).word(1, 1).word(1, 1).finish();
  return std::string(1, '\0') + std::string(room.begin(), room.begin() + static_cast<std::ptrdiff_t>(size));
}

std::string opening(std::uint16_t nonce, std::uint16_t epoch) {
  std::array<std::uint8_t, 32> room{};
  const std::size_t size =
      FrameEncoder(room, protocol::request_kind::open, FrameKey{}).word(nonce, 2).word(epoch, 2).word(0, 1).finish();
  return std::string(room.begin(), room.begin() + static_cast<std::ptrdiff_t>(size));
}

bool says_open(std::string_view answer) { return answer.find(static_cast<char>(protocol::device_kind::open)) == 0; }

}  // namespace

TEST_CASE("no nonce comes again before all have been, secret or not") {
  for (const std::uint64_t secret : {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{0x9E3779B97F4A7C15}}) {
    SessionOffer offer(0, secret, second);
    std::set<std::uint16_t> seen;
    int follows = 0;
    std::uint16_t before = 0;
    for (int round = 0; round < 65536; ++round) {
      const std::uint16_t nonce = offer.make();
      seen.insert(nonce);
      follows += nonce == static_cast<std::uint16_t>(before + 1) ? 1 : 0;
      before = nonce;
    }
    CHECK(seen.size() == 65536);
    CHECK((secret == 0 ? follows == 65536 : follows < 64));
  }
}

TEST_CASE("an offer is taken once, a late OPEN is no guess, and a wrong one costs time") {
  SessionOffer offer(0, 7, second);
  const std::uint16_t first = offer.make();
  const std::uint16_t last = offer.make();
  CHECK(!offer.take(first, 0));
  CHECK(offer.take(last, 0));
  CHECK(!offer.take(last, 0));
  const std::uint16_t next = offer.make();
  CHECK(!offer.take(static_cast<std::uint16_t>(~next), 100));
  CHECK(!offer.take(next, 100 + second / 100 - 1));
  CHECK(offer.take(next, 100 + second / 100));
}

TEST_CASE("forged datagrams take no session over, whatever they count on") {
  constexpr std::uint16_t stolen = 0x6666;
  constexpr int rounds = 20'000;
  for (const bool guesses : {false, true}) {  // the attacker counts, or guesses
    device::DeviceConfiguration configuration;
    configuration.offer_secret = 0xC0FFEE;
    DeviceBench bench(configuration);
    std::mt19937 random(5);
    int taken = 0;
    for (int round = 1; round <= rounds; ++round) {
      const auto nonce = static_cast<std::uint16_t>(guesses ? random() : static_cast<unsigned>(round));
      static_cast<void>(bench.ask(hello(), 2000));
      taken += says_open(bench.ask(opening(nonce, stolen), 2000)) ? 1 : 0;
    }
    CHECK(taken == 0);
    // A client that receives the answer can open a session, at the latest a second after the last forgery.
    static_cast<void>(bench.wait(second));
    const std::string answer = bench.ask(hello(), 2000);
    FrameDecoder decoder;
    struct {
      std::uint16_t nonce = 0;
      void on_frame(const Frame& frame) {
        nonce = static_cast<std::uint16_t>(frame.payload[1] << 8 | frame.payload[2]);
      }
      void on_discard(Discard, std::uint8_t, std::size_t) {}
    } told;
    decoder.feed(std::span(reinterpret_cast<const std::uint8_t*>(answer.data()), answer.size()), told);
    CHECK(says_open(bench.ask(opening(told.nonce, 0x1234), 2000)));
  }
}
