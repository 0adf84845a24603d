# SPDX-License-Identifier: BSD-3-Clause
"""The walker of 18 joints in MuJoCo: how fast it walks in steps, and what it costs in real time.

It walks with the gait of the example. In steps of 20 ms, Python reads all joints as one snapshot, and writes
all set-points as one group. MuJoCo has six feet on the ground, and steps each millisecond.
"""

from __future__ import annotations

import runpy
import time
from importlib.util import find_spec
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any

from .figure import BenchError, Figure, Run

DT_S, CYCLE_S = 0.02, 1.2
WALKS, PACED, PACED_S = 7, 5, 1.5
# A plant of counters would not do: the board leaves out the steps of it that nobody sees.
STILL = """
class Plant:
    period_s = 0.001

    def attach(self, spec, registers):
        pass

    def step(self, time_s):
        pass
"""


def _url(folder: Path) -> str:
    if find_spec("mujoco") is None:
        raise BenchError("the walker needs the package mujoco-core: pip install 'unitylink[mujoco]'")
    return f"sim:{folder / 'walker18_si.ul'}?plant=mujoco:{folder / 'walker18_si.toml'}"


def _targets(folder: Path) -> list[list[float]]:
    """Return the set-points of one cycle, as the example has them."""
    gait: Any = runpy.run_path(str(folder / "gait.py"))
    steps = round(CYCLE_S / DT_S)
    return [gait["angles"](gait["feet_at"](0.25 + step / steps)).ravel().tolist() for step in range(steps)]


def measure(run: Run) -> Figure:
    """Measure how many seconds of the robot fit into one, with the link in the loop."""
    from unitylink import connect
    from unitylink.layer4_data import load_spec_objects

    folder = run.checkout / "examples" / "walker18"
    url, targets = _url(folder), _targets(folder)
    ratios, physics = [], []
    with connect(url, time="lockstep") as link:
        board: Any = link.board
        walker: Any = load_spec_objects(board.spec, link)
        walker["sp"].write(targets[0])
        link.step(0.6)
        began_m = float(board.plant.data.qpos[0])
        cycles = run.rounds(WALKS)
        for _ in range(cycles):
            start_s, robot_s = time.perf_counter(), link.now_s()
            for target in targets:
                walker["pos"].snapshot()
                walker["sp"].write(target)
                link.step(DT_S)
            ratios.append((link.now_s() - robot_s) / (time.perf_counter() - start_s))
            physics.append(_physics_us(board.plant))
        came_m = float(board.plant.data.qpos[0]) - began_m
    complaint = "" if came_m > 0.12 * cycles else f"the body has come {came_m:.2f} m only"
    details = {"a step of MuJoCo alone us": median(physics), "it walked m": came_m}
    title = "the walker of 18 joints in MuJoCo, in steps, with the link"
    return Figure("walker", title, 5.0, False, median(ratios), "x real time", details, complaint)


def _physics_us(plant: Any) -> float:
    """Return what one millisecond takes in MuJoCo alone. The model then goes on from where it was."""
    import mujoco  # type: ignore[import-untyped]

    state, steps = plant.save(), 300
    start_s = time.perf_counter()
    mujoco.mj_step(plant.model, plant.data, steps)
    taken_s = time.perf_counter() - start_s
    plant.restore(state)
    return taken_s / steps / (1000 * float(plant.model.opt.timestep)) * 1e6


def measure_paced(run: Run) -> Figure:
    """Measure what part of a core MuJoCo takes that steps each millisecond of real time.

    It is what board, plant and link take, less what they take with a plant whose steps do nothing.
    """
    from unitylink import connect
    from unitylink.layer4_data import load_spec_objects

    folder = run.checkout / "examples" / "walker18"
    url, stand = _url(folder), _targets(folder)[0]

    def percent(url: str) -> tuple[float, float]:
        """Return the processor time in percent, and the plant's steps a second."""
        with connect(url) as link:
            board: Any = link.board
            walker: Any = load_spec_objects(board.spec, link)
            walker["sp"].write(stand)
            link.sleep_until(link.now_s() + 0.5)
            begun = time.process_time(), time.perf_counter(), board.statistics.plant_steps
            link.sleep_until(link.now_s() + PACED_S)
            taken_s = time.perf_counter() - begun[1]
            steps = board.statistics.plant_steps - begun[2]
            return 100 * (time.process_time() - begun[0]) / taken_s, steps / taken_s

    with TemporaryDirectory() as made:
        still = Path(made) / "still.py"
        still.write_text(STILL, encoding="utf-8")
        bare_url = f"{url.partition('?')[0]}?plant={still}"
        pairs = [(percent(url), percent(bare_url)) for _ in range(run.rounds(PACED, 1))]
    added = median(whole - bare for (whole, _), (bare, _) in pairs)
    steps_hz = median(rate_hz for (_, rate_hz), _ in pairs)
    complaint = "" if steps_hz > 900 else f"the plant made {steps_hz:.0f} steps a second only"
    details = {
        "the board with MuJoCo %": median(whole for (whole, _), _ in pairs),
        "with steps that do nothing %": median(bare for _, (bare, _) in pairs),
        "steps of the plant Hz": steps_hz,
    }
    title = "the walker in MuJoCo at 1 kHz, paced: what the plant adds"
    return Figure(
        "walker-paced", title, 10.0, True, added, "% of a core", details, complaint, difference=True
    )
