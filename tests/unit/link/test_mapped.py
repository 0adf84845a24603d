# SPDX-License-Identifier: BSD-3-Clause
"""`mmap:` links on a file of shared memory. A process of its own plays the device on it."""

from __future__ import annotations

import asyncio
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from unitylink import (
    BusError,
    DeviceMismatch,
    Link,
    LinkClosed,
    LinkNotFound,
    UrlError,
    ValueRangeError,
    connect,
)
from unitylink.connection import open_driver
from unitylink.layer4_data import Node, ReadValue, WriteValue, load_spec_objects
from unitylink.spec import compile_text

WORDS = 1024
# Word 0 counts, and word 1 is its complement. Both change together, except for a moment. Word 2 echoes word
# 3, and word 4 says stop.
DEVICE = """
import numpy, sys
words = numpy.memmap(sys.argv[1], dtype="<u4", mode="r+")
words[1] = 0xFFFFFFFF
print("ready", flush=True)
count = 0
while words[4] != 0xDEAD:
    words[2] = words[3]
    if words[5]:
        count += 1
        words[0] = count & 0xFFFFFFFF
        words[1] = ~count & 0xFFFFFFFF
"""
SPEC = """
link here (BASE_RATE=1000);
public robot() {
   drive: pwm(channels=2) @ (0x10);
   @echo = 0x2: signed READ(PUBLISH(100 Hz));
   @sent = 0x3: signed WRITE();
   @count = 0x0: READ(PUBLISH(50 Hz));
}
"""


@pytest.fixture
def memory(tmp_path: Path) -> Path:
    path = tmp_path / "registers"
    path.write_bytes(bytes(4 * WORDS))
    return path


@pytest.fixture
def device(memory: Path) -> Iterator[Path]:
    """A process that plays the device on the file. It stops when word 4 says so."""
    process = subprocess.Popen([sys.executable, "-c", DEVICE, str(memory)], stdout=subprocess.PIPE)
    assert process.stdout is not None and process.stdout.readline() == b"ready\n"
    yield memory
    np.memmap(memory, dtype="<u4", mode="r+")[4] = 0xDEAD
    assert process.wait(30) == 0
    process.stdout.close()


@pytest.fixture
def link(memory: Path) -> Iterator[Link]:
    with connect(f"mmap:{memory}?base_hz=1000") as link:
        yield link


def test_words(link: Link, memory: Path) -> None:
    words = np.memmap(memory, dtype="<u4", mode="r+")
    words[:4] = 10, 11, 12, 13
    assert (link.read(2), link.read_many([3, 0]).tolist()) == (12, [13, 10])
    assert link.read_each([1]).tolist() == [11]
    assert link.read_many([0, 1, 2], atomic=True).tolist() == [10, 11, 12]
    link.write(7, 0xFFFFFFFF)
    link.write_many([8, 9], np.array([1, 2]))
    assert words[7:10].tolist() == [0xFFFFFFFF, 1, 2]
    with pytest.raises(ValueRangeError, match=r"a pair \(address, value\)"):
        link.exchange([8], [(8, 5), (9,)])  # type: ignore[list-item]
    assert link.exchange([8, 9], [(8, 3)]).tolist() == [3, 2]
    assert link.configuration.data_bits == 32 and link.configuration.address_bytes == 2
    assert link.statistics().requests == 9


def test_a_window_within_a_file(memory: Path) -> None:
    words = np.memmap(memory, dtype="<u4", mode="r+")
    words[100:103] = 1, 2, 3
    with connect(f"mmap:{memory}?offset=0x190&size=8&address_bytes=4") as link:
        assert link.read_many([0, 1]).tolist() == [1, 2] and link.configuration.address_bits == 32
        with pytest.raises(BusError, match="0x0002 is beyond the mapped memory, which has words 0 to ") as no:
            link.read(2)
        assert no.value.address == 2
        with pytest.raises(BusError):
            link.write(2, 0)
        with pytest.raises(BusError):
            link.read_many([0, 2])
        with pytest.raises(BusError):
            link.subscribe([2], divisor=1)
    assert words[102] == 3


def test_words_of_one_moment(device: Path) -> None:
    with connect(f"mmap:{device}") as link:
        link.write(5, 1)
        refused = 0
        for _ in range(300):
            try:
                count, complement = link.read_many([0, 1], atomic=True).tolist()
            except DeviceMismatch as error:
                assert "2 words changed during each of 8 readings" in str(error)
                refused += 1
            else:  # the device writes one after the other, so they are never more than one step apart
                assert (count + complement) & 0xFFFFFFFF in (0xFFFFFFFF, 0)
        assert refused < 300
        with pytest.raises(DeviceMismatch, match="by reading them twice, and these may not be"):
            link.read_many([0, 1], atomic=True, repeat=False)


def test_publishes_are_polled(link: Link, memory: Path) -> None:
    words = np.memmap(memory, dtype="<u4", mode="r+")
    words[:2] = 5, 6
    got: list[tuple[int, ...]] = []
    enough = threading.Event()
    with link.subscribe([1, 0], divisor=5) as fast, link.subscribe([0], divisor=20, group=9) as slow:
        assert (fast.group, slow.group) == (0, 9)
        with pytest.raises(DeviceMismatch, match="group 9 is in use"):
            link.subscribe([0], divisor=1, group=9)
        fast.on_publish(lambda time_s, row: (got.append(row), len(got) >= 3 and enough.set()))
        assert enough.wait(30) and slow.wait(30)
        times, values = slow.drain()
        assert len(times) == len(values) >= 1 and values[0].tolist() == [5] and got[0] == (6, 5)
    with pytest.raises(LinkClosed, match="the subscription is closed"):
        slow.wait(1)
    assert link.statistics().publishes >= 4
    with link.subscribe([0], divisor=1, ring=2) as short:
        while short.lost < 3:
            short.wait(30)
        assert short.available <= 2


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        ({"addresses": [0], "on_event": True}, DeviceMismatch),
        ({"addresses": [0]}, ValueRangeError),
        ({"addresses": [0], "divisor": 1 << 32}, ValueRangeError),
        ({"addresses": [0], "divisor": 1, "ring": 0}, ValueRangeError),
        ({"addresses": [], "divisor": 1}, ValueRangeError),
        ({"addresses": list(range(256)), "divisor": 1}, DeviceMismatch),
        ({"addresses": [0], "divisor": 1, "group": 256}, DeviceMismatch),
    ],
)
def test_groups_that_cannot_be(link: Link, arguments: dict[str, object], error: type[Exception]) -> None:
    with pytest.raises(error):
        link.subscribe(**arguments)  # type: ignore[arg-type]


def test_asyncio(link: Link) -> None:
    async def main() -> None:
        await link.write_async(3, 33)
        await link.write_many_async([4, 5], [44, 55])
        assert await link.read_async(3) == 33
        assert (await link.read_many_async([4, 5], atomic=True)).tolist() == [44, 55]
        with pytest.raises(BusError):
            await link.read_async(WORDS)
        with pytest.raises(ValueRangeError):
            await link.write_async(0, 1 << 32)
        rows = []
        with link.subscribe([3], divisor=2) as subscription:
            async for _, row in subscription:
                rows.append(row)
                if len(rows) == 3:
                    break
        assert rows == [(33,)] * 3

    asyncio.run(main())


def test_the_end(memory: Path) -> None:
    link = connect(f"mmap:{memory}")
    subscription = link.subscribe([0], divisor=1000000)
    waiter = threading.Thread(target=link.close)
    waiter.start()
    with pytest.raises(LinkClosed):
        subscription.wait(30)
    waiter.join()
    assert link.closed
    link.close()
    for call in (lambda: link.read(0), lambda: link.write(0, 0), lambda: link.read_many([0])):
        with pytest.raises(LinkClosed, match="the link is closed"):
            call()


def test_layer_4_works_unchanged(device: Path) -> None:
    result = compile_text(SPEC, "robot.ul")
    assert result.spec is not None, result.diagnostics
    with connect(f"mmap:{device}") as link:
        robot = load_spec_objects(result.spec, link)
        assert isinstance(robot, Node)
        sent, echo = robot["sent"], robot["echo"]
        assert isinstance(sent, WriteValue) and isinstance(echo, ReadValue)
        arrived = threading.Event()
        echo.on_change(lambda value: value == -5 and arrived.set())
        sent.write(-5)
        assert arrived.wait(30) and echo.read() == -5
        assert robot.snapshot()["echo"] == -5
        robot.stop_publishing()


@pytest.mark.parametrize(
    ("url", "error", "message"),
    [
        ("mmap:", UrlError, "the device file is missing, as in mmap:/dev/uio0"),
        (
            "mmap:{}?siz=4",
            UrlError,
            "siz means nothing to mapped memory.*offset, size, address_bytes, ",
        ),
        ("mmap:{}?crc=1", UrlError, "crc means nothing"),
        ("mmap:{}?size", UrlError, "'size' is not option=value"),
        ("mmap:{}?size=many", UrlError, "size=many is not a whole number"),
        ("mmap:{}?size=-4", UrlError, "size=-4 is not a whole number from 0 on"),
        ("mmap:{}?size=6", UrlError, "size 6 is no multiple of 4"),
        ("mmap:{}?offset=2", UrlError, "offset 2 is no multiple of 4"),
        ("mmap:{}?size=0", UrlError, "size is 0 bytes"),
        ("mmap:{}?size=8192", UrlError, "the window ends at byte 8192, and .* has 4096"),
        ("mmap:{}?offset=4096", UrlError, "has 4096 bytes, and offset is 4096"),
        ("mmap:{}?address_bytes=5", UrlError, "address_bytes is 5; choose 1 to 4"),
        ("mmap:{}?base_hz=0", UrlError, "base_hz is 0"),
        ("mmap:/dev/null", UrlError, "/dev/null does not report its size: add size="),
        ("mmap:/dev/null?size=4", DeviceMismatch, "/dev/null: cannot be mapped"),
        ("mmap:{}.none", LinkNotFound, "there is no such device or file"),
        ("mmap:/dev/uio99", LinkNotFound, "there is no such device or file"),
    ],
)
def test_urls_that_cannot_be(memory: Path, url: str, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        connect(url.format(memory))


def test_there_are_no_bytes(memory: Path) -> None:
    with pytest.raises(UrlError, match="has no bytes"), open_driver(f"mmap:{memory}"):
        pass


def test_a_forked_child_has_no_part_in_it(link: Link) -> None:
    with link.subscribe([0], divisor=1) as subscription:
        assert subscription.wait(30)
        child = os.fork()
        if not child:
            os._exit(0 if link.closed else 1)
        assert os.waitpid(child, 0)[1] == 0
        assert link.read(0) == 0
