# SPDX-License-Identifier: BSD-3-Clause
"""From the ring of a link to the put of a network: whole, in order, and each output for itself."""

from __future__ import annotations

import struct
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from unitylink import Link, connect
from unitylink._native import PublishPath, SampleOutput
from unitylink.layer2_message import Subscription
from unitylink.spec import load
from unitylink.zenoh.bridge.groups import Groups
from unitylink.zenoh.bridge.topics import typed_output
from unitylink.zenoh.messages import decode_sample
from unitylink.zenoh.schema import Field, fields_of

TEXT = """
public arm() {
   @count = 0x10: u32 READWRITE(PUBLISH(1000 Hz));
   @speed = 0x11: i16 READWRITE(UNIT="rad/s", SCALE=0.1, PUBLISH(1000 Hz));
}
"""
ADDRESSES, TICK_NS, DIVISOR = (0x10, 0x11), 1_000_000, 10


class Publisher:
    """In the place of Zenoh's: it keeps what is put, or refuses it."""

    def __init__(self) -> None:
        self.puts: list[bytearray] = []
        self.refuses = self.ended = False

    def put(self, message: bytearray) -> None:
        if self.refuses:
            raise RuntimeError("the session is closed")
        self.puts.append(message)

    def undeclare(self) -> None:
        self.ended = True


@pytest.fixture(name="file", scope="module")
def _file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("path") / "arm.ul"
    file.write_text(TEXT)
    return file


@pytest.fixture(name="link")
def _link(file: Path) -> Iterator[Link]:
    with connect(f"sim:{file}", time="lockstep") as link:
        yield link


@pytest.fixture(name="fields", scope="module")
def _fields(file: Path) -> list[Field]:
    return list(fields_of(load(file), 32).values())


def come(link: Link, subscription: Subscription, values: range) -> None:
    """Let a publish come for each value, with that value as its count and 0.1 of it below 0 as its speed."""
    native, identity = link._native, subscription._identity
    for value in values:
        link.write_many(ADDRESSES, (value, -value & 0xFFFF))
        before = seen = native.available(identity) + native.lost(identity)
        while seen == before:
            native.pass_until(native.now_ns + TICK_NS)
            seen = native.available(identity) + native.lost(identity)


def counts(publisher: Publisher) -> list[tuple[int, int]]:
    """Return (sequence, count) of what was put as words."""
    decoded = [decode_sample(bytes(one), 2) for one in publisher.puts]
    return [(sequence, words[0]) for sequence, _, words in decoded]


def test_a_burst_comes_whole_in_order_and_as_every_output_wants_it(link: Link, fields: list[Field]) -> None:
    """As words and as typed values, with the time of each; the next burst goes on where it ended."""
    raw, typed = Publisher(), Publisher()
    path = PublishPath(pytest.fail)
    path.outputs = SampleOutput(raw.put, 2), typed_output(typed.put, fields)
    subscription = link.subscribe(ADDRESSES, divisor=DIVISOR)
    subscription.hand_over(path.take)
    come(link, subscription, range(1, 6))
    subscription.deliver()
    come(link, subscription, range(6, 300))
    subscription.deliver()
    subscription.deliver()  # nothing has come
    assert path.published == len(raw.puts) == len(typed.puts)
    told = counts(raw)
    assert [sequence for sequence, _ in told] == list(range(len(told)))
    assert [count for _, count in told if count] == list(range(1, 300))
    times_ns = [decode_sample(bytes(one), 2)[1] for one in raw.puts]
    assert abs(times_ns[2] - times_ns[1] - DIVISOR * TICK_NS) < 1000
    assert 0 <= time.monotonic_ns() - times_ns[-1] < 1_000_000_000  # by the clock of the system
    values = [struct.unpack_from("<Id", one, 12) for one in typed.puts]
    assert values == [(count, -count / 10) for _, count in told]
    assert [one[:4] for one in typed.puts] == [one[:4] for one in raw.puts]


def test_what_the_ring_lost_is_a_gap_in_the_sequence(link: Link) -> None:
    publisher, path = Publisher(), PublishPath(pytest.fail)
    path.outputs = (SampleOutput(publisher.put, 2),)
    subscription = link.subscribe(ADDRESSES, divisor=DIVISOR, ring=4)
    come(link, subscription, range(1, 11))
    lost = subscription.lost
    subscription.hand_over(path.take)
    subscription.deliver()
    come(link, subscription, range(11, 13))
    subscription.deliver()
    assert lost >= 6
    assert counts(publisher) == [(lost + number, 7 + number) for number in range(6)]


def test_an_output_that_fails_keeps_no_other_from_its_puts(link: Link) -> None:
    """It fails alone, is told once for a burst, and its sequence goes on. So does a wrong size."""
    one, other, failed = Publisher(), Publisher(), list[object]()
    path = PublishPath(failed.append)
    path.outputs = SampleOutput(one.put, 2), SampleOutput(other.put, 3), SampleOutput(other.put, 2)
    subscription = link.subscribe(ADDRESSES, divisor=DIVISOR)
    subscription.hand_over(path.take)
    one.refuses = True
    come(link, subscription, range(1, 4))
    subscription.deliver()
    assert not one.puts
    assert [str(error) for error in failed] == [
        "the session is closed",
        "an output for rows of another size",
    ]
    one.refuses = False
    come(link, subscription, range(4, 6))
    subscription.deliver()
    assert counts(one) == counts(other)[-2:]
    assert [count for _, count in counts(other)][-5:] == [1, 2, 3, 4, 5]


def test_only_what_somebody_wants_is_put(link: Link, fields: list[Field]) -> None:
    """The words for the links of our clients, the topic for its subscribers, and none after the last."""
    words, topic = Publisher(), Publisher()
    groups = Groups(lambda: link, lambda number: words)  # type: ignore[arg-type, return-value]

    def came() -> tuple[int, int]:
        words.puts.clear()
        topic.puts.clear()
        link.step(0.003)
        return len(words.puts), len(topic.puts)

    number = groups.join(0, ADDRESSES, divisor=1, topic=typed_output(topic.put, fields))
    assert came() == (0, 3)
    assert groups.join(7, ADDRESSES, divisor=1) == number
    assert came() == (3, 3)
    groups.leave(number, 0)
    assert came() == (3, 0)
    assert groups.published == 9
    groups.leave(number, 7)
    assert came() == (0, 0)
    assert words.ended


def test_a_message_that_nobody_keeps_is_used_again(link: Link) -> None:
    """And one that somebody keeps is not: that is what the tests above rest on."""
    seen = list[tuple[int, bytes]]()
    output = SampleOutput(lambda message: seen.append((id(message), bytes(message))), 2)
    path = PublishPath(pytest.fail)
    path.outputs = (output,)
    subscription = link.subscribe(ADDRESSES, divisor=DIVISOR)
    subscription.hand_over(path.take)
    come(link, subscription, range(1, 9))
    subscription.deliver()
    assert len({place for place, _ in seen}) == 1
    assert [decode_sample(data, 2)[2][0] for _, data in seen][-8:] == list(range(1, 9))
    kept = list[memoryview]()
    path.outputs = (SampleOutput(lambda message: kept.append(memoryview(message)), 2),)
    come(link, subscription, range(9, 12))
    subscription.deliver()
    assert [decode_sample(bytes(one), 2)[2][0] for one in kept] == [9, 10, 11]
