# SPDX-License-Identifier: BSD-3-Clause
"""The shortest program: a spec, a link, values by name. No file is generated.

python examples/hello_led/run.py
python examples/hello_led/run.py --link "serial:/dev/ttyUSB0?baud=115200"
"""

from __future__ import annotations

import argparse
import queue
import sys
from pathlib import Path

from unitylink import connect
from unitylink.layer4_data import ReadValue, WriteValue, load_spec_objects
from unitylink.program import run_program
from unitylink.spec import load

SPEC = Path(__file__).resolve().with_name("hello_led.ul")


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--link", default=f"sim:{SPEC}", metavar="URL", help="board to use")
    options = parser.parse_args()
    with connect(options.link) as link:
        board = load_spec_objects(load(SPEC), link)
        led, buttons, uptime_ms = board["led"], board["buttons"], board["uptime_ms"]
        assert isinstance(led, WriteValue)
        assert isinstance(buttons, ReadValue) and isinstance(uptime_ms, ReadValue)
        for pattern in (0b0001, 0b0010, 0b0100):
            led.write(pattern)
            print(f"LEDs {pattern:04b}, up for {uptime_ms.read()} ms")
        pressed: queue.SimpleQueue[int] = queue.SimpleQueue()
        buttons.on_change(pressed.put)  # this starts the publishes of the spec
        try:
            print(f"buttons {pressed.get(timeout=2.0):04b}")
        except queue.Empty:
            print("the buttons were not published within 2 s", file=sys.stderr)
            return 1
        board.stop_publishing()
    return 0


if __name__ == "__main__":
    run_program(main, name="hello_led")
