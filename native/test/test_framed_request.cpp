// SPDX-License-Identifier: BSD-3-Clause
// Words to write as operations of a list. Any mixture of runs and single addresses must be complete, in order, and
// never longer than with one address for each word.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <random>
#include <utility>
#include <vector>

#include "layer1_stream/frame_decoder.hpp"
#include "layer2_message/framed_request.hpp"

using namespace unitylink;
namespace kinds = unitylink::protocol::list_operation;

namespace {

using Words = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

constexpr std::size_t count_max = 255;

struct Payload {
  std::vector<std::uint8_t> bytes;
  void on_frame(const Frame& frame) { bytes.assign(frame.payload.begin(), frame.payload.end()); }
  void on_discard(Discard, std::uint8_t, std::size_t) { FAIL("what was encoded is no frame"); }
};

std::vector<std::uint8_t> told(const Words& words, const Configuration& configuration) {
  std::vector<std::uint32_t> addresses, values;
  for (const auto& [address, value] : words) {
    addresses.push_back(address);
    values.push_back(value);
  }
  std::array<std::uint8_t, frame_bytes_max + 1> room;
  FrameEncoder encoder(room, protocol::request_kind::post_list, {});
  put_post(encoder, addresses, values, configuration);
  Payload payload;
  FrameDecoder decoder;
  decoder.feed(std::span(room).first(encoder.finish()), payload);
  return payload.bytes;
}

// The writes that a device does for this list.
Words made_of(const std::vector<std::uint8_t>& list, const Configuration& configuration) {
  Words words;
  std::size_t at = 0;
  const auto take = [&](std::size_t bytes) {
    REQUIRE(at + bytes <= list.size());
    at += bytes;
    return number_at(list.data() + at - bytes, bytes);
  };
  while (at < list.size()) {
    const std::uint32_t operation = take(1);
    const std::uint32_t count = take(1);
    REQUIRE(count > 0);
    std::uint32_t address = 0;
    for (std::uint32_t index = 0; index < count; ++index) {
      const bool named = index == 0 || operation == kinds::write;
      address = named ? take(configuration.address_bytes) : address + (operation == kinds::write_up ? 1 : 0);
      words.emplace_back(address, take(configuration.data_bytes));
    }
    REQUIRE((operation == kinds::write || operation == kinds::write_up || operation == kinds::write_fifo));
  }
  return words;
}

}  // namespace

TEST_CASE("words to write are told whole and in order, in no more bytes than each by its address") {
  std::mt19937 generator(1);
  const auto random = [&] { return static_cast<std::uint32_t>(generator()); };
  Configuration configuration;
  for (int round = 0; round < 400; ++round) {
    configuration.address_bytes = 1 + random() % 4;
    configuration.data_bytes = 1 + random() % 4;
    Words words;
    const std::uint32_t space = configuration.address_bytes == 1 ? 0xFF : 0xFFFF;
    const std::size_t size = 1 + random() % 450;
    // lengths around the shortest run, and longer than an operation may be
    while (words.size() < size) {
      static constexpr std::size_t lengths[] = {1, 1, 2, 3, 7, 8, 9, 30, 254, 255, 256, 300};
      const std::size_t length = std::min(lengths[random() % std::size(lengths)], size - words.size());
      const std::uint32_t step = random() % 3;
      std::uint32_t address = random() % (space + 1);
      for (std::size_t index = 0; index < length; ++index, address = (address + step) & space) {
        words.emplace_back(address, random() & ((std::uint64_t{1} << 8 * configuration.data_bytes) - 1));
      }
    }
    const std::vector<std::uint8_t> list = told(words, configuration);
    CHECK(made_of(list, configuration) == words);
    const std::size_t named = words.size() * (configuration.address_bytes + configuration.data_bytes);
    CHECK(list.size() <= named + 2 * ((words.size() + count_max - 1) / count_max));
  }
}

TEST_CASE("a run is told by its first address as soon as it has eight") {
  const Configuration configuration{.address_bytes = 1, .data_bytes = 1};
  const auto size = [&](std::size_t scattered, std::size_t run, std::uint32_t step) {
    Words words;
    for (std::size_t index = 0; index < scattered; ++index) {
      words.emplace_back(static_cast<std::uint32_t>(200 - 3 * index), 1);
    }
    for (std::uint32_t index = 0; index < run; ++index) {
      words.emplace_back(5 + index * step, 1);
    }
    return told(words, configuration).size();
  };
  for (const std::uint32_t step : {0u, 1u}) {
    CHECK(size(0, 7, step) == 2 + 7 * 2);
    CHECK(size(0, 8, step) == 2 + 1 + 8);
    CHECK(size(4, 7, step) == 2 + 11 * 2);
    CHECK(size(4, 8, step) == 2 + 4 * 2 + 2 + 1 + 8);
  }
  CHECK(size(0, 20, 2) == 2 + 20 * 2);
}
