// SPDX-License-Identifier: BSD-3-Clause
// A scheme is one row. This file adds the scheme `loop:`, which no other file knows. Link and the C ABI can open it,
// and all messages name it.
#include <doctest/doctest.h>

#include <memory>
#include <string>

#include "device/board.hpp"
#include "device/endpoints.hpp"
#include "layer0_driver/descriptor_driver.hpp"
#include "layer2_message/link.hpp"
#include "unitylink.h"

using namespace unitylink;

namespace {

// A driver that contains its own board.
class LoopDriver final : public DescriptorDriver {
 public:
  LoopDriver(std::unique_ptr<device::Board> board, int descriptor)
      : DescriptorDriver(descriptor), board_(std::move(board)) {}
  ~LoopDriver() override { LoopDriver::close(); }

 private:
  std::unique_ptr<device::Board> board_;
};

Outcome open_loop(const Url& url, const Patience& patience, std::unique_ptr<Driver>& driver) {
  CHECK(patience.timeout_ns == 2'000'000'000);  // timeout=1, twice
  std::uint64_t bits = 32;
  if (const std::string* text = url.option("bits");
      text != nullptr && (!parse_number(*text, 32, bits) || bits % 8 != 0)) {
    return {Status::bad_url, "link URL '" + url.text + "': bits=" + *text + " is none of 8, 16, 24 and 32"};
  }
  device::DeviceConfiguration configuration;
  configuration.data_bits = static_cast<std::uint32_t>(bits);
  auto board = std::make_unique<device::Board>(configuration, device::make_endpoint("fd", "127.0.0.1"));
  board->start();
  const std::string end = board->url().substr(3);  // fd:NUMBER
  driver = std::make_unique<LoopDriver>(std::move(board), std::stoi(end));
  return {};
}

const Scheme loop{.name = "loop",
                  .form = "loop:NAME",
                  .what = "a board in its own driver",
                  .place = Place::name,
                  .options = "bits spare",
                  .open = &open_loop};
const AddedScheme added(loop);

std::string refused(const char* url) {
  std::unique_ptr<Link> link;
  const Outcome outcome = Link::open(url, link);
  CHECK(outcome.status == Status::bad_url);
  return outcome.text;
}

bool has(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("a row is all that a new scheme needs") {
  std::unique_ptr<Link> link;
  const Outcome outcome = Link::open("loop:here?bits=16&timeout=1&attempts=2&window=3", link);
  CAPTURE(outcome.text);
  REQUIRE(outcome.ok());
  CHECK(link->configuration().data_bytes == 2);
  CHECK(link->write(0x10, 0xBEEF, {}).ok());
  std::uint32_t word = 0;
  CHECK(link->read(0x10, word, {.repeat = true}).ok());
  CHECK(word == 0xBEEF);

  ul_link* c_link = nullptr;
  REQUIRE(ul_open("loop:?timeout=1&attempts=2", &c_link) == UL_OK);
  CHECK(ul_write(c_link, 0x11, 0x12345678, nullptr) == UL_OK);
  CHECK(ul_read(c_link, 0x11, &word, nullptr) == UL_OK);
  CHECK(word == 0x12345678);
  ul_close(c_link);
  ul_free(c_link);
}

TEST_CASE("messages tell of every row") {
  for (const Scheme* scheme : schemes()) {
    CAPTURE(std::string(scheme->name));
    CHECK(has(refused("none:x"), std::string(scheme->form).c_str()));
    CHECK(find_scheme(scheme->name) == scheme);
    CHECK(scheme->form.starts_with(std::string(scheme->name) + ":"));
    CHECK((scheme->open != nullptr));
  }
  CHECK(has(refused("loop:x?bits=7&timeout=1&attempts=2"), "bits=7 is none of 8, 16, 24 and 32"));
  CHECK(has(refused("loop:x?bit=7"), "no option 'bit'"));
  CHECK(has(refused("loop:x?bit=7"), ", bits and spare (loop)"));
  CHECK(has(refused("loop:x?baud=9600"), "no option 'baud'"));  // an option of another scheme
  CHECK(has(refused("tcp://127.0.0.1:1?bits=8"), "no option 'bits'"));
  CHECK(has(refused("spi:"), "the device file is missing, as in spi:/dev/spidev0.0"));
  CHECK(has(refused("fd:seven"), "'seven' is not a descriptor number"));
  CHECK(has(refused("rs485:/dev/x?node=1&protocol=classic"), "carries the framed protocol only"));
  CHECK(has(refused("fd:7?reconnect=1"), "cannot be opened again"));
}

TEST_CASE("an option is taken whole") {
  const Scheme row{.name = "x", .form = "x:", .what = "", .options = "poll speed_hz"};
  CHECK(row.takes("poll"));
  CHECK(row.takes("speed_hz"));
  for (const char* other : {"", "pol", "speed", "poll speed_hz", "hz"}) {
    CHECK(!row.takes(other));
  }
  CHECK(!Scheme{.name = "x", .form = "x:", .what = ""}.takes("poll"));
}
