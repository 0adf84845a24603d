// SPDX-License-Identifier: BSD-3-Clause
// Layer 1 of the classic protocol: which bytes are sent, and which are accepted. Chunks must not matter.
#include <doctest/doctest.h>

#include <array>
#include <random>
#include <vector>

#include "decoder_trace.hpp"
#include "layer1_stream/classic_encoder.hpp"
#include "layer1_stream/configuration.hpp"

using namespace unitylink;
using test::bytes_of;
using test::Trace;

namespace {

std::string encoded(bool checked, std::string_view command, std::vector<std::uint8_t> data, const Crc8& sum = Crc8{}) {
  std::array<std::uint8_t, 64> room{};
  ClassicEncoder encoder(room, sum, checked);
  encoder.command(command);
  for (const std::uint8_t byte : data) {
    encoder.byte(byte);
  }
  const std::size_t size = encoder.finish();
  CHECK(size == encoded_bytes(command.size(), data.size(), checked));
  return {reinterpret_cast<const char*>(room.data()), size};
}

std::string decoded(std::string_view text, std::uint32_t data_bytes = 4, const Crc8& sum = Crc8{}) {
  ClassicDecoder decoder(sum);
  decoder.set_data_bytes(data_bytes);
  Trace trace;
  decoder.feed(bytes_of(text), trace);
  return trace.text;
}

}  // namespace

TEST_CASE("the checksum is CRC-8/SMBUS, and the XOR variant is XOR") {
  CHECK(Crc8{}.of(bytes_of("123456789")) == protocol::crc8::check);
  const std::array<std::uint8_t, 3> data{0x52, 0x12, 0x00};
  CHECK(Crc8::exclusive_or().of(data) == 0x40);
}

TEST_CASE("requests as the gateware expects them") {
  CHECK(encoded(false, "R", {0x12}) == "#R:12\n");
  CHECK(encoded(true, "R", {0x12}) == "$R:12*58\n");
  CHECK(encoded(true, "RM", {2, 0x10, 0x11}) == "$RM:021011*AD\n");
  CHECK(encoded(true, "W", {0x20, 0xDE, 0xAD, 0xBE, 0xEF}) == "$W:20DEADBEEF*99\n");
  CHECK(encoded(true, "RLC", {}) == "$RLC*9B\n");
  CHECK(encoded(true, "EPC", {}) == "$EPC*84\n");
  CHECK(encoded(true, "R", {0x12}, Crc8::exclusive_or()) == "$R:12*40\n");
  std::array<std::uint8_t, 4> small{};
  CHECK(ClassicEncoder(small, Crc8{}, true).command("R").word(0x12, 1).finish() == 0);
}

TEST_CASE("replies, errors and publishes") {
  CHECK(decoded("#S_R:40de1212\n") == "reply # S_R 40de1212  0\n");
  CHECK(decoded("$S_R:40de1212*2d\n") == "reply $ S_R 40de1212  0\n");
  CHECK(decoded("$S_W*f4\n") == "reply $ S_W   0\n");
  CHECK(decoded("#S_RM:40de111140de1212?E_MAB\n") == "error # S_RM 40de111140de1212 E_MAB 0\n");
  CHECK(decoded("$?E_ICC\n") == "error $   E_ICC 0\n");
  CHECK(decoded("?f3\n") ==
        "datalink -   "
        " 243\n");
  CHECK(decoded("?busy\n") ==
        "busy -   "
        " 0\n");
  CHECK(decoded("&PUB:000240de101040de1111*ba\n") == "publish 0 2 checked 1088294928 1088295185\n");
  CHECK(decoded("%PUB:000240de101040de1111\n") == "publish 0 2 plain 1088294928 1088295185\n");
  CHECK(decoded("%PUB:0002aabbccdd\n", 2) == "publish 0 2 plain 43707 52445\n");
  CHECK(decoded("$S_R:40de1212*c0\n", 4, Crc8::exclusive_or()) == "reply $ S_R 40de1212  0\n");
}

TEST_CASE("no value comes from a message of wrong form or checksum") {
  for (const char* line :
       {"$S_R:40de1212*2e\n", "$S_R:40de1212\n", "$S_R:40de1212*2\n", "$S_R:40de1212*2d0\n", "#S_R:40de1212*2d\n",
        "#S_R:40de121\n", "#S_R:40 de1212\n", "#S_R:40de1212 \n", "#S_R:40de1212\r\n", "#S_R:40de12:12\n",
        "#S_R:40de1212?E_XXX\n", "&PUB:0001aabbccdd*00\n", "&PUB:0001aabbccdd\n", "%PUB:0001aabbcc\n", "%PUB:00\n"}) {
    const std::string text = decoded(line);
    CAPTURE(line);
    CHECK((text.starts_with("malformed") || text.starts_with("checksum")));
  }
  CHECK(decoded("S_R:40de1212\n") == "garbage 13\n");
  CHECK(decoded("?f\n") == "garbage 3\n");
  CHECK(decoded("?00\n") == "garbage 4\n");
  CHECK(decoded("40de1212*2d\n\n") == "garbage 12\ngarbage 1\n");
}

TEST_CASE("a lost line feed costs one message, a lost head too") {
  CHECK(decoded("$S_R:40de12$S_W*f4\n") == "malformed $    0\nreply $ S_W   0\n");
  CHECK(decoded("de1010*ba\n&PUB:0001aabbcc&PUB:000240de101040de1111*ba\n") ==
        "garbage 10\nmalformed &    0\npublish 0 2 checked 1088294928 1088295185\n");
}

TEST_CASE("a line without end is bounded") {
  const std::string text = "#" + std::string(3 * ClassicDecoder::line_bytes_max, 'A') + "\n#S_W\n";
  CHECK(decoded(text) == "garbage " + std::to_string(3 * ClassicDecoder::line_bytes_max + 2) + "\nreply # S_W   0\n");
}

TEST_CASE("one chunk and any other chunking agree") {
  std::mt19937 random(7);
  const std::string pieces[] = {"$S_R:40de1212*2d\n",
                                "&PUB:000240de101040de1111*ba\n",
                                "?f4\n",
                                "$CNF:01,04,20,02,03e8,02,10,02*a7\n",
                                "#S_RM:40de1111?E_MAB\n",
                                "\n",
                                "&PUB:0001aabbccdd*00\n",
                                "%PUB:0100\n",
                                "?busy\n",
                                "12*"};
  for (int run = 0; run < 300; ++run) {
    std::string text;
    for (int piece = 0; piece < 30; ++piece) {
      text += pieces[random() % std::size(pieces)];
      if (random() % 4 == 0) {
        text[random() % text.size()] = static_cast<char>(random() % 256);
      }
      if (random() % 50 == 0) {
        text += std::string(random() % 5000, static_cast<char>('#' + random() % 8));
      }
    }
    ClassicDecoder whole, pieced;
    whole.set_data_bytes(4);
    pieced.set_data_bytes(4);
    Trace expected, got;
    whole.feed(bytes_of(text), expected);
    std::string_view rest = text;
    while (!rest.empty()) {
      const std::size_t size = run % 2 == 0 ? 1 : std::min<std::size_t>(rest.size(), 1 + random() % 40);
      pieced.feed(bytes_of(rest.substr(0, size)), got);
      rest.remove_prefix(size);
    }
    CHECK(expected.text == got.text);
    CHECK(whole.pending() == pieced.pending());
  }
}

TEST_CASE("configuration, with the defects of the 2012 gateware") {
  const Crc8 sum;
  const auto plain = parse_configuration("01,04,20,02,03e8,02,10,02", sum, 0xa7);
  REQUIRE(plain);
  CHECK(plain->address_bytes == 1);
  CHECK(plain->data_bytes == 4);
  CHECK(plain->read_many == 32);
  CHECK(plain->publish_mode == 2);
  CHECK(plain->base_hz == 1000);
  CHECK(plain->groups == 2);
  CHECK(plain->group_size == 16);
  CHECK(plain->rate_bytes == 2);
  CHECK_FALSE(parse_configuration("01,04,20,02,03e8,02,10,02", sum, 0xa6));
  CHECK(parse_configuration("01,04,20,02,0186a0,02,10,02", sum, {})->base_hz == 100000);
  CHECK(parse_configuration("01,04,,,02,03e8,02,10,02", sum, {})->read_many == 44);  // 0x2C is sent as ','
  CHECK(parse_configuration("01,04,20,02,,,02,10,02", sum, {})->base_hz == 44);
  CHECK(parse_configuration("01,04,20,02,01,,02,10,02", sum, {})->base_hz == 300);
  CHECK(parse_configuration("01,04,20,02,,,,02,10,02", sum, {})->base_hz == 0x2C2C);
  CHECK(parse_configuration("01,04,20,02,00,02,10,02", sum, {})->base_hz == 256);
  CHECK(parse_configuration("01,04,20,02,0000,02,10,02", sum, {})->base_hz == 65536);
  for (const char* wrong :
       {"", ",", "01,04,20,02,03e8,02,10", "01,04,20,02,03e8,02,10,02,", "00,04,20,02,03e8,02,10,02",
        "01,05,20,02,03e8,02,10,02", "01,04,20,03,03e8,02,10,02", "01,04,20,02,3e8,02,10,02",
        "01,04,20,02,03e8,02,10,00", "01,04,20,02,,02,10,02x", "0104200203e8021002"}) {
    CAPTURE(wrong);
    CHECK_FALSE(parse_configuration(wrong, sum, {}));
  }
}

namespace {

// The CNF of 2012 gateware. It sends a byte 2C as ',' and leaves it out of the checksum, and sends 256**n with a byte
// too few.
struct Configured {
  std::string fields;
  std::uint8_t checksum = 0;
};

Configured configured_2012(std::uint32_t read_many, std::uint32_t base_hz) {
  const Crc8 sum;
  Configured told{"01,04,", sum.of(bytes_of("CNF\x01\x04"))};
  const auto put = [&](std::uint8_t byte) {
    const std::uint8_t one[] = {byte};
    told.fields += byte == 0x2C ? "," : test::hex_of(one);
    told.checksum = byte == 0x2C ? told.checksum : sum.update(told.checksum, byte);
  };
  put(static_cast<std::uint8_t>(read_many));
  told.fields += ",";
  put(2);
  told.fields += ",";
  std::uint32_t bytes = 1;
  while (bytes < 4 && (base_hz - 1) >> (8 * bytes) != 0) {
    ++bytes;
  }
  for (std::uint32_t byte = bytes; byte-- > 0;) {
    put(static_cast<std::uint8_t>(base_hz >> (8 * byte)));
  }
  for (const std::uint8_t byte : std::array<std::uint8_t, 3>{2, 16, 2}) {
    told.fields += ",";
    put(byte);
  }
  return told;
}

}  // namespace

TEST_CASE("the 2012 gateware leaves a byte that it sends as a comma out of its checksum") {
  const Crc8 sum;
  CHECK(configured_2012(32, 300).fields == "01,04,20,02,01,,02,10,02");
  CHECK(configured_2012(32, 300).checksum == 0x87);  // seen in simulation: $CNF:01,04,20,02,01,,02,10,02*87
  CHECK(parse_configuration("01,04,20,02,01,,02,10,02", sum, 0x91)->base_hz == 300);  // the right checksum
  for (std::uint8_t checksum = 0x88; checksum < 0x91; ++checksum) {
    CHECK_FALSE(parse_configuration("01,04,20,02,01,,02,10,02", sum, checksum));
  }
  CHECK_FALSE(parse_configuration("01,04,20,02,012c,02,10,02", sum, 0x87));  // bytes sent as digits always count
  CHECK_FALSE(parse_configuration("01,04,20,02,01,,02,10,02", sum, 0x87, false));
  CHECK(parse_configuration("01,04,20,02,012c,02,10,02", sum, 0x91, false)->base_hz == 300);
  std::uint32_t wrong = 0;
  for (const std::uint32_t read_many : {0u, 32u, 44u}) {
    for (std::uint32_t base_hz = 1; base_hz <= 100'000; ++base_hz) {
      const Configured told = configured_2012(read_many, base_hz);
      const auto read = parse_configuration(told.fields, sum, told.checksum);
      wrong += read && read->read_many == read_many && read->base_hz == base_hz ? 0u : 1u;
    }
  }
  CHECK(wrong == 0);
}
