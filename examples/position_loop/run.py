# SPDX-License-Identifier: BSD-3-Clause
"""Hold an angle with a loop in the gateware, and give it other gains while it runs.

python examples/position_loop/run.py
python examples/position_loop/run.py --rtl
python examples/position_loop/run.py --link "serial:/dev/ttyUSB0?baud=3000000"
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import Any

from unitylink import connect
from unitylink.layer4_data import Node, load_spec_objects
from unitylink.program import run_program
from unitylink.spec import load

HERE = Path(__file__).resolve().parent
SPEC = HERE / "position_loop.ul"
SOFT = {"kp": 1.0, "ki": 4.0, "kd": 0.02}  # duty a rad, duty a rad and s, duty a rad/s
STIFF = {"kp": 3.0, "ki": 10.0, "kd": 0.06}
CLOSE = 0.015  # rad
PATIENCE_S = 20.0  # the compiled VHDL is slower than the board


def element(board: Node, path: str) -> Any:
    """Return a value of the board by its path."""
    return board[path]


def tune(board: Node, gains: dict[str, float]) -> None:
    """Write all gains. The loop takes them together, at its next period."""
    for name, value in gains.items():
        element(board, f"loop.{name}").write(value)
    element(board, "loop.apply").pulse()


def settle(board: Node, target: float) -> float | None:
    """Go to an angle. Return the angle at which the shaft came to rest, or None if it never did."""
    element(board, "loop.target").write(target)
    position, velocity = element(board, "shaft.position"), element(board, "shaft.velocity")
    end = time.monotonic() + PATIENCE_S
    while time.monotonic() < end:
        angle = position.read()
        if abs(angle - target) < CLOSE and abs(velocity.read()) < 0.2:
            return float(angle)
        time.sleep(0.005)
    return None


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--link", help="a board; without it a virtual one is used")
    parser.add_argument("--rtl", action="store_true", help="the virtual board runs the compiled VHDL")
    options = parser.parse_args()
    clock = "&clock_hz=4000000" if options.rtl else ""  # compiled VHDL is slow, and the loop needs 2.6 MHz
    url = options.link or f"{'rtl' if options.rtl else 'sim'}:{SPEC}?plant={HERE / 'plant.py'}{clock}"
    good = True
    with connect(url) as link:
        board = load_spec_objects(load(SPEC), link)
        element(board, "motor.control").write({"enable": True, "coast": False})
        element(board, "loop.error_limit").write(3.0)
        for name, gains, target in (("soft", SOFT, 1.0), ("stiff", STIFF, -0.5), ("stiff", STIFF, 1.5)):
            tune(board, gains)
            element(board, "loop.control").write({"enable": True})
            angle = settle(board, target)
            good = good and angle is not None
            rests = "did not come to rest" if angle is None else f"rests at {angle:+.3f} rad"
            print(f"{name} gains: target {target:+.1f} rad, the shaft {rests}")
        element(board, "loop.control").write({"enable": False})
        duty = element(board, "motor.duty").read()
        print(f"the loop is off: duty {duty:.1f}")
    return 0 if good and duty == 0 else 1


if __name__ == "__main__":
    run_program(main, name="position_loop")
