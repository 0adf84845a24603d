# SPDX-License-Identifier: BSD-3-Clause
"""Section VI.C of the paper: the rate of a single integer to ROS and from it, on real ROS."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from unitylink_lab.bench import run

PAPER_HZ = {"out": 1800.0, "in": 300.0}
FIGURES = ("ros1-out", "ros1-in", "dds-out", "dds-in")
SLOWER = ("roscpp-out",)  # its package is compiled first, so the quick form leaves it out


def rates(*, quick: bool, say: Callable[[str], None]) -> dict[str, Any]:
    """Return the messages a second of our node, and of a bare publisher or subscriber.

    The bench measures them.

    `failures` names what could not be measured, and the command that installs what is missing.
    """
    report = run(only=FIGURES if quick else (*FIGURES, *SLOWER), quick=quick, say=say)
    rows = [
        {
            "name": figure.name,
            "title": figure.title,
            "paper_hz": PAPER_HZ[figure.name.partition("-")[2]] if figure.name.startswith("ros1") else None,
            "node_hz": figure.details["node messages/s"],
            "bare_hz": figure.details["bare messages/s"],
            "ratio": figure.measured,
        }
        for figure in report.figures
    ]
    return {"rows": rows, "failures": report.failures}
