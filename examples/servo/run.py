# SPDX-License-Identifier: BSD-3-Clause
"""Sweep a servo, watch the wheel that it turns, and get the limit switch's events without polling.

python examples/servo/run.py
python examples/servo/run.py --link "serial:/dev/ttyUSB0?baud=1000000"
"""

from __future__ import annotations

import argparse
import sys
import threading
from pathlib import Path

from unitylink import Link, connect
from unitylink.layer4_data import Node, ReadValue, WriteValue, load_spec_objects
from unitylink.program import run_program
from unitylink.spec import load

HERE = Path(__file__).resolve().parent
SPEC = HERE / "servo.ul"
WIDTHS_US = (1500, 1800, 1200, 2400)  # the last one drives the wheel into its limit
TIME_S = 0.6  # for each move


def sweep(board: Node, link: Link) -> bool:
    """Move to all widths. Return whether the switch reported that the last move ended at the limit."""
    control, width_us = board["drive.control"], board["drive.width[0]"]
    position, trips = board["wheel.position"], board["trips"]
    assert isinstance(control, WriteValue) and isinstance(width_us, WriteValue)
    assert isinstance(position, ReadValue) and isinstance(trips, ReadValue)
    tripped = threading.Event()

    def tell(_: float, count: int) -> None:
        print(f"the limit switch has closed, {count} in all")
        tripped.set()

    trips.on_publish(tell)
    try:
        width_us.write(WIDTHS_US[0])
        control.write({"enable": True})
        for goal_us in WIDTHS_US:
            width_us.write(goal_us)
            # robot time, which on a real board is the time of this program
            link.sleep_until(link.now_s() + TIME_S)
            print(f"servo at {goal_us} us, wheel at {position.read()} counts")
        return tripped.wait(2.0)
    finally:
        control.write({"enable": False})  # no pulses: the servos go limp
        board.stop_publishing()


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    board = f"sim:{SPEC}?plant={HERE / 'plant.py'}"
    parser.add_argument("--link", default=board, metavar="URL", help="board to use")
    options = parser.parse_args()
    with connect(options.link) as link:
        if not sweep(load_spec_objects(load(SPEC), link), link):
            print("servo: the limit switch did not tell that it closed", file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    run_program(main, name="servo")
