# SPDX-License-Identifier: BSD-3-Clause
"""Time in steps: how many seconds of a robot fit into one of this machine, while a program controls it.

The robot is the SCARA with its plant. In each step of a millisecond, Python reads the positions of all joints
as one snapshot, and writes all set-points as one group. Steps without the program show what plant and board
take by themselves.
"""

from __future__ import annotations

import time
from math import sin
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any

from .figure import Figure, Run

STEPS, ROUNDS, DT_S = 300, 11, 0.001
BOARDS, BOARD_STEPS = 64, 1920

_CART = """
public cart() {
   @position = 0x10: i32 READ(UNIT="m", SCALE=0.0001);
   @force = 0x20: i16 WRITE(UNIT="N", SCALE=0.01, MIN=-5, MAX=5, SAFE=0);
}
"""


def _measure(run: Run, name: str, scheme: str, limit: float, title: str) -> Figure:
    from unitylink import connect
    from unitylink.layer4_data import ValueGroup, load_spec_objects
    from unitylink.spec import load

    file = run.checkout / "examples" / "scara" / "scara.ul"
    with connect(f"{scheme}:{file}?plant=scara", time="lockstep") as link:
        robot: Any = load_spec_objects(load(file), link)
        joints = (robot.j1, robot.j2, robot.j3, robot.j4)
        positions = ValueGroup([joint.cpos for joint in joints], "positions")
        set_points = ValueGroup([joint.pos_sp for joint in joints], "set-points")
        ValueGroup([joint.spd_sp for joint in joints], "speed limits").write([20_000] * len(joints))
        begun_s, moved = link.now_s(), 0

        def alone() -> None:
            link.step(DT_S)

        def controlled() -> None:
            nonlocal moved
            place = positions.snapshot()
            moved = max(moved, *(abs(value) for value in place.values()))
            target = round(1000 * sin(link.now_s() - begun_s))
            set_points.write([target] * len(joints))
            link.step(DT_S)

        taken: dict[str, list[tuple[float, float]]] = {
            "alone": [],
            "controlled": [],
        }  # of a step: (us, robot us)
        for _ in range(run.rounds(ROUNDS)):
            for kind, turn in (("alone", alone), ("controlled", controlled)):
                start_s, robot_s = time.perf_counter(), link.now_s()
                for _ in range(STEPS):
                    turn()
                passed_s = (time.perf_counter() - start_s, link.now_s() - robot_s)
                taken[kind].append((passed_s[0] / STEPS * 1e6, passed_s[1] / STEPS * 1e6))
    ratio = {kind: median(robot_us / real_us for real_us, robot_us in rows) for kind, rows in taken.items()}
    details = {
        "a step us": median(real_us for real_us, _ in taken["controlled"]),
        "of the robot us": median(robot_us for _, robot_us in taken["controlled"]),
        "plant and board alone x real time": ratio["alone"],
    }
    complaint = "" if moved > 100 else f"the joints have moved by {moved} counts only"
    return Figure(name, title, limit, False, ratio["controlled"], "x real time", details, complaint)


def measure_twin(run: Run) -> Figure:
    """Measure the figure on the twin."""
    return _measure(run, "lockstep", "sim", 30.0, "the SCARA in steps of 1 ms, on the twin")


def measure_rtl(run: Run) -> Figure:
    """Measure the figure on the compiled gateware, at 1 MHz. The first run compiles it."""
    return _measure(run, "lockstep-rtl", "rtl", 3.0, "the SCARA in steps of 1 ms, on the VHDL at 1 MHz")


def measure_vector(run: Run) -> Figure:
    """Measure what a board of a vector of 64 does, in parts of what one board alone does.

    The plant is native, so that boards, links and environments are all that is measured.
    """
    import numpy as np

    import unitylink.gym

    def step_us(url: str, count: int) -> float:
        vector = unitylink.gym.make_vector(url, count, dt_s=DT_S, reward=lambda seen, written: 0.0)
        try:
            vector.reset(seed=1)
            actions = np.zeros((count, 1))
            vector.step(actions)
            start_s = time.perf_counter()
            for _ in range(BOARD_STEPS // count):
                vector.step(actions)
            return (time.perf_counter() - start_s) / (BOARD_STEPS // count * count) * 1e6
        finally:
            vector.close()

    with TemporaryDirectory() as folder:
        file = Path(folder) / "cart.ul"
        file.write_text(_CART)
        url = f"sim:{file}?plant=ramp"
        pairs = [(step_us(url, 1), step_us(url, BOARDS)) for _ in range(run.rounds(7))]
    return Figure(
        "lockstep-64",
        f"{BOARDS} boards in steps of one process, each against one alone",
        0.7,
        False,
        median(one_us / each_us for one_us, each_us in pairs),
        "of its speed",
        {
            "a step of one alone us": median(one_us for one_us, _ in pairs),
            f"a step of one of {BOARDS} us": median(each_us for _, each_us in pairs),
        },
    )
