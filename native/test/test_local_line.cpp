// SPDX-License-Identifier: BSD-3-Clause
// A line in memory: bytes go both ways in order, it becomes full, and it ends.
#include <doctest/doctest.h>

#include <memory>
#include <vector>

#include "layer0_driver/local_line.hpp"

using unitylink::LocalLine;
using unitylink::Status;

namespace {

using LineBytes = std::vector<std::uint8_t>;

LineBytes line_bytes(std::size_t count, std::uint8_t first) {
  LineBytes bytes(count);
  for (std::size_t index = 0; index < count; ++index) {
    bytes[index] = static_cast<std::uint8_t>(first + index);
  }
  return bytes;
}

LineBytes all_received(LocalLine& line, LocalLine::Side at, std::size_t most) {
  LineBytes into(most);
  into.resize(line.receive(at, into).count);
  return into;
}

}  // namespace

TEST_CASE("bytes go both ways") {
  LocalLine line;
  CHECK_FALSE(line.readable(LocalLine::board));
  CHECK(line.send(LocalLine::link, line_bytes(5, 1)).count == 5);
  CHECK(line.send(LocalLine::link, line_bytes(2, 6)).count == 2);
  CHECK(line.send(LocalLine::board, line_bytes(3, 100)).count == 3);
  CHECK(line.readable(LocalLine::board));
  CHECK(all_received(line, LocalLine::board, 4) == line_bytes(4, 1));
  CHECK(all_received(line, LocalLine::board, 100) == line_bytes(3, 5));
  CHECK(all_received(line, LocalLine::link, 100) == line_bytes(3, 100));
  CHECK_FALSE(line.readable(LocalLine::board));
  LineBytes room(1);
  CHECK(line.receive(LocalLine::board, room).status == Status::ok);
}

TEST_CASE("a line that nobody reads becomes full, and has room again when somebody does") {
  LocalLine line;
  const LineBytes block = line_bytes(1000, 0);
  std::size_t sent = 0;
  for (std::size_t count = 1; count > 0; sent += count) {
    count = line.send(LocalLine::board, block).count;
  }
  CHECK(sent == LocalLine::room);
  CHECK_FALSE(line.writable(LocalLine::board));
  CHECK(all_received(line, LocalLine::link, 300) == line_bytes(300, 0));
  CHECK(line.writable(LocalLine::board));
  CHECK(line.send(LocalLine::board, block).count == 300);
  LineBytes rest = all_received(line, LocalLine::link, 2 * LocalLine::room);
  CHECK(rest.size() == LocalLine::room);
  CHECK(LineBytes(rest.end() - 300, rest.end()) == line_bytes(300, 0));
}

TEST_CASE("what was sent before the end still arrives") {
  LocalLine line;
  CHECK(line.send(LocalLine::board, line_bytes(2, 7)).count == 2);
  line.close(LocalLine::board);
  CHECK(line.send(LocalLine::link, line_bytes(1, 0)).status == Status::closed);
  CHECK(all_received(line, LocalLine::link, 10) == line_bytes(2, 7));
  LineBytes room(1);
  CHECK(line.receive(LocalLine::link, room).status == Status::closed);
  CHECK(line.readable(LocalLine::link));
}

TEST_CASE("a descriptor stands for a line once, and only while the line is there") {
  const auto line = std::make_shared<LocalLine>();
  LocalLine::offer(100'001, line);
  CHECK(LocalLine::claim(100'001) == line);
  CHECK(LocalLine::claim(100'001) == nullptr);
  LocalLine::offer(100'002, std::make_shared<LocalLine>());
  CHECK(LocalLine::claim(100'002) == nullptr);
}
