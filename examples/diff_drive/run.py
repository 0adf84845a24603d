# SPDX-License-Identifier: BSD-3-Clause
"""Drive a square with a cart of two wheels, and compare its wheels with its gyroscope.

python examples/diff_drive/run.py
python examples/diff_drive/run.py --link "serial:/dev/ttyUSB1?baud=1000000&deadman=0.2"

The exit code is 1 if it does not come back to where it began.
"""

from __future__ import annotations

import argparse
import csv
import math
import sys
from pathlib import Path
from typing import Any

from cart import Cart

from unitylink import connect
from unitylink.layer4_data import load_spec_objects
from unitylink.program import run_program
from unitylink.spec import load

HERE = Path(__file__).resolve().parent
SPEC = HERE / "diff_drive.ul"
SIDE_M = 0.4
TOLERANCE_M = 0.05


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    board_url = f"sim:{SPEC}?plant={HERE / 'plant.py'}&deadman=0.5"
    parser.add_argument("--link", default=board_url, metavar="URL", help="board to use")
    parser.add_argument("--csv", type=Path, metavar="FILE", help="write the path")
    options = parser.parse_args()
    with connect(options.link) as link:
        board: Any = load_spec_objects(load(SPEC), link)
        cart = Cart(board, link)
        cart.start()
        print(
            f"the battery has {board['battery.value[0]'].read() / 1000:.2f} V, the gyroscope is off by "
            f"{cart.bias:.2f} deg/s"
        )
        try:
            for corner in range(4):
                cart.forward(SIDE_M, corner * math.pi / 2)
                cart.turn_to((corner + 1) * math.pi / 2)
                print(
                    f"corner {corner + 1}: at {cart.x_m:.3f}, {cart.y_m:.3f} m, "
                    f"heading {math.degrees(cart.heading):.1f} deg"
                )
        finally:
            cart.stop()
            board.stop_publishing()
        wheels = cart.wheels
        print(
            f"by the wheels alone it would be at {wheels.x_m:.3f}, {wheels.y_m:.3f} m, "
            f"heading {math.degrees(wheels.heading):.1f} deg"
        )
        true = cart.rows[-1][5:]
        if true:
            print(f"in truth it is at {true[0]:.3f}, {true[1]:.3f} m")
        if options.csv:
            began_s = cart.rows[0][0]
            with options.csv.open("w", newline="", encoding="utf-8") as file:
                rows = [[f"{number:.4f}" for number in (row[0] - began_s, *row[1:])] for row in cart.rows]
                csv.writer(file, lineterminator="\n").writerows(rows)
        missed_m = math.hypot(*(true or (cart.x_m, cart.y_m)))
        if missed_m > TOLERANCE_M:
            print(f"diff_drive: it is {missed_m:.3f} m off the place where it began", file=sys.stderr)
            return 1
        print(f"back, {1000 * missed_m:.0f} mm off the place where it began")
    return 0


if __name__ == "__main__":
    run_program(main, name="diff_drive")
