# SPDX-License-Identifier: BSD-3-Clause
"""The learning curve, the way of the hand, and the torques around the cut."""

from __future__ import annotations

from pathlib import Path

import matplotlib
import numpy as np
from drive import Drive
from matplotlib.axes import Axes
from policy import hand
from train import Learned

matplotlib.use("Agg")
import matplotlib.pyplot as plt

INK, GREY, PALE = "#1d2939", "#98a2b3", "#fee4e2"
COLOURS = ("#0e7490", "#c2410c")


def save(driven: Drive, learned: Learned | None, where: str, path: Path) -> None:
    """Write the picture, as PNG or SVG."""
    plt.rcParams.update(
        {"font.size": 9, "text.color": INK, "axes.spines.top": False, "axes.spines.right": False}
    )
    figure = plt.figure(figsize=(12.5, 4.6), layout="constrained")
    curve, way, torque = figure.subplots(1, 3, width_ratios=(0.8, 1, 1.4))
    if learned is not None:
        draw_curve(curve, learned)
    draw_way(way, driven)
    draw_torques(torque, driven)
    figure.suptitle(
        f"Learned on the twin, driven on the {where}: safe {driven.safe_after_s * 1e3:.0f} ms after the cut, "
        f"{driven.missed_m.max() * 1e3:.1f} mm off at most",
        fontsize=12,
        fontweight="bold",
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110, metadata={"Date": None} if path.suffix == ".svg" else None)
    plt.close(figure)


def draw_curve(axes: Axes, learned: Learned) -> None:
    """Draw the scores of the generations."""
    number = np.arange(1, len(learned.curve) + 1)
    axes.plot(number, learned.curve[:, 2], color=GREY, label="mean of all")
    axes.plot(number, learned.curve[:, 0], color=COLOURS[0], label="best")
    axes.set_xlabel("generation")
    axes.set_ylabel("score: mean distance in m, negative")
    axes.legend(frameon=False, loc="lower right")


def draw_way(axes: Axes, driven: Drive) -> None:
    """Draw the way of the hand from above, and what it did without a line."""
    places = hand(np.array([row.angles for row in driven.rows]))
    linked = np.array([row.linked for row in driven.rows])
    axes.plot(*places.T, color=COLOURS[0], lw=1.2, label="hand")
    axes.plot(*places[~linked].T, color="#d92d20", lw=2.5, label="no line")
    axes.plot(*driven.targets.T, "+", color=INK, ms=10, label="targets")
    axes.set_aspect("equal", "datalim")
    axes.set_xlabel("m")
    axes.legend(frameon=False, loc="best", fontsize=8)


def draw_torques(axes: Axes, driven: Drive) -> None:
    """Draw the torques of the motors around the cut."""
    times = np.array([row.time_s for row in driven.rows])
    values = np.array([row.torques for row in driven.rows])
    axes.axvspan(driven.cut_s, driven.back_s, color=PALE, lw=0)
    for column, (name, colour) in enumerate(zip(("shoulder", "elbow"), COLOURS, strict=True)):
        axes.step(times, values[:, column], where="post", color=colour, lw=1.2, label=name)
    axes.set_xlim(driven.cut_s - 0.5, driven.back_s + 0.7)
    axes.set_xlabel("time in s; shaded: the line is cut")
    axes.set_ylabel("torque in N m")
    axes.legend(frameon=False, loc="upper right")
