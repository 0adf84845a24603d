# SPDX-License-Identifier: BSD-3-Clause
"""The device from Python: after any bytes it still answers, and its answers do not depend on the pieces."""

from __future__ import annotations

from effort import many
from hypothesis import given, settings
from hypothesis import strategies as st

from unitylink._native import Device
from unitylink.simulate import BoardConfiguration

QUIET = BoardConfiguration(address_bits=16, publish_mode=0)
ALPHABET = b"##$$%&:*\n\r 0123456789abcdefABCDEFRWMSILCrwm,.?!\xff\x00"
MESSAGES = (b"#R:0012\n", b"$RLC*9B\n", b"#RM:0200100011\n", b"#W:0020DEADBEEF\n", b"#RX\n")


def answer(device: Device, data: bytes, clocks: int = 200_000) -> bytes:
    assert device.receive(data) == len(data)
    device.run_until(device.clock + clocks)
    return device.take()


def in_order(output: bytes) -> tuple[bytes, bytes]:
    """Return replies and datalink errors, each in order.

    Which of the two comes first depends on the timing.
    """
    lines = output.splitlines(keepends=True)
    return b"".join(x for x in lines if x[:1] != b"?"), b"".join(x for x in lines if x[:1] == b"?")


noise = st.lists(
    st.one_of(
        st.sampled_from(MESSAGES), st.sampled_from([bytes([b]) for b in ALPHABET]), st.binary(max_size=4)
    ),
    max_size=60,
).map(b"".join)


@settings(max_examples=many(150), deadline=None)
@given(noise, st.lists(st.integers(1, 9), min_size=1))
def test_any_bytes_in_any_pieces(data: bytes, sizes: list[int]) -> None:
    whole, pieces = Device(QUIET), Device(QUIET)
    once = answer(whole, data)
    out, at, turn = b"", 0, 0
    while at < len(data):
        size = sizes[turn % len(sizes)]
        out += answer(pieces, data[at : at + size], 37 * size)
        at, turn = at + size, turn + 1
    out += answer(pieces, b"")
    assert in_order(out) == in_order(once)
    answer(whole, b"\n\0")  # ends whatever message or frame was open
    assert answer(whole, b"#R:1234\n") == b"#S_R:00000000\n" or b"W" in data.upper()


def test_clock_and_times_are_exact() -> None:
    device = Device(BoardConfiguration(bench_memory=True))
    device.receive(b"#R:12\n")
    device.run_until(100)
    timed = device.take_timed()
    assert bytes(byte for _, byte in timed) == b"#S_R:40de1212\n"
    assert (timed[0][0], timed[-1][0]) == (23, 53)
    assert device.next_event is None
    assert device.last_activity == 53


def test_get_and_set() -> None:
    device = Device(BoardConfiguration())
    assert device.set(0x10, 77)
    assert answer(device, b"#R:10\n") == b"#S_R:0000004d\n"
    assert device.get(0x10) == 77
    assert device.get(0x100) is None
    assert not device.set(0x100, 1)
