# SPDX-License-Identifier: BSD-3-Clause
"""The positions of the joints, and the time in which a fibre was cut."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

if TYPE_CHECKING:
    from run import Run

COLOURS = ("#0e7490", "#c2410c", "#4d7c0f", "#7e22ce")


def save(run: Run, path: Path) -> None:
    """Write the picture, as PNG or SVG."""
    plt.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "scara_ring"})
    figure, axes = plt.subplots(figsize=(8, 3.6), layout="constrained")
    begin = run.seen[0][0]
    times = [time_s - begin for time_s, _ in run.seen]
    # While the fibre is cut, the PC does not know where the joints are.
    ends = next((at for at, time_s in enumerate(times) if time_s + begin > run.cut_s), len(times))
    goes_on = next((at for at, time_s in enumerate(times) if time_s + begin > run.mended_s), len(times))
    for joint, colour in enumerate(COLOURS):
        values = [row[joint] for _, row in run.seen]
        for part in (slice(None, ends), slice(goes_on, None)):
            label = f"joint {joint + 1}" if part.start is None else ""
            axes.plot(times[part], values[part], color=colour, label=label)
    axes.axvspan(run.cut_s - begin, run.mended_s - begin, color="#fee4e2", label="a fibre is cut")
    axes.set(xlabel="time of the device, s", ylabel="position, rad")
    axes.set_title("A ring of five nodes loses a fibre, and goes on", fontweight="bold", fontsize=11)
    axes.legend(frameon=False, ncols=5, fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.16))
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110, metadata={"Date": None} if path.suffix == ".svg" else None)
