# SPDX-License-Identifier: BSD-3-Clause
"""The bench of the recordings, around the twin: its generics, its steps, and the rules that compare two
responses.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from unitylink.errors import UnityLinkError

if TYPE_CHECKING:
    from unitylink._native import Device
    from unitylink.simulate import BoardConfiguration

# The names of the generics in the recordings, and their defaults.
_DEFAULTS = {
    "AW": 8,
    "DW": 32,
    "FREQ": 1000,
    "SG": 1,
    "SW": 4,
    "RMS": 32,
    "RB": 2,
    "PM": 2,
    "PHYFIFO": 0,
    "CK": 2,
    "FULL": 1,
    "RLC": 1,
    "IRQEDGE": 0,
}
RULES = ("exact", "rate", "any_count")
STEPS = ("send", "wait", "quiet", "events", "rx_error")
CLOCKS_MOST = 10_000_000  # limit of one step: a recording that waits longer is a mistake


# A player takes the generics of a run and the steps of its exchanges. It does them in order from reset. It
# returns the bytes that the device sent during each exchange.
Player = Callable[["BoardConfiguration", Sequence[Sequence[tuple[str, Any]]]], list[bytes]]


class RecordingError(UnityLinkError):
    """The file does not hold recorded exchanges. The message names the place in the file."""


def bench(generics: dict[str, Any], place: str = "config") -> BoardConfiguration:
    """Return the bench of the recordings. `generics` has the names of the recordings (AW, DW, FREQ …)."""
    from unitylink.simulate import BoardConfiguration

    unknown = sorted(set(generics) - set(_DEFAULTS)) if isinstance(generics, dict) else ["(not an object)"]
    if unknown or not all(type(value) is int for value in generics.values()):
        raise RecordingError(f"{place}: config {', '.join(unknown) or generics!r} is not understood")
    g = {**_DEFAULTS, **generics}
    if not (1 <= g["AW"] <= 32 and 0 <= g["SG"] <= 8 and 0 <= g["SW"] <= 7 and g["IRQEDGE"] >= 0):
        raise RecordingError(f"{place}: config {generics!r} is out of range")
    shift = (-(-g["AW"] // 8) - 1) * 8  # the top byte of the padded address says who answers
    highest = (1 << g["AW"]) - 1

    def top_bytes(first: int, last: int) -> tuple[tuple[int, int], ...]:
        low, high = first << shift, min(highest, (last + 1 << shift) - 1)
        return ((low, high),) if low <= highest else ()

    return BoardConfiguration(
        address_bits=g["AW"],
        data_bits=g["DW"],
        base_hz=g["FREQ"],
        groups=1 << g["SG"],
        group_size=1 << g["SW"],
        read_many=g["RMS"],
        rate_bytes=g["RB"],
        publish_mode=g["PM"],
        fifo_latency=2 if g["PHYFIFO"] else 0,
        datalink="full" if g["FULL"] else "lite",
        checksum={0: "none", 1: "xor"}.get(g["CK"], "crc8"),
        configuration_command=bool(g["RLC"]),
        edge_events=tuple(group for group in range(1 << g["SG"]) if g["IRQEDGE"] >> group & 1),
        bench_memory=True,
        bus_error_ranges=top_bytes(0xE0, 0xEF),
        silent_ranges=top_bytes(0xF0, 0xFF),
    )


def play_on_twin(
    configuration: BoardConfiguration, exchanges: Sequence[Sequence[tuple[str, Any]]]
) -> list[bytes]:
    """Play the exchanges of one run to a twin."""
    from unitylink._native import Device

    device = Device(configuration)
    return [b"".join(run_step(device, kind, argument) for kind, argument in steps) for steps in exchanges]


def run_step(device: Device, kind: str, argument: Any) -> bytes:
    """Do one step and return the bytes that the device sent meanwhile."""
    sent = b""
    if kind == "send":
        data = argument.encode("latin-1")
        while data or not device.input_empty:
            data = data[device.receive(data) :]
            device.run_until(max(device.clock, device.next_event or device.clock + 1))
            sent += device.take()
    elif kind == "wait":
        device.run_until(device.clock + argument)
    elif kind == "quiet":
        start, limit = device.clock, device.clock + CLOCKS_MOST
        while device.clock < (until := max(start, device.last_activity) + argument) and device.clock < limit:
            device.run_until(until)
    elif kind == "events":
        device.run_until(device.clock + 1)
        device.set_events(argument)
    else:
        device.receive_error(argument)
        device.run_until(device.clock + 1)
    return sent + device.take()


def same(rule: str, expected: str, got: str) -> bool:
    """Compare two responses by the `compare` rule of a recording.

    >>> same("rate", "#S_EPS\\n%PUB:00\\n", "#S_EPS\\n%PUB:00\\n%PUB:00\\n")
    True
    """
    if rule == "exact":
        return expected == got
    replies, publishes = _split(expected)
    got_replies, got_publishes = _split(got)
    if replies != got_replies:
        return False
    if rule == "rate":
        shorter, longer = sorted((publishes, got_publishes), key=len)
        return longer[: len(shorter)] == shorter and len(longer) - len(shorter) <= 1
    return bool(publishes) and bool(got_publishes) and len({*publishes, *got_publishes}) == 1


def _split(response: str) -> tuple[list[str], list[str]]:
    lines = response.splitlines(keepends=True)
    return [line for line in lines if line[0] not in "%&"], [line for line in lines if line[0] in "%&"]
