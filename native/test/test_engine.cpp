// SPDX-License-Identifier: BSD-3-Clause
// ClassicEngine on a virtual clock against scripted answers.
#include <array>
#include <string>
#include <vector>

#include "engine_bench.hpp"

using namespace unitylink;
using namespace unitylink::test;

TEST_CASE("a read and a write") {
  EngineBench bench;
  bench.begin();
  Exchange read = reading(0x12, true);
  bench.submit(read);
  CHECK(bench.sent() == "$R:12*58\n");
  bench.answer("$S_R:40de1212*2d\n");
  CHECK(read.done());
  CHECK(read.status == Status::ok);
  CHECK(read.value == 0x40de1212);
  CHECK(read.attempts == 1);
  Exchange write = writing(0x20, 0xDEADBEEF);
  bench.submit(write);
  CHECK(bench.sent() == "#W:20DEADBEEF\n");
  bench.answer("#S_W\n");
  CHECK(write.status == Status::ok);
}

TEST_CASE("the first fence gets through to a device that publishes, is in mid-message, or was asked before") {
  EngineBench bench;
  Exchange first;
  first.operation = Operation::resynchronise;
  first.attempts_max = 3;
  bench.submit(first);
  CHECK(bench.sent() == "!$RLC*9B\n");
  bench.answer("1212*2d\n&PUB:000240de101040de1111*ba\n#S_R:00000001\n#CNF:01,04,20,02,03e8,02,10,02\n?f3\n");
  CHECK_FALSE(first.done());
  bench.wait(13 * ms);  // the datalink error may have removed the fence, so it is sent again soon
  CHECK(bench.sent() == "!$RLC*9B\n");
  bench.answer(cnf);
  CHECK(first.status == Status::ok);
  CHECK(bench.engine->statistics().unclaimed_publishes == 1);
  CHECK(bench.engine->statistics().garbage_bytes == 8);
}

TEST_CASE("a fence that nobody answers may have gone into a frame that noise began: the next one ends it") {
  using namespace std::string_literals;
  EngineBench bench;
  bench.begin();
  Exchange read = reading(1);
  bench.submit(read);
  bench.sent();
  bench.wait(101 * ms);
  CHECK(bench.sent() == "!$RLC*9B\n");
  bench.wait(101 * ms);
  CHECK(bench.sent() == "\0!$RLC*9B\n"s);
  bench.answer(cnf);
  CHECK(bench.sent() == "#R:01\n");
  bench.answer("#S_R:00000011\n");
  CHECK(read.value == 0x11);
  Exchange other = reading(2);
  bench.submit(other);
  bench.sent();
  bench.answer("?f4\n");
  CHECK(bench.sent() == "!$RLC*9B\n");
}

TEST_CASE("gateware without RLC, and a datalink without checksums") {
  EngineBench bench;
  Exchange first;
  first.operation = Operation::resynchronise;
  bench.submit(first);
  SUBCASE("no RLC") {
    CHECK(bench.sent() == "!$RLC*9B\n");
    bench.answer("$?E_ICC\n");
    CHECK(bench.engine->checksums());
  }
  SUBCASE("neither") {
    CHECK(bench.sent() == "!$RLC*9B\n");
    bench.answer("?f1\n");
    CHECK(bench.sent() == "!#RLC\n");
    bench.answer("#?E_ICC\n");
    CHECK_FALSE(bench.engine->checksums());
  }
  CHECK(first.status == Status::ok);
  CHECK_FALSE(bench.engine->reported());
}

TEST_CASE("an error of the device ends its request and nothing else") {
  EngineBench bench(1024);
  bench.begin();
  std::array<std::uint32_t, 3> values{};
  const std::array<std::uint32_t, 3> addresses{1, 2, 3};
  Exchange many = reading(0);
  many.operation = Operation::read_many;
  many.addresses = addresses;
  many.values = values;
  Exchange read = reading(0x12);
  bench.submit(many);
  bench.submit(read);
  CHECK(bench.sent() == "#RM:03010203\n#R:12\n");
  bench.answer("#S_RM:40de111140de1212?E_BAT\n#S_R:00000005\n");
  CHECK(many.status == Status::bus_error);
  CHECK(many.error == "E_BAT");
  CHECK(many.words == 2);
  CHECK(read.status == Status::ok);
  CHECK(read.value == 5);
  CHECK(bench.engine->statistics().fences == 1);
}

TEST_CASE("a timeout makes all in flight void; reads come again, writes are unknown, late answers match nothing") {
  EngineBench bench(1024);
  bench.begin();
  Exchange first = reading(1), write = writing(2, 7), memory = writing(3, 8, true), last = reading(4),
           behind = reading(5);
  for (Exchange* exchange : {&first, &write, &memory, &last}) {
    bench.submit(*exchange);
  }
  bench.sent();
  bench.wait(99 * ms);
  CHECK_FALSE(write.done());
  bench.wait(2 * ms);
  CHECK(write.status == Status::unknown);
  CHECK_FALSE(first.done());
  bench.submit(behind);
  CHECK(bench.sent() == "!$RLC*9B\n");
  bench.answer("#S_R:00000bad\n#S_W\n#S_W\n#S_R:00000bad\n");  // late
  CHECK_FALSE(first.done());
  bench.answer(cnf);
  CHECK(bench.sent() == "#R:01\n#W:0300000008\n#R:04\n#R:05\n");
  bench.answer("#S_R:00000001\n#S_W\n#S_R:00000004\n#S_R:00000005\n");
  CHECK(first.value == 1);
  CHECK(memory.status == Status::ok);
  CHECK(last.value == 4);
  CHECK(behind.value == 5);
  CHECK(first.attempts == 2);
  CHECK(bench.engine->statistics().stale_replies == 4);
}

TEST_CASE("answers count only when all requests in flight have theirs: one that vanished shifts nothing") {
  EngineBench bench(1024);
  bench.begin();
  Exchange first = reading(1), second = reading(2);
  bench.submit(first);
  bench.submit(second);
  bench.sent();
  bench.answer("#S_R:00000002\n");  // the first request was lost, so this answers the second one
  CHECK_FALSE(first.done());
  bench.wait(101 * ms);
  CHECK(bench.sent() == "!$RLC*9B\n");
  bench.answer(cnf);
  CHECK(bench.sent() == "#R:01\n#R:02\n");
  bench.answer("#S_R:00000001\n#S_R:00000002\n");
  CHECK(first.value == 1);
  CHECK(second.value == 2);
}

TEST_CASE("bad replies, datalink errors and strange ones bring the fence at once") {
  for (const char* bad : {"$S_R:40de1212*2e\n", "#S_R:40de1212\n", "$S_R:40de12*00\n", "$S_W*f4\n", "?f4\n",
                          "$S_RM:40de1212*00\n", "$?E_XYZ\n"}) {
    CAPTURE(bad);
    EngineBench bench;
    bench.begin();
    Exchange read = reading(0x12, true);
    bench.submit(read);
    CHECK(bench.sent() == "$R:12*58\n");
    bench.answer(bad);
    CHECK_FALSE(read.done());
    CHECK(bench.sent() == "!$RLC*9B\n");
    bench.answer(cnf);
    CHECK(bench.sent() == "$R:12*58\n");
    bench.answer("$S_R:40de1212*2d\n");
    CHECK(read.value == 0x40de1212);
  }
}

TEST_CASE("a configuration or a stray answer when nothing is pending is no reason for anything") {
  EngineBench bench;
  bench.begin();
  bench.answer(cnf);
  bench.answer("#S_R:00000001\n?f3\n$?E_ICC\n");
  Exchange read = reading(1);
  bench.submit(read);
  CHECK(bench.sent() == "#R:01\n");
  bench.answer(cnf);
  bench.answer("#S_R:00000009\n");
  CHECK(read.value == 9);
}

TEST_CASE("a silent device: everything ends, in time, with the number of attempts") {
  EngineBench bench;
  bench.begin();
  Exchange read = reading(1), write = writing(2, 3), unsent = writing(3, 4);
  bench.submit(read);
  bench.sent();
  bench.submit(write);
  bench.submit(unsent);
  const std::uint64_t begun = bench.now;
  while (bench.engine->next_deadline_ns() != ClassicEngine::no_deadline) {
    bench.now = bench.engine->next_deadline_ns();
    bench.engine->advance(bench.now);
    bench.sent();
    REQUIRE(bench.now - begun < 1000 * ms);
  }
  CHECK(read.status == Status::timeout);
  CHECK(read.attempts == 3);
  CHECK(read.ended_ns - read.begun_ns == 300 * ms);
  CHECK(write.status == Status::timeout);  // never sent, so its outcome is known
  CHECK_FALSE(write.sent);
  CHECK(unsent.status == Status::timeout);
}

TEST_CASE("credit: no more bytes on their way than the device's buffers hold, unless one alone is longer") {
  EngineBench bench(40);
  bench.begin();
  std::vector<Exchange> reads(10, reading(0x11));
  for (Exchange& read : reads) {
    bench.submit(read);
  }
  CHECK(bench.sent() == "#R:11\n#R:11\n");  // replies of 14 bytes: two fit into 40, three do not
  bench.answer("#S_R:00000001\n");
  CHECK(bench.sent() == "#R:11\n");
  std::array<std::uint32_t, 32> values{}, addresses{};
  EngineBench other(16);
  other.begin();
  Exchange many = reading(0);
  many.operation = Operation::read_many;
  many.addresses = addresses;
  many.values = values;
  Exchange read = reading(1);
  other.submit(many);
  other.submit(read);
  CHECK(other.sent().starts_with("#RM:20"));
  CHECK(other.sent().empty());
}

TEST_CASE("the window bounds a batch") {
  EngineBench bench(65536, 4);
  bench.begin();
  std::vector<Exchange> reads(6, reading(0x11));
  for (Exchange& read : reads) {
    bench.submit(read);
  }
  CHECK(bench.sent() == "#R:11\n#R:11\n#R:11\n#R:11\n");
  bench.answer("#S_R:00000001\n#S_R:00000001\n#S_R:00000001\n");
  CHECK(bench.sent().empty());
  bench.answer("#S_R:00000001\n");
  CHECK(reads[0].done());
  CHECK(bench.sent() == "#R:11\n#R:11\n");
}

TEST_CASE("after a failure the rest of its batch is not sent") {
  EngineBench bench;
  bench.begin();
  Batch batch;
  std::vector<Exchange> writes(3, writing(1, 2));
  for (Exchange& write : writes) {
    write.batch = &batch;
    bench.submit(write);
  }
  CHECK(bench.sent() == "#W:0100000002\n");
  bench.answer("#?E_FBW\n");
  CHECK(bench.sent().empty());
  CHECK(writes[0].status == Status::bus_error);
  CHECK(writes[1].status == Status::cancelled);
  CHECK(writes[2].status == Status::cancelled);
}

TEST_CASE("requests that are taken back end at once; the others in flight come again, or are unknown") {
  EngineBench bench(600);
  bench.begin();
  std::array<Exchange, 2> mine{reading(1), writing(2, 3)};
  Exchange theirs = reading(4), write = writing(5, 6), later = reading(7);
  for (Exchange* exchange : {&theirs, &mine[0], &mine[1], &write}) {
    bench.submit(*exchange);
  }
  CHECK(bench.sent() == "#R:04\n#R:01\n#W:0200000003\n#W:0500000006\n");
  bench.submit(later);
  bench.engine->abandon(mine, bench.now);
  CHECK(mine[0].status == Status::timeout);
  CHECK(mine[1].status == Status::unknown);
  CHECK(write.status == Status::unknown);
  CHECK_FALSE(theirs.done());
  CHECK(bench.sent() == "!$RLC*9B\n");
  bench.answer("#S_R:00000009\n");  // too late to be believed
  bench.answer(cnf);
  CHECK(bench.sent() == "#R:04\n#R:07\n");
  bench.answer("#S_R:00000044\n#S_R:00000077\n");
  CHECK(theirs.value == 0x44);
  CHECK(later.value == 0x77);
}

TEST_CASE(
    "requests that are withdrawn harm no other: unsent ones are never sent, one on its way is waited for but not "
    "repeated") {
  EngineBench bench;
  bench.begin();
  std::array<Exchange, 2> mine{reading(1), writing(2, 3)};
  Exchange theirs = writing(4, 5);
  mine[0].timeout_ns = 3'600'000 * ms;
  for (Exchange* exchange : {&mine[0], &mine[1], &theirs}) {
    bench.submit(*exchange);
  }
  CHECK(bench.sent() == "#R:01\n");  // a FIFO of 16 bytes has no room for more
  bench.engine->withdraw(mine, bench.now);
  CHECK(mine[1].status == Status::cancelled);
  CHECK_FALSE(mine[0].done());
  CHECK(bench.sent().empty());
  bench.wait(100 * ms);  // the usual timeout applies, not its own
  CHECK(mine[0].status == Status::timeout);
  CHECK(bench.sent() == "!$RLC*9B\n");
  bench.answer(cnf);
  CHECK(bench.sent() == "#W:0400000005\n");
  bench.answer("#S_W\n");
  CHECK(theirs.status == Status::ok);
}

TEST_CASE("requests that are taken back during a fence leave nothing to trip over") {
  EngineBench bench;
  bench.begin();
  std::array<Exchange, 2> mine{reading(1), reading(2)};
  bench.submit(mine[0]);
  CHECK(bench.sent() == "#R:01\n");
  bench.submit(mine[1]);
  bench.answer("?f4\n");
  CHECK(bench.sent() == "!$RLC*9B\n");
  bench.engine->abandon(mine, bench.now);
  CHECK(mine[0].status == Status::timeout);
  CHECK(mine[1].status == Status::cancelled);  // never sent
  bench.answer("?f1\n$?E_ICC\n#S_W\n");
  bench.answer(cnf);
  bench.wait(1000 * ms);
  CHECK(bench.engine->next_deadline_ns() == ClassicEngine::no_deadline);
  CHECK(bench.sent().empty());
  Exchange next = reading(3);
  bench.submit(next);
  CHECK(bench.sent() == "!$RLC*9B\n");
  bench.answer(cnf);
  CHECK(bench.sent() == "#R:03\n");
  bench.answer("#S_R:00000033\n");
  CHECK(next.value == 0x33);
}

TEST_CASE("busy, another device, and the end of the port reach everybody") {
  EngineBench bench;
  bench.begin();
  Exchange read = reading(1), write = writing(1, 2);
  SUBCASE("busy") {
    bench.submit(read);
    bench.sent();
    bench.answer("?busy\n");
    CHECK(read.status == Status::busy);
  }
  SUBCASE("another device answers the fence") {
    bench.submit(read);
    bench.sent();
    bench.wait(101 * ms);
    bench.sent();
    bench.answer("$CNF:02,04,20,02,03e8,02,10,02*2c\n");
    CHECK(read.status == Status::mismatch);
  }
  SUBCASE("unplugged") {
    bench.submit(write);
    bench.sent();
    bench.submit(read);
    bench.engine->end(Status::closed, bench.now);
    CHECK(write.status == Status::unknown);
    CHECK(read.status == Status::closed);
  }
  Exchange later = reading(2);
  bench.submit(later);
  CHECK(later.done());
  CHECK(later.status != Status::ok);
}

TEST_CASE("publishes go to the ring of their group, whole ones only") {
  EngineBench bench;
  bench.begin();
  PublishRing ring(2, 3);
  bench.engine->expect_checked_publishes(true);
  bench.engine->claim(0, &ring);
  for (int count = 0; count < 5; ++count) {
    bench.answer("&PUB:000240de101040de1111*ba\n");
  }
  bench.answer("%PUB:000240de101040de1111\n%PUB:000340de1010?E_FBR\n&PUB:000240de101040de1111*bb\n");
  CHECK(ring.size() == 3);
  CHECK(ring.lost() == 2);
  CHECK(bench.engine->statistics().publishes == 5);
  CHECK(bench.engine->statistics().overruns == 2);
  CHECK(bench.engine->statistics().mismatched_publishes == 2);
  CHECK(bench.engine->statistics().checksum_errors == 1);
  std::array<double, 8> times{};
  std::array<std::uint32_t, 16> values{};
  CHECK(ring.drain(times, values) == 3);
  CHECK(values[1] == 0x40de1111);
  CHECK(times[0] == doctest::Approx(1.0));
  CHECK(ring.size() == 0);
}
