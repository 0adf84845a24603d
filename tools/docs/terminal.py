# SPDX-License-Identifier: BSD-3-Clause
"""Draw the picture of docs/terminal.md:  python tools/docs/terminal.py [--check] [--record]

The values are those of docs/images/terminal.csv, which `--record` records again: the SCARA of
examples/dashboard, while it moves. The same table gives the same bytes, and --check compares.
"""

from __future__ import annotations

import asyncio
import csv
import os
import re
import sys
import time
from typing import Any, cast

import numpy as np
from made_files import ROOT, parser_of, write_or_compare

from unitylink import Link, connect
from unitylink.commands.terminal.app import Screen
from unitylink.commands.terminal.controls import Controls
from unitylink.dashboard.feed import Feed, Track
from unitylink.layer2_message import Statistics
from unitylink.layer4_data import Node, load_spec_objects
from unitylink.simulate import Board, BoardConfiguration
from unitylink.spec import load

SPEC = ROOT / "examples" / "dashboard" / "arm.ul"
IMAGES = ROOT / "docs" / "images"
PICTURE, TABLE = IMAGES / "terminal.svg", IMAGES / "terminal.csv"
SIZE = (80, 24)
SECONDS, PERIOD_S = 20.0, 0.1
# of each joint: middle, half of the way, s of a cycle
WAYS = {"j1": (0, 60, 8), "j2": (40, 50, 5), "j3": (60, 40, 6), "j4": (0, 170, 12)}
FACTS = ("round_trip_s", "received", "asked_hz")  # of the link
CHARTS = ("j1.cpos", "j2.cpos")
_FONT = re.compile(r"\s*@font-face \{.*?\}", re.S)  # from a network
_EMPTY = re.compile(r"[ \t]+$", re.M)


def record() -> None:
    """Let the robot move, and keep its values."""
    with connect(f"sim:{SPEC}?plant=scara") as link, TABLE.open("w", encoding="utf-8", newline="") as file:
        robot = load_spec_objects(load(SPEC), link)
        reads = [value for value in robot if value.access == "READ"]
        writes: dict[str, float] = {"lamp": 1, "grip": 1} | {f"{joint}.spd_sp": 200 for joint in WAYS}
        writes |= {f"{joint}.pos_sp": middle for joint, (middle, _, _) in WAYS.items()}
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["time_s", *FACTS, *(value.path for value in reads), *writes])
        begin_s = link.now_s()
        with robot.publishing():
            while (since_s := link.now_s() - begin_s) < SECONDS:
                for joint, (middle, half, cycle_s) in WAYS.items():
                    way = half * float(np.sin(2 * np.pi * since_s / cycle_s))
                    writes[f"{joint}.pos_sp"] = round(middle + way, 2)
                for path, value in writes.items():
                    cast(Any, robot[path]).write(value)
                asked_s = time.monotonic()
                link.read(reads[0].address)
                facts = [f"{time.monotonic() - asked_s:.6f}"]
                reports = robot.publisher.reports()
                facts += [str(sum(one.received for one in reports)), str(sum(one.rate_hz for one in reports))]
                sampled = robot.snapshot()
                values = [*(sampled[value.path] for value in reads), *writes.values()]
                table.writerow([f"{since_s:.3f}", *facts, *values])
                link.sleep_until(begin_s + since_s + PERIOD_S)


class Recorded:
    """The link, the feed and the controls of the moment at which the table ends."""

    url, up, trouble, closed = "sim:arm.ul", True, "", False
    stopped_by, stopping, round = "", False, 1
    notes = (
        (0.0, "you have control of j1"),
        (4.0, "j1.spd_sp = 200"),
        (9.0, "j2.spd_sp: take control of j2 first (key t)"),
    )

    def __init__(self, robot: Node) -> None:
        self.tracks = [Track(value) for value in robot]
        with TABLE.open(encoding="utf-8") as file:
            names, *rows = csv.reader(file)
        columns = dict(zip(names, np.array(rows, float).T, strict=True))
        times_s = columns["time_s"]
        self._now_s = float(times_s[-1]) + 0.04
        self._asked_hz, self._round_trip_s = (
            float(columns["asked_hz"][-1]),
            float(columns["round_trip_s"][-1]),
        )
        self.came_hz = float(np.diff(columns["received"][[-11, -1]])[0] / np.diff(times_s[[-11, -1]])[0])
        for track in self.tracks:
            if (values := columns.get(track.value.path)) is not None:
                track.history.add(times_s, values)
                whole = track.value.codec.quantity.type.kind in ("bool", "enum")
                track.raw = track.value.codec.encode(int(values[-1]) if whole else float(values[-1]))
                track.rate_hz = 1 / PERIOD_S

    def now_s(self) -> float:
        return self._now_s

    def statistics(self) -> Statistics:
        return Statistics(**dict.fromkeys(Statistics.__dataclass_fields__, 0))

    def gather(self) -> int:
        return 1

    def reports(self) -> list[dict[str, Any]]:
        return [{"received": 0, "rate_hz": self._asked_hz, "lost": 0}]

    def round_trip_s(self) -> float | None:
        return self._round_trip_s

    def control(self) -> dict[str, str]:
        return {"j1": "ana"}

    def alive(self) -> None: ...

    def stop(self) -> None: ...


def draw() -> str:
    """Return the screen as SVG."""
    os.environ.pop("NO_COLOR", None)
    os.environ["TZ"] = "UTC"
    time.tzset()
    spec = load(SPEC)
    with Board(spec, configuration=BoardConfiguration.for_spec(spec)) as board, connect(board.url) as link:
        robot = load_spec_objects(spec, link)
        moment = Recorded(robot)
        there: Any = moment
        screen = Screen(cast(Link, there), spec.roots[0], robot, cast(Feed, there), cast(Controls, there))

        async def run() -> str:
            async with screen.run_test(size=SIZE) as pilot:
                for path in CHARTS:
                    screen.table.cursor = [row.path for row in screen.table.open_rows()].index(path)
                    await pilot.press("c")
                screen.health.came_hz = moment.came_hz
                await screen.workers.wait_for_complete()  # which have measured the round trip
                screen.redraw()
                await pilot.pause()
                return screen.export_screenshot(title="unitylink tui sim:arm.ul")

        return _EMPTY.sub("", _FONT.sub("", asyncio.run(run()))) + "\n"


def main() -> int:
    """Write the picture, or compare it with the file."""
    parser = parser_of("Draw the picture of docs/terminal.md.")
    parser.add_argument("--record", action="store_true", help="record docs/images/terminal.csv anew first")
    given = parser.parse_args()
    if given.record:
        record()
    return write_or_compare({PICTURE: draw()}, check=given.check)


if __name__ == "__main__":
    sys.exit(main())
