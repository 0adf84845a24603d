# SPDX-License-Identifier: BSD-3-Clause
"""A SCARA whose joints are nodes of a ring moves, loses a fibre on the way, stops, and goes on.

    python examples/scara_ring/run.py                           # five nodes of VHDL in one simulation
    python examples/scara_ring/run.py --picture scara_ring.svg  # with the positions and the cut
    python examples/scara_ring/run.py --link "serial:/dev/ttyUSB1?baud=3000000"  # cut it by hand

The exit code is 1 if a joint is not where it should be, or if it goes on while the fibre is cut.
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from unitylink import Link, connect
from unitylink.errors import NetworkOffline
from unitylink.layer4_data import ValueGroup, load_spec_objects
from unitylink.program import run_program
from unitylink.spec import load

HERE = Path(__file__).resolve().parent
SPEC = HERE / "scara_ring.ul"
FIRST, SECOND = (0.8, -0.6, 0.4, 1.0), (-0.4, 0.5, -0.3, -0.8)  # rad
SPEED_LIMIT = 1.0  # rad/s
TOLERANCE = 0.005  # rad
PATIENCE_S = 60.0  # for a slow simulator


@dataclass
class Run:
    """What the PC saw, with the times of the device in s."""

    seen: list[tuple[float, list[float]]] = field(default_factory=list)
    cut_s: float = 0.0
    offline_s: float = 0.0
    mended_s: float = 0.0


class Ring:
    """The robot and its link."""

    def __init__(self, link: Link) -> None:
        self.link = link
        self.robot: Any = load_spec_objects(load(SPEC), link)
        parts = (self.robot.j1, self.robot.j2, self.robot.j3, self.robot.j4)
        self.targets = ValueGroup([part.target for part in parts], "targets")
        self.limits = ValueGroup([part.speed_limit for part in parts], "speed limits")
        self.positions = ValueGroup([part.position for part in parts], "positions")
        self.run = Run()

    def keep(self, time_s: float, values: Any) -> None:
        """Keep what one cycle has published."""
        joints = ("j1", "j2", "j3", "j4")
        self.run.seen.append((time_s, [float(values[f"{joint}.position"]) for joint in joints]))

    def command(self, targets: tuple[float, ...]) -> None:
        """Send targets and speed limits. While the ring is not complete, try again."""
        end = time.monotonic() + PATIENCE_S
        while True:
            try:
                self.limits.write([SPEED_LIMIT] * 4)
                self.targets.write(list(targets))
            except NetworkOffline:
                if time.monotonic() > end:
                    raise
                time.sleep(0.01)
            else:
                return

    def off(self, targets: tuple[float, ...]) -> float:
        """Return how far the worst joint is off, in rad."""
        at = list(self.positions.snapshot().values())
        return max(abs(float(have) - want) for have, want in zip(at, targets, strict=True))

    def reach(self, targets: tuple[float, ...]) -> float:
        """Wait until all joints are there, and return how far the worst is off."""
        end = time.monotonic() + PATIENCE_S
        while (off := self.off(targets)) > TOLERANCE and time.monotonic() < end:
            time.sleep(0.02)
        return off

    def lose_a_fibre(self) -> None:
        """Cut a fibre and mend it, or wait for somebody who does."""
        board = self.link.board
        self.run.cut_s = self.link.now_s()
        if board is None:
            print("cut a fibre, and mend it again", flush=True)
        else:
            board.set_online(False)
        end = time.monotonic() + PATIENCE_S
        while True:
            try:
                self.targets.write(list(SECOND))
            except NetworkOffline as error:
                self.run.offline_s = self.link.now_s()
                print(f"  a write says: {error}")
                break
            if time.monotonic() > end:
                raise TimeoutError("nobody cut a fibre")
        time.sleep(0.3)  # the joints stand still
        self.run.mended_s = self.link.now_s()
        if board is not None:
            board.set_online(True)


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    url = f"rtl:{SPEC}?plant={HERE / 'plant.py'}&timeout=2"
    parser.add_argument("--link", default=url, metavar="URL", help="board to use")
    parser.add_argument("--picture", type=Path, metavar="FILE", help="draw the positions there (PNG, SVG)")
    options = parser.parse_args()
    with connect(options.link) as link:
        ring = Ring(link)
        stop = ring.robot.on_publish(ring.keep)
        with ring.robot.publishing():
            ring.command(FIRST)
            first = ring.reach(FIRST)
            print(f"all joints are at their first target, {first * 1e3:.1f} mrad off at most")
            ring.command(SECOND)
            time.sleep(0.3)
            ring.lose_a_fibre()
            moved = ring.off(SECOND)
            print(f"the ring is offline {1e3 * (ring.run.offline_s - ring.run.cut_s):.0f} ms after the cut")
            ring.command(SECOND)
            second = ring.reach(SECOND)
            print(f"mended: all joints are at their second target, {second * 1e3:.1f} mrad off at most")
        stop()
    if options.picture is not None:
        import picture

        picture.save(ring.run, options.picture)
        print(f"  {options.picture}")
    stopped = moved > TOLERANCE
    if not stopped:
        print("scara_ring: the joints went on while the fibre was cut", file=sys.stderr)
    if max(first, second) > TOLERANCE:
        print("scara_ring: a joint is not at its target", file=sys.stderr)
    return 0 if stopped and max(first, second) <= TOLERANCE else 1


if __name__ == "__main__":
    run_program(main, name="scara_ring")
