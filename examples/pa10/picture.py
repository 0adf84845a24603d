# SPDX-License-Identifier: BSD-3-Clause
"""The motion as a picture: both arms in space with the paths of their hands, and all joints over time."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np
from arm import BASES, hands, points

matplotlib.use("Agg")
import matplotlib.pyplot as plt

if TYPE_CHECKING:
    from run import Run

INK, GREY = "#1d2939", "#98a2b3"
COLOURS = ("#0e7490", "#c2410c")
JOINTS = ("S1", "S2", "S3", "E1", "E2", "W1", "W2")


def save(run: Run, path: Path) -> None:
    """Write the picture as PNG."""
    plt.rcParams.update(
        {
            "font.size": 9,
            "text.color": INK,
            "axes.labelcolor": INK,
            "axes.edgecolor": GREY,
            "xtick.color": GREY,
            "ytick.color": GREY,
            "axes.spines.top": False,
            "axes.spines.right": False,
        }
    )
    figure = plt.figure(figsize=(13.0, 7.2), layout="constrained")
    left, right = figure.subfigures(1, 2, squeeze=False, width_ratios=(1.15, 1.0))[0]
    draw_arms(left.add_subplot(projection="3d"), run)
    rows = right.subplots(7, 1, sharex=True)
    for joint, (axes, name) in enumerate(zip(rows, JOINTS, strict=True)):
        for arm, colour in enumerate(COLOURS):
            axes.step(run.asked_s, run.asked[:, arm, joint], where="post", color=GREY, lw=3, alpha=0.4)
            axes.plot(run.measured_s, run.measured[:, arm, joint], ".", color=colour, ms=2)
        axes.set_ylabel(f"{name}\nrad", rotation=0, ha="right", va="center")
        axes.margins(x=0.01, y=0.15)
    rows[0].set_title("set-points (grey) and publishes of all joints", loc="left")
    rows[-1].set_xlabel("time in s")
    rate_hz = (len(run.measured_s) - 1) / (run.measured_s[-1] - run.measured_s[0])
    figure.suptitle(
        f"Two PA10 arms on two links: {len(run.asked_s)} sets of 14 set-points out, "
        f"{len(run.measured_s)} sets of positions back at {rate_hz:.0f} Hz, {run.lost} lost",
        fontsize=12,
        fontweight="bold",
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def draw_arms(axes: Any, run: Run) -> None:
    """Draw the arms at rest (pale) and at four places on the loop, and the paths of the hands."""
    way = hands(run.measured)
    for arm, (colour, name) in enumerate(zip(COLOURS, ("left arm", "right arm"), strict=True)):
        for at in (0.0, 0.32, 0.44, 0.56):
            index = int(at * (len(run.measured_s) - 1))
            line = np.concatenate([[np.zeros(3)], points(run.measured[index, arm])]) + BASES[arm]
            pale = 0.25 if at == 0.0 else 0.75
            axes.plot(*line.T, color=colour, lw=3, alpha=pale, marker="o", ms=4, solid_capstyle="round")
        axes.plot(*way[:, arm].T, color=colour, lw=1.2, label=name)
    axes.set_box_aspect((1.0, 1.4, 1.1))
    axes.set_xlim(-0.2, 0.8)
    axes.set_ylim(-0.7, 0.7)
    axes.set_zlim(0.0, 1.1)
    axes.view_init(elev=22, azim=-28)
    axes.set_xlabel("x in m")
    axes.set_ylabel("y in m")
    axes.set_zlabel("z in m")
    axes.set_title("arms at rest (pale) and on the loop; lines are the hands", loc="left")
    axes.legend(loc="upper left", frameon=False)
