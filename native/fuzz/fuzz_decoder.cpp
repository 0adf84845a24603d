// SPDX-License-Identifier: BSD-3-Clause
// Random and damaged traffic, in random chunks, through two decoders and an engine:  fuzz_decoder --seconds N --seed S
// It checks these promises. Chunks give the same events as the whole input. Every byte costs a limited time. Malformed
// input gives no value. Every request ends.
#include <cstring>
#include <memory>
#include <random>
#include <string>

#include "fuzzing.hpp"
#include "layer1_stream/classic_decoder.hpp"
#include "layer1_stream/configuration.hpp"
#include "layer2_message/classic_engine.hpp"

using namespace unitylink;

namespace {

constexpr const char* program = "fuzz_decoder";

// Combines all that a decoder reports into one number, and counts it.
struct Digest {
  std::uint64_t value = 1469598103934665603u;
  std::uint64_t messages = 0;
  void add(std::uint64_t more) { value = (value ^ more) * 1099511628211u; }
  void add(std::string_view text) {
    for (const char character : text) {
      add(static_cast<std::uint64_t>(static_cast<std::uint8_t>(character)));
    }
  }
  void on_message(const Message& message) {
    ++messages;
    add(static_cast<std::uint64_t>(message.kind));
    add(static_cast<std::uint64_t>(static_cast<std::uint8_t>(message.head)));
    add(message.letters);
    add(message.error);
    add(message.fields);
    add(message.code);
    for (const std::uint8_t byte : message.data) {
      add(byte);
    }
    if (!message.fields.empty()) {
      const auto told = parse_configuration(message.fields, Crc8{}, message.checksum);
      add(told ? told->base_hz : 0u);
    }
  }
  void on_publish(const Publish& publish) {
    ++messages;
    add(publish.group << 16 | publish.count << 8 | (publish.checked ? 1u : 0u));
    for (const std::uint32_t word : publish.words) {
      add(word);
    }
  }
  void on_garbage(std::size_t bytes) { add(bytes); }
};

class Fuzz {
 public:
  explicit Fuzz(std::uint64_t seed) : random_(seed), seed_(seed) {}

  void round() {
    ++rounds;
    const std::string text = traffic();
    ++strings;
    bytes += text.size();
    const auto data_bytes = static_cast<std::uint32_t>(random_() % 5);
    Digest expected, got;
    whole_.set_data_bytes(data_bytes);
    pieced_.set_data_bytes(data_bytes);
    whole_.feed(span(text), expected);
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t size = std::min<std::size_t>(text.size() - at, 1 + random_() % (1u << (random_() % 12)));
      pieced_.feed(span(text).subspan(at, size), got);
      at += size;
    }
    understood += expected.messages;
    if (expected.value != got.value || whole_.pending() != pieced_.pending()) {
      fuzzing::fail(program, "one chunk and many chunks differ", seed_, rounds, span(text));
    }
    drive_engine(text);
  }

  std::uint64_t rounds = 0, strings = 0, bytes = 0, understood = 0;

 private:
  static std::span<const std::uint8_t> span(const std::string& text) {
    return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
  }

  std::string traffic() {
    static const std::string valid[] = {"$S_R:40de1212*2d\n",
                                        "#S_R:40de1212\n",
                                        "$S_W*f4\n",
                                        "#S_W\n",
                                        "&PUB:000240de101040de1111*ba\n",
                                        "%PUB:000240de101040de1111\n",
                                        "$CNF:01,04,20,02,03e8,02,10,02*a7\n",
                                        "#CNF:01,04,20,02,,,02,10,02\n",
                                        "?f1\n",
                                        "?f4\n",
                                        "$?E_ICC\n",
                                        "#S_RM:40de111140de1212?E_MAB\n",
                                        "%PUB:000340de1010?E_FBR\n",
                                        "#S_RSI:0005021112\n",
                                        "?busy\n",
                                        "\n"};
    std::string text;
    for (auto count = random_() % 12; count > 0; --count) {
      if (random_() % 6 == 0) {
        for (auto size = random_() % (random_() % 20 == 0 ? 6000 : 40); size > 0; --size) {
          text += static_cast<char>(random_() % 3 == 0 ? random_() % 256
                                                       : "0123456789abcdef#$%&?:*,\nPUBS_R"[random_() % 31]);
        }
      } else {
        text += valid[random_() % std::size(valid)];
      }
      if (!text.empty() && random_() % 3 == 0) {
        const std::size_t at = random_() % text.size();
        switch (random_() % 3) {
          case 0: text[at] = static_cast<char>(text[at] ^ (1 << random_() % 8)); break;
          case 1: text.erase(at, 1 + random_() % 3); break;
          default: text.insert(at, 1, text[at]); break;
        }
      }
    }
    return text;
  }

  // Requests to a device that answers with this traffic. All must end within their attempts.
  void drive_engine(const std::string& text) {
    auto engine = std::make_unique<ClassicEngine>(EngineSettings{});
    engine->configure({.address_bytes = 1,
                       .data_bytes = 4,
                       .read_many = 32,
                       .publish_mode = 2,
                       .base_hz = 1000,
                       .groups = 2,
                       .group_size = 16,
                       .rate_bytes = 2,
                       .discovered = true});
    Exchange exchanges[4];
    std::uint64_t now = 1;
    for (std::size_t index = 0; index < std::size(exchanges); ++index) {
      exchanges[index].operation = index % 2 == 0 ? Operation::read : Operation::write;
      exchanges[index].repeat = index < 2;
      exchanges[index].checked = index % 3 == 0;
      exchanges[index].attempts_max = 2;
      engine->submit(exchanges[index], now);
    }
    engine->sent(engine->transmit(now).size());
    std::size_t at = 0;
    for (int step = 0; engine->next_deadline_ns() != ClassicEngine::no_deadline || at < text.size(); ++step) {
      if (step > 20'000) {
        fuzzing::fail(program, "a request did not end", seed_, rounds, span(text));
      }
      if (at < text.size()) {
        const std::size_t size = std::min<std::size_t>(text.size() - at, 1 + random_() % 64);
        engine->receive(span(text).subspan(at, size), now);
        at += size;
      } else {
        now = engine->next_deadline_ns();
      }
      engine->advance(now);
      engine->sent(engine->transmit(now).size());
    }
    for (const Exchange& exchange : exchanges) {
      if (!exchange.done()) {
        fuzzing::fail(program, "a request was forgotten", seed_, rounds, span(text));
      }
    }
  }

  std::mt19937_64 random_;
  std::uint64_t seed_;
  ClassicDecoder whole_, pieced_;
};

}  // namespace

int main(int count, char** arguments) { return fuzzing::run<Fuzz>(program, "messages", count, arguments); }
