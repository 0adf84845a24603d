# SPDX-License-Identifier: BSD-3-Clause
"""A recording has the set-points beside the published values, each with the time of its write."""

from __future__ import annotations

import pytest

from unitylink import Link
from unitylink.errors import UnknownName
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board, LoopbackPlant
from unitylink.spec import compile_text

SPEC = compile_text(
    """public two() {
   @a = 0x10: i16 WRITE(SCALE=0.5);
   @b = 0x11: i16 WRITE();
   @never = 0x12: i16 WRITE();
   @both = 0x13: i16 READWRITE();
   @shown = 0x14: i16 READWRITE(PUBLISH(100 Hz));
}""",
    "two.ul",
).spec


def test_set_points_are_recorded() -> None:
    with Board(SPEC, plant=LoopbackPlant()) as board, Link(board.url) as link:
        robot = load_spec_objects(SPEC, link)
        robot["a"].write(-1.5)
        with robot.record() as recording:
            before_s = link.now_s()
            robot["a"].write(2)
            robot["a"].write(3)
            robot["b"].write(4)
            robot["both"].write(5)
            with robot.cycle() as cycle:
                cycle(a=6, b=7, never=0, both=8, shown=9)
            after_s = link.now_s()
        robot["a"].write(100)
        times_s, numbers = recording.series("a")
        assert numbers.tolist() == [-1.5, 2, 3, 6]
        assert times_s[0] <= before_s <= times_s[1] <= times_s[2] <= times_s[3] <= after_s
        assert recording.series("b")[1].tolist() == [4, 7]
        assert recording.series("both")[1].tolist() == [5, 8]
        with pytest.raises(UnknownName, match="nor written"):
            recording.series("shown")  # it would be there as it is published, but nothing was published
