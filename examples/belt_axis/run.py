# SPDX-License-Identifier: BSD-3-Clause
"""Home a carriage on a belt, drive it with all the battery has, and turn it round.

python examples/belt_axis/run.py
python examples/belt_axis/run.py --rtl
python examples/belt_axis/run.py --link "serial:/dev/ttyUSB1?baud=1000000&deadman=0.2"

The exit code is 1 if the switch at home does not close.
"""

from __future__ import annotations

import argparse
import csv
import math
from pathlib import Path
from typing import Any

from unitylink import Link, connect
from unitylink.errors import UnityLinkError
from unitylink.layer4_data import load_spec_objects
from unitylink.program import run_program
from unitylink.simulate.machine import GEARS, MOTORS
from unitylink.spec import load

HERE = Path(__file__).resolve().parent
SPEC = HERE / "belt_axis.ul"
PERIOD_S, RUN_S, PATIENCE_S = 0.004, 0.4, 5.0
RADIUS_M, CARRIAGE_KG = 0.02, 1.5
MOTOR, GEAR = MOTORS["Pololu 37D 12 V"], GEARS["Pololu 37D 50:1"]


class Axis:
    """The carriage: it is driven by a share of the battery's voltage, and `rows` has what was seen."""

    def __init__(self, board: Any, link: Link) -> None:
        self._board, self._link = board, link
        self.rows: list[tuple[float, ...]] = []

    def drive(self, duty: float) -> None:
        self._board["motor.duty"].write(duty)
        self._board["motor.control"].write({"enable": duty != 0, "coast": False})

    def wait(self, seconds: float) -> None:
        """Wait, and keep a row for each period: time, position, speed, and where it really is."""
        end_s = self._link.now_s() + seconds
        while self._link.now_s() < end_s - PERIOD_S / 2:
            self._link.sleep_until(self._link.now_s() + PERIOD_S)
            plant = getattr(getattr(self._link, "board", None), "plant", None)
            true = (RADIUS_M * plant.motor.angle_rad,) if plant is not None else ()
            position, speed = self._board["shaft.position"].read(), self._board["shaft.velocity"].read()
            self.rows.append((self._link.now_s(), position, speed, *true))

    def home(self) -> None:
        """Drive back until the switch closes, and call this place 0."""
        self.drive(-0.4)
        due_s = self._link.now_s() + PATIENCE_S
        while not self._board["ends.levels"].read() & 1:
            if self._link.now_s() > due_s:
                raise UnityLinkError("the switch at home does not close; is its wire off, or the battery?")
            self._link.sleep_until(self._link.now_s() + PERIOD_S)
        self.drive(0.0)
        self._link.sleep_until(self._link.now_s() + 0.2)
        self._board["shaft.position"].write(0.0)


def expected(volts: float, seconds: float) -> float:
    """Return the speed that the datasheet promises, in m/s, so long after the start."""
    inertia = MOTOR.inertia_kg_m2 + CARRIAGE_KG * RADIUS_M**2 / GEAR.ratio**2
    time_s = MOTOR.resistance_ohm * inertia / MOTOR.constant**2
    most = (volts - MOTOR.resistance_ohm * MOTOR.no_load_current_ma / 1000) / MOTOR.constant
    return most / GEAR.ratio * RADIUS_M * (1 - math.exp(-seconds / time_s))


def table(seen: list[tuple[float, ...]], began_s: float, volts: float) -> list[tuple[float, ...]]:
    """Return the rows from 0 s on: time, position, speed, that of the datasheet, and the play in mm."""
    rows: list[tuple[float, ...]] = []
    for time_s, position, speed, *true in seen:
        at_s = time_s - began_s
        promised = expected(volts, at_s) if at_s < RUN_S else math.nan
        play = 1000 * (position - (true[0] - seen[0][3])) if true else math.nan
        rows.append((at_s, position, speed, promised, play))
    return rows


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    board_url = f"{SPEC}?plant={HERE / 'plant.py'}&time=lockstep&deadman=0.5"
    parser.add_argument("--link", metavar="URL", help="board to use; by default a virtual one")
    parser.add_argument("--rtl", action="store_true", help="let the virtual board be the compiled VHDL")
    parser.add_argument("--csv", type=Path, metavar="FILE", help="write what was seen")
    options = parser.parse_args()
    with connect(options.link or f"{'rtl' if options.rtl else 'sim'}:{board_url}") as link:
        board: Any = load_spec_objects(load(SPEC), link)
        axis = Axis(board, link)
        try:
            axis.home()
            rest_v = board["battery"].read()
            began_s = link.now_s()
            axis.drive(1.0)
            axis.wait(RUN_S)
            load_v, fast = board["battery"].read(), axis.rows[-1][2]
            axis.drive(-0.5)
            axis.wait(RUN_S)
        finally:
            axis.drive(0.0)
        print(f"the battery has {rest_v:.2f} V at rest, and {load_v:.2f} V while it drives")
        print(f"the carriage goes at {fast:.3f} m/s; without a load it would be {expected(load_v, 9.0):.3f}")
        if options.csv:
            with options.csv.open("w", newline="", encoding="utf-8") as file:
                rows = table(axis.rows, began_s, load_v)
                csv.writer(file, lineterminator="\n").writerows([f"{one:.4f}" for one in row] for row in rows)
    return 0


if __name__ == "__main__":
    run_program(main, name="belt_axis")
