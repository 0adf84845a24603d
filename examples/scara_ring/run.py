# SPDX-License-Identifier: BSD-3-Clause
"""A SCARA whose joints are nodes of a ring moves, loses a fibre on the way, stops, and goes on.

    python examples/scara_ring/run.py                           # five nodes of VHDL in one simulation
    python examples/scara_ring/run.py --twin                    # five twins
    python examples/scara_ring/run.py --picture scara_ring.svg  # with the positions and the cut
    python examples/scara_ring/run.py --link "serial:/dev/ttyUSB1?baud=3000000"  # cut it by hand

The exit code is 1 if a joint is not where it should be, if a motor is driven later than it may be after the
cut, or if a joint goes on while the fibre is cut.
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
from unitylink.protocol import CLOCK_HZ_DEFAULT
from unitylink.spec import load
from unitylink.spec.ring import ring_at

HERE = Path(__file__).resolve().parent
SPEC = HERE / "scara_ring.ul"
JOINTS = ("j1", "j2", "j3", "j4")
GATES = 4  # of a bridge
FIRST, SECOND = (0.8, -0.6, 0.4, 1.0), (-0.4, 0.5, -0.3, -0.8)  # rad
LIMIT = 0.3  # of the duty, so the joints turn at 1.5 rad/s
TOLERANCE = 0.005  # rad
STILL_S = 0.15  # the joints stand still
CARRIED = 32  # clocks, at most, from a node's words to its pins (docs/gateware/tosnet_carrier.md)
PATIENCE_S = 60.0  # for a slow simulator


@dataclass
class Run:
    """What the PC saw, with the times of the device in s."""

    seen: list[tuple[float, list[float]]] = field(default_factory=list)
    cut_s: float = 0.0
    offline_s: float = 0.0
    mended_s: float = 0.0
    safe_s: float | None = None  # from the cut until no gate of any motor is on


class Ring:
    """The robot and its link."""

    def __init__(self, link: Link) -> None:
        self.link = link
        spec = load(SPEC)
        self.robot: Any = load_spec_objects(spec, link)
        parts = [getattr(self.robot, name) for name in JOINTS]
        self.targets = ValueGroup([part.loop.target for part in parts], "targets")
        self.limits = ValueGroup([part.loop.limit for part in parts], "limits")
        self.loops = ValueGroup([part.loop.control for part in parts], "loops")
        self.motors = ValueGroup([part.motor.control for part in parts], "motors")
        self.positions = ValueGroup([part.shaft.position for part in parts], "positions")
        self.ring = ring_at(spec, 0)
        self.run = Run()

    def keep(self, time_s: float, values: Any) -> None:
        """Keep what a publish says."""
        self.run.seen.append((time_s, [float(values[f"{joint}.shaft.position"]) for joint in JOINTS]))

    def command(self, targets: tuple[float, ...]) -> None:
        """Send everything that a joint obeys. While the ring is not complete, try again."""
        end = time.monotonic() + PATIENCE_S
        while True:
            try:
                self.targets.write(list(targets))
                self.limits.write([LIMIT] * len(JOINTS))
                self.motors.write([{"enable": True, "coast": False}] * len(JOINTS))
                self.loops.write([{"enable": True}] * len(JOINTS))
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

    def bound_s(self) -> float:
        """Return the time in which the outputs are safe after a cut (docs/tosnet.md).

        These are two cycles, the watchdog, and the clocks from the ring to the pins. A simulation has a
        slower clock, and so a slower line. Its bits are as many.
        """
        line_hz, clock_hz = self.ring.baud_hz, CLOCK_HZ_DEFAULT
        if self.link.board is not None:
            clock_hz = self.link.board.configuration.clock_hz
        slower = max(1.0, line_hz / (clock_hz / 3))
        return slower * (2 * self.ring.shortest_s + self.ring.watchdog_s) + CARRIED / clock_hz

    def lose_a_fibre(self) -> None:
        """Cut a fibre and mend it, or wait for somebody who does."""
        board = self.link.board
        gates: list[Any] = []
        if board is None:
            print("cut a fibre, and mend it again", flush=True)
            self.run.cut_s = self.link.now_s()
        else:
            gates = [(board.components[f"{one}.motor"], bit) for one in JOINTS for bit in range(GATES)]
            for motor, bit in gates:
                motor.edges("pins", bit)  # from now on
            time.sleep(0.05)
            self.run.cut_s = self.link.now_s()
            cut_s = gates[0][0].time_s()
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
        if board is None:
            time.sleep(0.3)
        else:
            motor = gates[0][0]
            while motor.time_s() < cut_s + STILL_S:
                time.sleep(0.01)
            while motor.time_s() < cut_s + self.bound_s() and any(
                one.level("pins", bit) for one, bit in gates
            ):
                time.sleep(0.01)
            ends = [edges[-1][0] for motor, bit in gates if (edges := motor.edges("pins", bit))]
            on = any(motor.level("pins", bit) for motor, bit in gates)
            self.run.safe_s = float("inf") if on else max(0.0, max(ends) - cut_s)  # each was on before
            print(f"  all gates are off {1e3 * self.run.safe_s:.1f} ms after the cut", end="")
            print(f", and it may take {1e3 * self.bound_s():.1f} ms")
        self.run.mended_s = self.link.now_s()
        if board is not None:
            board.set_online(True)


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--link", metavar="URL", help="board to use, instead of a simulation")
    parser.add_argument("--twin", action="store_true", help="five twins, instead of five compiled designs")
    parser.add_argument("--picture", type=Path, metavar="FILE", help="draw the positions there (PNG, SVG)")
    options = parser.parse_args()
    kind = "sim" if options.twin else "rtl"
    with connect(options.link or f"{kind}:{SPEC}?plant={HERE / 'plant.py'}&timeout=2") as link:
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
    wrong = []
    if moved <= TOLERANCE:
        wrong.append("the joints went on while the fibre was cut")
    if ring.run.safe_s is not None and ring.run.safe_s > ring.bound_s():
        wrong.append("a motor was driven for too long after the cut")
    if max(first, second) > TOLERANCE:
        wrong.append("a joint is not at its target")
    for one in wrong:
        print(f"scara_ring: {one}", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    run_program(main, name="scara_ring")
