# SPDX-License-Identifier: BSD-3-Clause
"""Components: the time to compile a spec with many, and what a virtual board with moving ones costs."""

from __future__ import annotations

import time
from typing import Any

from .figure import BenchError, Figure, Run
from .timing import times

KINDS = (
    "stepgen()",  # four axes
    "quadrature_encoder()",
    "pwm(channels=4)",
    "h_bridge()",
    "three_phase_pwm()",
    "gpio(pins=8)",
)
COMPILED, MOVING = 50, 10
_STEPS_HZ = 100_000
_LOOK_S = 0.1  # a model computes only when somebody looks, so the work is done within the measured time
_DUTY = 0.3
_ENABLE, _FOLLOW_VELOCITY = 0b1, 0b11  # words of `control`


def spec(components: int) -> str:
    """Return a spec with so many components, of every kind in turns."""
    lines = (f"   c{index}: {KINDS[index % len(KINDS)]};" for index in range(components))
    return "\n".join(["link many;", "public many() {", *lines, "}", ""])


def measure_compile(run: Run) -> Figure:
    """Measure the time from the text of a spec to its model, in this process."""
    from unitylink.spec import compile_text

    text = spec(COMPILED).encode()
    if compile_text(text, "many.ul").spec is None:
        raise BenchError("the spec of the components does not compile")
    taken = times(lambda: compile_text(text, "many.ul"), run.rounds(20, 2))
    title = f"a spec of {COMPILED} components compiled"
    return Figure("components-compile", title, 0.3, True, sorted(taken)[len(taken) // 2] / 1e9, "s")


def measure_paced(run: Run) -> Figure:
    """Measure the processor time of a virtual board in real time, while all its components move."""
    from unitylink import connect
    from unitylink.layer4_data import load_spec_objects
    from unitylink.simulate import Board
    from unitylink.spec import compile_text

    compiled = compile_text(spec(MOVING).encode(), "many.ul").spec
    assert compiled is not None
    with Board(compiled, endpoint="tcp") as board, connect(f"{board.url}?timeout=5") as link:
        robot: Any = load_spec_objects(compiled, link)
        axes = _start(robot)
        before = [axis.read() for axis in axes]
        busy_s, start_s = time.process_time(), time.perf_counter()
        while time.perf_counter() - start_s < (1.0 if run.quick else 10.0):
            time.sleep(_LOOK_S)
            looked_s = time.perf_counter() - start_s
            steps = [axis.read() - first for axis, first in zip(axes, before, strict=True)]
        busy_s, taken_s = time.process_time() - busy_s, time.perf_counter() - start_s
        slipped_s = board.statistics.time_slipped_s
    complaint = ""
    if min(steps) < 0.9 * _STEPS_HZ * looked_s or slipped_s > 0.01 * taken_s:
        complaint = (
            f"an axis made {min(steps)} steps in {looked_s:.1f} s; the board was {slipped_s:.2f} s late"
        )
    return Figure(
        "components-paced",
        f"sim: with {MOVING} moving components in real time",
        20,
        True,
        100 * busy_s / taken_s,
        "% of a core",
        {"axes": len(axes), "steps/s of each": min(steps) / looked_s},
        complaint,
    )


def _start(robot: Any) -> list[Any]:
    """Let every component do its work. Return the positions of the steppers."""
    axes = []
    for index in range(MOVING):
        part, kind = robot[f"c{index}"], KINDS[index % len(KINDS)].partition("(")[0]
        if kind == "stepgen":
            for axis, control in enumerate(part.control):
                part.speed[axis].write(_STEPS_HZ)
                part.acceleration[axis].write(1_000_000)
                control.write(_FOLLOW_VELOCITY)
                part.velocity_target[axis].write(_STEPS_HZ)
            axes += part.position
        elif kind == "pwm":
            part.control.write(_ENABLE)
            for width in part.width:
                width.write(_DUTY)
        elif kind in ("h_bridge", "three_phase_pwm"):
            part.control.write(_ENABLE)
            for duty in part.duty if kind == "three_phase_pwm" else [part.duty]:
                duty.write(_DUTY)
    return axes
