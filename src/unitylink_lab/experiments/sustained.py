# SPDX-License-Identifier: BSD-3-Clause
"""Fig. 4 of the paper, measured: how many publishes a second the full stack takes without a loss.

The source is the twin. Its clock is so fast that it sets no limit. It publishes at a set rate over TCP on the
loopback. The receiver is layer 4, which keeps the values as usual.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import Any

from .publish_limits import framed_link_hz, link_hz

FACTORS = (1.0, 2.0)  # rates relative to the ideal link, tried in rising order while nothing is lost
LESS = (0.95, 0.7, 0.5, 0.25, 0.1)  # tried in falling order if publishes are lost even at the first rate
LINK_HZ = {"classic": link_hz, "framed": framed_link_hz}
_CLOCK_HZ = 1_000_000_000
_FRAME_BYTES_MOST = 1200  # holds 255 words in a long frame
PATIENCE_S = 0.5  # wait for the publishes that are still under way
IN_TIME = 0.95  # share of a rate that must come in real time, because the twin may be late


@dataclass(frozen=True)
class Sustained:
    """The highest tried rate that lost nothing. `factor` is its ratio to the rate of the ideal link.

    `more` says why the next higher rate failed: "stack" or "source". It is "" if none was tried.
    """

    protocol: str
    words: int
    factor: float
    rate_hz: float
    core: float  # processor time of source and stack together, divided by the time
    more: str


@dataclass(frozen=True)
class Trial:
    """The result of one rate. `complete` means that all publishes arrived, and at that rate."""

    complete: bool
    limit: str  # why a trial is not complete: "stack" or "source"
    rate_hz: float
    core: float


def sustained(protocol: str, words: int, *, window_s: float, tries: int = 3) -> Sustained:
    """Return the highest rate without a loss for messages of `words` words.

    A rate counts if one of `tries` windows was complete, because other work of the machine disturbs some
    windows.

    >>> sustained("framed", 16, window_s=0.05).words
    16
    """
    best, limit = Sustained(protocol, words, 0.0, 0.0, 0.0, "stack"), ""
    for factor in (*FACTORS, *LESS):
        if best.factor and (limit or factor < best.factor):
            break
        for _ in range(tries):
            trial = offer(protocol, words, factor * LINK_HZ[protocol](words), window_s=window_s)
            if trial.complete:
                best = Sustained(protocol, words, factor, trial.rate_hz, trial.core, "")
                break
        else:
            limit = trial.limit
    return replace(best, more=limit)


def offer(protocol: str, words: int, rate_hz: float, *, window_s: float) -> Trial:
    """Publish at a rate for a while, and see whether all of them arrive."""
    from unitylink import connect
    from unitylink.layer4_data import load_spec_objects
    from unitylink.simulate import Board

    spec, rate_hz = _spec(words), round(rate_hz)
    with (
        Board(configuration=_configuration(rate_hz), endpoint="tcp") as board,
        connect(f"{board.url}?protocol={protocol}&gateware=corrected&timeout=5") as link,
    ):
        tree = load_spec_objects(spec, link)
        with tree.record() as recording, tree.publishing():
            started_s, start, cpu = board.time_s, time.perf_counter(), time.process_time()
            time.sleep(window_s)
            due = rate_hz * (board.time_s - started_s)  # by the clock of the device
            patience = time.perf_counter() + PATIENCE_S
            while (taken := _taken(tree))[0] < due and time.perf_counter() < patience:
                time.sleep(0.001)
            wall_s, cpu = time.perf_counter() - start, time.process_time() - cpu
        kept = len(recording.series("w0")[0])
        missing = link.statistics().missing_publishes
    received_hz = taken[0] / wall_s
    arrived = taken[0] >= due and taken[1] == 0 and missing == 0 and kept >= taken[0]
    in_time = received_hz >= IN_TIME * rate_hz
    return Trial(arrived and in_time, "source" if arrived else "stack", received_hz, cpu / wall_s)


def _taken(tree: Any) -> tuple[int, int]:
    reports = tree.publisher.reports()
    return sum(report.received for report in reports), sum(report.lost for report in reports)


def _spec(words: int) -> Any:
    from unitylink.spec import compile_text

    lines = "".join(f'   @w{n} = {n:#x}: READ(ID="w{n}", PUBLISH(1,1));\n' for n in range(words))
    spec = compile_text(f"link plain;\npublic many() {{\n{lines}}}\n".encode(), "many.ul").spec
    assert spec is not None
    return spec


def _configuration(base_hz: int) -> Any:
    from unitylink.interface.board_configuration import BoardConfiguration

    return BoardConfiguration(
        address_bits=16,
        clock_hz=_CLOCK_HZ,
        base_hz=base_hz,
        groups=1,
        group_size=255,
        request_max=_FRAME_BYTES_MOST,
        reply_max=_FRAME_BYTES_MOST,
        credit=0xFFFF,
        long_frames=True,
    )
