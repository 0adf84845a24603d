# SPDX-License-Identifier: BSD-3-Clause
"""From base strobe to first bus strobe with the small engine: nearly the same time when idle, bounded under
load.

`-s` prints the rows of docs/gateware/isochrony.md with the measured values beside them.
"""

from __future__ import annotations

import re
from itertools import count
from pathlib import Path
from typing import Any

import pytest
from reference.host import ask, opening
from reference.small_engine import small_settings

from tests.gateware.small_core import core_of
from tests.gateware.strobes import PUBLISHED, Watch
from unitylink import protocol as p
from unitylink.simulate import BoardConfiguration
from unitylink.spec.isochrony import isochrony

PAGE = Path(__file__).resolve().parents[2] / "docs" / "gateware" / "isochrony.md"
NEAR = 0.7  # the least share of the bound that the worst of so few strobes must reach
SILENCE = 9000

# address and data bytes, groups, clocks of a byte on the line
CASES = {
    "16/32 bits": (2, 4, 2, 90),
    "8/8 bits, 166 clocks a byte": (1, 1, 2, 166),
}


def configuration(a: int, d: int, groups: int, byte_clocks: int) -> BoardConfiguration:
    return BoardConfiguration(
        address_bits=8 * a,
        data_bits=8 * d,
        engine="small",
        protocol="framed",
        publish_mode=2,
        lists=False,
        exchanges=0,
        window=8,
        groups=groups,
        group_size=5,
        request_max=p.SMALL_ENGINE_REQUEST_MAX,
        reply_max=p.SMALL_ENGINE_REPLY_MAX,
        credit=p.SMALL_ENGINE_CREDIT,
        cache_bytes=p.SMALL_ENGINE_CACHE_BYTES,
        baud_hz=0 if byte_clocks == 2 else 500_000_000 // byte_clocks,
    )


def delays(
    watch: Watch, period: int, shape: tuple[int, int, int, int], letters: str, rounds: int
) -> list[int]:
    """Return the clocks from each base strobe but the first to the first bus strobe of its publish.

    Meanwhile the host sends its load: C the longest request, P a post, - nothing for a while.
    """
    a, d, groups, byte_clocks = shape
    settings = small_settings(a, d, groups=groups, base_hz=50_000_000 // period)
    ids, posts = count(), count()

    def say(kind: int, *fields: tuple[int, int]) -> bytes:
        return ask(kind, (next(ids), 2), *fields)

    def message(letter: str) -> bytes:
        if letter == "-":
            return b"\0" * 200
        if letter == "P":
            return ask(p.REQUEST_KIND_POST, (next(posts), 2), (0, a), (0, d))
        registers = p.CONTROL_DEADMAN_TRIPS - p.CONTROL_FRAMES + 1
        return say(p.REQUEST_KIND_READ_CONTROL, (p.CONTROL_FRAMES, 2), (registers, 1))

    define = say(p.REQUEST_KIND_DEFINE_GROUP, (0, 1), (1, 4), (0, 1), (1, 1), (PUBLISHED, a))
    on = say(p.REQUEST_KIND_WRITE_CONTROL, (p.CONTROL_PUBLISH, 2), (1, 4))
    load = b"".join(map(message, letters * rounds))
    off = say(p.REQUEST_KIND_WRITE_CONTROL, (p.CONTROL_PUBLISH, 2), (0, 4))
    steps: list[tuple[str, Any]] = []
    for wire in (opening(), define, on, load + off):
        steps.append(("send", wire.decode("latin-1")))
        if wire is not on:
            steps.append(("quiet", SILENCE))
    made, generics = core_of(settings)
    return watch.delays(made, steps, byte_clocks=byte_clocks, **generics)


@pytest.mark.parametrize(("a", "d", "groups"), [(2, 4, 1), (1, 1, 6), (4, 4, 3)])
def test_idle_is_nearly_the_same(rtl: Any, tmp_path: Path, a: int, d: int, groups: int) -> None:
    shape = (a, d, groups, 2)
    found = delays(Watch(rtl, tmp_path, "small"), 3011, shape, "-", 600)
    least = isochrony(configuration(a, d, groups, 2)).idle_clocks
    print(f"\nidle, {groups} groups: {min(found)} to {max(found)}, told {least}")
    assert len(found) >= 18
    assert least <= min(found) <= least + 10
    assert max(found) <= least + p.SMALL_LATENCY_TICK_JITTER


@pytest.mark.parametrize("name", CASES)
def test_late_is_bounded_and_the_bound_is_near(rtl: Any, tmp_path: Path, name: str) -> None:
    shape = CASES[name]
    result = isochrony(configuration(*shape))
    found: list[int] = []
    watch = Watch(rtl, tmp_path, "small")
    for part, letters in ((1.13, "C"), (1.37, "CP")):
        period = round(part * result.late_clocks)
        rounds = 9 * period // result.late_clocks // len(letters) + 2
        found += delays(watch, period, shape, letters, rounds)
    late = max(found) - result.idle_clocks
    print(
        f"\n| {name} | {result.idle_clocks} | {result.longest.name} | {result.late_clocks} | {late} measured"
    )
    assert min(found) >= result.idle_clocks
    assert NEAR * result.late_clocks <= late <= result.late_clocks


def test_page_has_these_figures() -> None:
    rows = re.findall(
        r"^\| (.+?) \| (\d+) \| (\w+) \| (\d+) \| small \|$", PAGE.read_text("utf-8"), re.MULTILINE
    )
    expected = []
    for name, shape in CASES.items():
        result = isochrony(configuration(*shape))
        expected.append((name, str(result.idle_clocks), result.longest.name, str(result.late_clocks)))
    assert rows == expected
