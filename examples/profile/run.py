# SPDX-License-Identifier: BSD-3-Clause
"""Write a table of set-points in one go, let the FPGA play it, and get every sample exactly once.

python examples/profile/run.py          # on a virtual board
python examples/profile/run.py --rtl    # on the VHDL itself, generated and hand-written, compiled

The exit code is 1 if a sample is missing or does not fit the axis.
"""

from __future__ import annotations

import argparse
import math
import queue
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from unitylink import Link, connect
from unitylink.generate import generate_vhdl
from unitylink.layer4_data import Node, PulseValue, ReadValue, ValueGroup, load_spec_objects
from unitylink.program import run_program
from unitylink.simulate.rtl import RtlBoard, RtlDesign, rtl_configuration
from unitylink.spec import Spec, load

HERE = Path(__file__).resolve().parent
SPEC = HERE / "profile.ul"
POINTS = 32
CURVES = {
    "a swing": [round(1000 * math.sin(2 * math.pi * n / POINTS)) for n in range(POINTS)],
    "a step": [800] * POINTS,
}
PATIENCE_S = 10.0


def play(board: Node) -> bool:
    """Play all curves. Return whether every sample came and is correct."""
    points, start, position = board["curve"], board["play"], board["samples.position"]
    assert isinstance(points, ValueGroup)
    assert isinstance(start, PulseValue) and isinstance(position, ReadValue)
    samples: queue.SimpleQueue[int] = queue.SimpleQueue()
    position.on_publish(lambda _, mrad: samples.put(mrad))
    good, expected = True, 0
    for name, curve in CURVES.items():
        points.write(curve)  # a burst and one commit, so the FPGA sees either the old table or the new one
        start.pulse()
        came = [samples.get(timeout=PATIENCE_S) for _ in range(POINTS)]
        due = []
        for goal in curve:
            expected += (goal - expected) >> 2
            due.append(expected)
        good = good and came == due
        print(f"{name}: {POINTS} points in one commit, {len(came)} samples")
        print("  " + "".join(picture(mrad) for mrad in came) + f"  from {min(came)} to {max(came)} mrad")
    board.stop_publishing()
    return good and samples.empty()


def picture(mrad: int) -> str:
    """Return a character whose height shows a position."""
    return "▁▂▃▄▅▆▇█"[min(7, max(0, (mrad + 1000) // 250))]


@contextmanager
def opened(url: str | None, spec: Spec) -> Iterator[Link]:
    """Open the board: a link URL, or None for the VHDL itself."""
    if url is not None:
        with connect(url) as link:
            yield link
        return
    configuration = rtl_configuration(spec)
    generated = generate_vhdl(spec, configuration)
    parts = [f"profile_{part}.vhd" for part in ("config_pkg", "user_pkg", "design")]
    files = {part: generated[f"vhdl/{part}"] for part in parts}
    files |= {name: (HERE / name).read_text() for name in ("profile_player.vhd", "profile_live.vhd")}
    design = RtlDesign("profile_live", files, generics={"clock_hz": configuration.clock_hz})
    with (
        RtlBoard(spec, design=design, configuration=configuration) as board,
        connect(f"{board.url}?timeout=1") as link,
    ):
        yield link


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    board = f"sim:{SPEC}?plant={HERE / 'plant.py'}&timeout=1"
    parser.add_argument("--link", default=board, metavar="URL", help="board to use")
    parser.add_argument("--rtl", dest="link", action="store_const", const=None, help="the VHDL, compiled")
    options = parser.parse_args()
    spec = load(SPEC)
    with opened(options.link, spec) as link:
        if not play(load_spec_objects(spec, link)):
            print("profile: the samples are not those of the curves", file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    run_program(main, name="profile")
