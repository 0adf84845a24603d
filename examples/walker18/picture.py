# SPDX-License-Identifier: BSD-3-Clause
"""The walk as a picture: footprints from above, which feet carry, and one leg's joints."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib
import numpy as np
from gait import COXA, HALF_WIDTH, HIPS, grounded, on_body, travelled

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.axes import Axes

if TYPE_CHECKING:
    from run import Run

INK, GREY, PALE = "#1d2939", "#98a2b3", "#eaecf0"
COLOURS = ("#0e7490", "#c2410c", "#4d7c0f")


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
    figure = plt.figure(figsize=(12.5, 8.0), layout="constrained")
    above, feet, joints = figure.subplots(3, 1, height_ratios=(1.5, 0.8, 1.0))
    draw_above(above, run)
    draw_feet(feet, run)
    draw_joints(joints, run)
    joints.sharex(feet)
    rate_hz = (len(run.measured_s) - 1) / (run.measured_s[-1] - run.measured_s[0])
    figure.suptitle(
        f"18-DOF walker: {len(run.asked_s)} sets of 18 set-points out, one commit each; "
        f"{len(run.measured_s)} publishes back at {rate_hz:.0f} Hz, {run.lost} lost; "
        f"{run.distance_m * 1e3:.0f} mm walked",
        fontsize=12,
        fontweight="bold",
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def draw_above(axes: Axes, run: Run) -> None:
    """Draw where the feet stood and how the body moved forward, from the published angles alone."""
    feet = run.feet
    way = travelled(feet)
    world = on_body(feet)
    world[..., 0] += way[:, None]
    carry = grounded(feet)
    for leg in range(6):
        colour = COLOURS[0] if leg in (0, 3, 4) else COLOURS[1]
        x, y = world[:, leg, 0], world[:, leg, 1]
        axes.plot(x * 1e3, y * 1e3, color=colour, lw=0.8, alpha=0.35)
        axes.plot(
            x[carry[:, leg]] * 1e3, y[carry[:, leg]] * 1e3, "o", color=colour, ms=4, mec="none", alpha=0.35
        )
    for index, shade in ((0, 0.35), (len(way) - 1, 1.0)):
        ends = way[index] + np.array([-0.16, 0.16])
        corners_x = np.array([ends[0], ends[1], ends[1], ends[0], ends[0]])
        corners_y = HALF_WIDTH * np.array([-1, -1, 1, 1, -1])
        axes.plot(corners_x * 1e3, corners_y * 1e3, color=INK, lw=1.5, alpha=shade)
        for leg, (x, side) in enumerate(HIPS):
            hip = np.array([x + way[index], side * HALF_WIDTH])
            knee = hip + COXA * np.array(
                [np.sin(run.measured[index, leg, 0]), side * np.cos(run.measured[index, leg, 0])]
            )
            line = np.array([hip, knee, world[index, leg, :2]]) * 1e3
            axes.plot(line[:, 0], line[:, 1], color=INK, lw=1.5, alpha=shade, marker="o", ms=3)
    axes.annotate("", (way[-1] * 1e3, 0), (0, 0), arrowprops={"arrowstyle": "->", "color": GREY})
    axes.set_aspect("equal")
    axes.set_title("from above: dots are feet on the ground, lines feet in the air", loc="left")
    axes.set_xlabel("x in mm")
    axes.set_ylabel("y in mm")


def draw_feet(axes: Axes, run: Run) -> None:
    """Draw which feet carry, over time."""
    carry = grounded(run.feet)
    for leg, name in enumerate(run.legs):
        colour = COLOURS[0] if leg in (0, 3, 4) else COLOURS[1]
        axes.fill_between(
            run.measured_s, leg - 0.35, leg + 0.35, where=list(carry[:, leg]), color=colour, lw=0, step="mid"
        )
        axes.axhline(leg, color=PALE, lw=1, zorder=0)
        axes.text(-0.01, leg, name, transform=axes.get_yaxis_transform(), ha="right", va="center", color=INK)
    axes.set_yticks([])
    axes.set_ylim(5.6, -0.6)
    axes.set_title("feet on the ground: three at any time, six at rest", loc="left")


def draw_joints(axes: Axes, run: Run) -> None:
    """Draw one leg's set-points as steps and its publishes as dots."""
    for joint, name in enumerate(("hip", "knee", "foot")):
        axes.step(run.asked_s, run.asked[:, 0, joint], where="post", color=GREY, lw=3, alpha=0.45)
        axes.plot(run.measured_s, run.measured[:, 0, joint], ".", color=COLOURS[joint], ms=3, label=name)
    axes.legend(loc="upper right", frameon=False, ncols=3)
    axes.set_title(f"leg {run.legs[0]}: set-points (grey) and publishes", loc="left")
    axes.set_xlabel("time in s")
    axes.set_ylabel("rad")
    axes.margins(x=0.01)
