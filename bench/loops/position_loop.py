# SPDX-License-Identifier: BSD-3-Clause
"""The time that a loop in the gateware needs, from an edge of an encoder to the answer of a bridge."""

from __future__ import annotations

import random
import tempfile
from pathlib import Path
from typing import Any

from unitylink import connect
from unitylink.layer4_data import load_spec_objects
from unitylink.spec import load

SPEC = """link joint (ADDRESS=8);
public joint() {
   motor: h_bridge(frequency_hz=20000);
   shaft: quadrature_encoder(filter_ns=40);
   loop: pid(feedback=shaft.position, output=motor.duty);
}
"""
KP = 0.0625  # duty per count, the most there is: one count is answered by a pulse in each period
LOOK_S = 1e-6  # between two looks at the gates
PATIENCE_S = 1e-3
SEED = 20


def pid_s(count: int) -> list[float]:
    """Return the times from an edge of the encoder until a gate of the bridge switches on, sorted.

    The edges come at any time of a period. The models are clock-true, and the time is that of the gateware.
    """
    draw = random.Random(SEED)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "joint.ul"
        file.write_text(SPEC, encoding="utf-8")
        with connect(f"sim:{file}", time="lockstep") as link:
            item: Any = load_spec_objects(load(file), link)
            item["loop.kp"].write(KP)
            item["loop.apply"].pulse()
            item["loop.control"].write({"enable": True})
            return sorted(_answer_s(link, item, draw) for _ in range(count))


def _answer_s(link: Any, item: Any, draw: random.Random) -> float:
    """Start the bridge, so that its periods begin at any time of one of the loop, and turn the encoder."""
    shaft, motor = (link.board.components[name] for name in ("shaft", "motor"))
    item["motor.control"].write({"enable": False, "coast": True})
    link.step(draw.uniform(1e-3, 1.1e-3))
    item["motor.control"].write({"enable": True, "coast": True})
    link.step(draw.uniform(1e-3, 1.1e-3))
    before = [motor.rises("pins", pin) for pin in range(4)]
    shaft.drive("a", True)
    looks = 0
    while [motor.rises("pins", pin) for pin in range(4)] == before:
        looks += 1
        if looks * LOOK_S > PATIENCE_S:
            raise RuntimeError("the loop does not answer")
        link.step(LOOK_S)
    shaft.drive("a", False)
    return looks * LOOK_S
