# SPDX-License-Identifier: BSD-3-Clause
"""Time in steps: how many seconds of a robot fit into one of this machine, while a program controls it.

The robot is the SCARA with its plant. In each step of a millisecond, Python reads the positions of all joints
as one snapshot, and writes all set-points as one group. Steps without the program show what plant and board
take by themselves.
"""

from __future__ import annotations

import time
from math import sin
from statistics import median
from typing import Any

from .figure import Figure, Run

STEPS, ROUNDS, DT_S = 300, 11, 0.001


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
