# SPDX-License-Identifier: BSD-3-Clause
"""The run as a picture: the tool's path from above, and each joint's set-points against its publishes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib
import numpy as np
from kinematics import FOREARM_MM, JOINTS, UPPER_ARM_MM, tool_position
from path import DEPTH_MM

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.axes import Axes

if TYPE_CHECKING:
    from run import Run

INK, GREY, PALE = "#1d2939", "#98a2b3", "#eaecf0"
COLOURS = ("#0e7490", "#c2410c", "#4d7c0f", "#7e22ce")


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
    figure = plt.figure(figsize=(12.5, 7.0), layout="constrained")
    left, right = figure.subfigures(1, 2, squeeze=False, width_ratios=(1.0, 1.15))[0]
    draw_tool(left.subplots(), run)
    for axes, column in zip(right.subplots(4, 1, sharex=True), range(4), strict=True):
        draw_joint(axes, run, column)
    axes.set_xlabel("time in s")
    ends_s = [*(began_s for _, began_s in run.phases[1:]), run.measured_s[-1]]
    for (phase, began_s), end_s in zip(run.phases, ends_s, strict=True):
        middle_s, top = (began_s + end_s) / 2, axes.get_xaxis_transform()
        axes.text(middle_s, 0.02, phase, transform=top, color=GREY, fontsize=7.5, ha="center")
    gaps_ms = np.diff(run.measured_s) * 1e3
    figure.suptitle(
        f"SCARA on a TosNet network: {len(run.asked_s)} set-points out, "
        f"{len(run.measured_s)} publishes back at {1e3 / np.mean(gaps_ms):.0f} Hz, {run.lost} lost",
        fontsize=12,
        fontweight="bold",
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def draw_tool(axes: Axes, run: Run) -> None:
    """Draw the tool's path seen from above, and the arm at the place where it draws."""
    asked_x, asked_y = tool_position(run.asked[:, 0], run.asked[:, 1])
    x, y = tool_position(run.measured[:, 0], run.measured[:, 1])
    down = run.measured[:, 2] > DEPTH_MM / 2
    drawn = np.flatnonzero(down)
    if len(drawn):
        draw_arm(axes, run, int(drawn[len(drawn) * 5 // 12]))
    axes.plot(asked_x, asked_y, color=GREY, lw=5, alpha=0.35, solid_capstyle="round", label="set-points")
    axes.plot(x, y, color=GREY, lw=0.8, ls=(0, (4, 3)), label="tool up")
    axes.plot(
        np.where(down, x, np.nan),
        np.where(down, y, np.nan),
        color=COLOURS[0],
        lw=1.8,
        label="tool down",
    )
    axes.plot(x[down], y[down], ".", color=COLOURS[0], ms=4)
    reach = np.linspace(-np.pi / 3, np.pi / 3, 90)
    full = UPPER_ARM_MM + FOREARM_MM
    axes.plot(full * np.cos(reach), full * np.sin(reach), color=PALE, lw=1.2, zorder=0)
    axes.annotate("reach", (full * np.cos(0.5) - 8, full * np.sin(0.5)), color=GREY, ha="right")
    axes.set_aspect("equal")
    axes.set_xlim(-35, full + 25)
    axes.set_ylim(-260, 260)
    axes.set_xlabel("x in mm")
    axes.set_ylabel("y in mm")
    axes.set_title("the tool, seen from above", loc="left")
    axes.legend(loc="lower left", frameon=False)


def draw_arm(axes: Axes, run: Run, index: int) -> None:
    shoulder, elbow = run.measured[index, 0], run.measured[index, 1]
    angle = np.radians(shoulder)
    elbow_x, elbow_y = UPPER_ARM_MM * np.cos(angle), UPPER_ARM_MM * np.sin(angle)
    tool_x, tool_y = tool_position(np.array(shoulder), np.array(elbow))
    joints_x, joints_y = [0.0, elbow_x, float(tool_x)], [0.0, elbow_y, float(tool_y)]
    axes.plot(
        joints_x, joints_y, color=PALE, lw=16, solid_capstyle="round", solid_joinstyle="round", zorder=0
    )
    axes.plot(joints_x, joints_y, "o", color="white", mec=GREY, ms=9, zorder=1)


def draw_joint(axes: Axes, run: Run, column: int) -> None:
    """Draw one joint's set-points as steps and its publishes as dots."""
    joint, colour = JOINTS[column], COLOURS[column]
    error = run.tracking_error()[:, column]
    axes.step(run.asked_s, run.asked[:, column], where="post", color=GREY, lw=4, alpha=0.4)
    axes.plot(run.measured_s, run.measured[:, column], ".", color=colour, ms=3)
    rms = float(np.sqrt(np.mean(error**2)))
    axes.set_title(f"{joint.name}  {joint.role}", loc="left", color=colour, fontweight="bold")
    axes.set_title(f"rms error {rms:.2f} {joint.unit}", loc="right", color=GREY)
    axes.set_ylabel(joint.unit)
    axes.margins(x=0.01, y=0.14)
    for _, began_s in run.phases[1:]:
        axes.axvline(began_s, color=PALE, lw=1, zorder=0)
