# SPDX-License-Identifier: BSD-3-Clause
"""Classic protocol, from base strobe to first bus strobe: the same time when idle, within the bound under
full load.

`-s` prints the table of docs/gateware/isochrony.md with the measured values beside it.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.gateware.strobes import Watch
from unitylink.simulate import BoardConfiguration
from unitylink.spec.isochrony import isochrony
from unitylink_lab.conformance.bench import bench

TICKS = 20
# times between base strobes as multiples of the bound, so that the load comes in other phases
PERIODS = (1.23, 1.31, 1.47)
NEAR = 16  # clocks; among so many ticks, the worst one comes so near to the bound
PAGE = Path(__file__).resolve().parents[2] / "docs" / "gateware" / "isochrony.md"

CONFIGURATIONS = {
    "8/32 bits, 2 groups of 16, RM 32": bench({}),
    "the same, requests first": bench({"PM": 1}),
    "8/32 bits, 16 groups of 16, RM 32": bench({"SG": 4}),
    "8/16 bits, 2 groups of 32, no RM": bench({"DW": 16, "SW": 5, "RMS": 0}),
    "32/32 bits, 4 groups of 8, RM 32": bench({"AW": 32, "SG": 2, "SW": 3}),
    "32/8 bits, 2 groups of 32, RM 8": bench({"AW": 32, "DW": 8, "SW": 5, "RMS": 8}),
}
SHORT = ("8/32 bits, 2 groups of 16, RM 32", "the same, requests first", "32/8 bits, 2 groups of 32, RM 8")
NAMES = [pytest.param(name, marks=() if name in SHORT else pytest.mark.long) for name in CONFIGURATIONS]


def crc8(covered: bytes) -> int:
    sum_ = 0
    for byte in covered:
        sum_ ^= byte
        for _ in range(8):
            sum_ = (sum_ << 1 ^ (0x07 if sum_ & 0x80 else 0)) & 0xFF
    return sum_


def request(letters: str, data: bytes) -> str:
    return f"${letters}:{data.hex()}*{crc8(letters.encode() + data):02x}\n"


def address(configuration: BoardConfiguration, value: int) -> bytes:
    return value.to_bytes(-(-configuration.address_bits // 8), "big")


def longest_request(configuration: BoardConfiguration, longest: str) -> str:
    """Return the request that is in the way for the longest time.

    It does not concern the group that publishes.
    """
    other = address(configuration, 0x10)
    last = configuration.groups - 1
    size = configuration.group_size
    match longest:
        case "RM":
            return request("RM", bytes([configuration.read_many]) + configuration.read_many * other)
        case "WSA":
            return request("WSA", bytes([last, size]) + size * other)
        case "RSI":
            return request("RSI", bytes([last]))
    raise AssertionError("a read is the longest message")


def delays(
    watch: Watch,
    configuration: BoardConfiguration,
    settings: str,
    period: int,
    load: str,
    **generics: int | str,
) -> list[int]:
    """Return the clocks from each base strobe but the first to the first bus strobe of the publish."""
    hz = configuration.clock_hz // period
    configuration = replace(configuration, base_hz=hz, bench_memory=False)
    quiet = ("quiet", 300)
    enable = [("send", "#EPC\n"), ("wait", 200)]
    steps = [("send", settings), quiet, *enable, ("send", load + "#DPS\n"), quiet]
    return watch.delays(configuration, steps, **generics)


@pytest.fixture
def watch(rtl: Any, tmp_path: Path) -> Watch:
    return Watch(rtl, tmp_path)


def settings_of(configuration: BoardConfiguration) -> str:
    size, last = configuration.group_size, configuration.groups - 1
    settings = request("WSA", bytes([0, 1]) + address(configuration, 0x77))
    if last:
        settings += request("WSA", bytes([last, size]) + size * address(configuration, 0x78))
    return settings + request("WSR", bytes([0]) + (1).to_bytes(configuration.rate_bytes, "big"))


@pytest.mark.parametrize("name", NAMES)
def test_idle_is_always_the_same(watch: Watch, name: str) -> None:
    configuration = CONFIGURATIONS[name]
    found = delays(watch, configuration, settings_of(configuration), 501, "\n" * 501 * 20)
    assert len(found) >= 18
    assert set(found) == {isochrony(configuration, protocol="classic").idle_clocks}


@pytest.mark.parametrize("name", NAMES)
def test_late_is_bounded_and_the_bound_is_near(watch: Watch, name: str) -> None:
    configuration = CONFIGURATIONS[name]
    result = isochrony(configuration, protocol="classic")
    load = longest_request(configuration, result.longest.name)
    cycle = max(result.longest.clocks, result.longest.characters, len(load))
    found: list[int] = []
    for part in PERIODS:
        period = round(part * result.late_clocks) + 100
        count = TICKS * period // cycle
        found += delays(watch, configuration, settings_of(configuration), period, load * count)
    late = max(found) - result.idle_clocks
    row = f"| {name} | {result.idle_clocks} | {result.longest.name} | {result.late_clocks} |"
    print(f"\n{row} {late} measured, {len(found)} ticks")
    assert min(found) >= result.idle_clocks
    assert result.late_clocks - NEAR <= late <= result.late_clocks


@pytest.mark.parametrize("load", ["#R:10\n", "#W:10DEADBEEF\n", "#RLC\n", "#R:zz\n", "$R:10*00\n", "#X\n"])
@pytest.mark.parametrize("mode", [1, 2])
def test_no_other_load_is_worse(watch: Watch, mode: int, load: str) -> None:
    configuration = bench({"PM": mode, "RMS": 0, "SW": 1})  # this configuration has the lowest bound
    result = isochrony(configuration, protocol="classic")
    found = delays(watch, configuration, settings_of(configuration), 301, load * 600)
    assert len(found) > 10
    assert max(found) <= result.bound_clocks


def test_a_publish_before_it(watch: Watch) -> None:
    """Two groups are due at once. The second one waits for a request and for the first group."""
    configuration = bench({})
    settings = request("WSA", bytes([0, 9]) + bytes([0x77] * 9)) + request("WSR", bytes([0, 0, 1]))
    settings += request("WSA", bytes([1, 16]) + bytes([0x78] * 16)) + request("WSR", bytes([1, 0, 1]))
    result = isochrony(configuration, protocol="classic", before=[16])
    load = longest_request(configuration, result.longest.name)
    period = (3 * result.late_clocks + 100) | 1
    found = delays(watch, configuration, settings, period, load * (40 * period // 272))
    assert max(found) - result.idle_clocks <= result.late_clocks
    assert max(found) - result.idle_clocks > isochrony(configuration, protocol="classic").late_clocks


def test_a_slow_line(watch: Watch) -> None:
    """A byte takes ten clocks, as on a UART at a fifth of the clock. Earlier bytes have to leave first."""
    configuration = replace(bench({"RMS": 8}), baud_hz=50_000_000)
    result = isochrony(configuration, protocol="classic")
    period = round(1.31 * result.late_clocks) + 400
    load = longest_request(configuration, result.longest.name) * (
        40 * period // (10 * result.longest.characters)
    )
    found = delays(watch, configuration, settings_of(configuration), period, load, byte_clocks=10)
    late = max(found) - result.idle_clocks
    assert result.late_clocks * 0.9 <= late <= result.late_clocks


def test_slow_slaves(watch: Watch) -> None:
    configuration = bench({"RMS": 8})
    result = isochrony(configuration, protocol="classic", bus_waits=9)
    load = longest_request(configuration, result.longest.name) * 120
    found: list[int] = []
    for period in (409, 421, 443):
        found += delays(watch, configuration, settings_of(configuration), period, load, bus_waits=9)
    late = max(found) - result.idle_clocks
    assert result.late_clocks - NEAR <= late <= result.late_clocks


def test_page_has_these_figures() -> None:
    page = PAGE.read_text(encoding="utf-8")
    rows = re.findall(r"^\| (.+?) \| (\d+) \| (\w+) \| (\d+) \|$", page, re.MULTILINE)
    expected = []
    for name, configuration in CONFIGURATIONS.items():
        result = isochrony(configuration, protocol="classic")
        expected.append((name, str(result.idle_clocks), result.longest.name, str(result.late_clocks)))
    assert rows == expected
