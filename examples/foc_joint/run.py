# SPDX-License-Identifier: BSD-3-Clause
"""Turn a joint with a brushless motor from angle to angle, by loops in the gateware.

python examples/foc_joint/run.py
python examples/foc_joint/run.py --link "serial:/dev/ttyUSB1?baud=3000000&deadman=0.05"

The exit code is 1 if it is not at an angle when it says so.
"""

from __future__ import annotations

import argparse
import csv
import sys
from pathlib import Path
from typing import Any

from joint import NM_A_AMPERE, Joint

from unitylink import connect
from unitylink.layer4_data import load_spec_objects
from unitylink.program import run_program
from unitylink.spec import load

HERE = Path(__file__).resolve().parent
SPEC = HERE / "foc_joint.ul"
ANGLES = (1.5, -0.8, 0.6, 0.0)  # rad
TOLERANCE = 0.01


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    board_url = f"sim:{SPEC}?plant={HERE / 'plant.py'}&deadman=0.5"
    parser.add_argument("--link", default=board_url, metavar="URL", help="board to use")
    parser.add_argument("--csv", type=Path, metavar="FILE", help="write angles and currents")
    options = parser.parse_args()
    worst = 0.0
    with connect(options.link) as link:
        board: Any = load_spec_objects(load(SPEC), link)
        joint = Joint(board, link)
        joint.tune()
        try:
            print(f"the rotor has turned to its zero, with {joint.start():.2f} A along its field")
            for angle in ANGLES:
                at = joint.go_to(angle)
                worst = max(worst, abs(at - angle))
                torque = NM_A_AMPERE * joint.seen["loop.current_q"]
                print(f"at {at:.4f} rad, where {angle:g} was wanted, held with {torque:.3f} N m")
        finally:
            joint.stop()
            board.stop_publishing()
    if options.csv:
        began_s = joint.rows[0][0]
        with options.csv.open("w", newline="", encoding="utf-8") as file:
            rows = [[f"{number:.4f}" for number in (row[0] - began_s, *row[1:])] for row in joint.rows]
            csv.writer(file, lineterminator="\n").writerows(rows)
    if worst > TOLERANCE:
        print(f"foc_joint: it is {worst:.3f} rad off its target", file=sys.stderr)
        return 1
    print("all angles are reached, and the bridge is off")
    return 0


if __name__ == "__main__":
    run_program(main, name="foc_joint")
