# SPDX-License-Identifier: BSD-3-Clause
"""An arm learns to reach on the twin, and then the policy drives the gateware, also past a cut line.

    python examples/reach/run.py --rtl --picture reach.png     # as `make demo-learn`: about three minutes
    python examples/reach/run.py --policy policy.txt           # without training: what --save has written

The exit code is 1 if the hand missed a target, the motors were not safe while the line was gone, or the arm
jumped when it was back.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np
from drive import DEAD_MAN_S, Drive, drive
from policy import draw_targets, load, save
from train import Effort, Learned, train

from unitylink.program import run_program

NEAR_M = 0.01
TEST_SEED = 100  # targets that the training has not seen
TEST_TARGETS = 5


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rtl", action="store_true", help="drive the VHDL, compiled, and not the twin")
    parser.add_argument("--seed", type=int, default=1, help="of the training (default 1)")
    parser.add_argument("--generations", type=int, default=Effort.generations)
    parser.add_argument("--processes", type=int, default=2, help="for the training (default 2)")
    parser.add_argument("--policy", type=Path, metavar="FILE", help="take this policy, and do not train")
    parser.add_argument("--save", type=Path, metavar="FILE", help="write the policy there")
    parser.add_argument("--picture", type=Path, metavar="FILE", help="draw curve and drive there (PNG, SVG)")
    chosen = parser.parse_args()

    learned = None
    if chosen.policy is None:
        began_s = time.monotonic()
        learned = train(Effort(generations=chosen.generations, seed=chosen.seed), processes=chosen.processes)
        robot_s, took_s = learned.steps * 0.02, time.monotonic() - began_s
        print(f"learned from {learned.steps} steps: {robot_s / 60:.0f} minutes of a robot in {took_s:.0f} s")
    numbers = load(chosen.policy) if learned is None else learned.numbers
    if chosen.save is not None:
        save(numbers, chosen.save)
    where = "gateware" if chosen.rtl else "twin"
    print(f"the same policy on the {where}, with its line cut in the middle ...", flush=True)
    driven = drive(numbers, draw_targets(np.random.default_rng(TEST_SEED), TEST_TARGETS), rtl=chosen.rtl)
    return report(driven, learned, where, chosen.picture)


def report(driven: Drive, learned: Learned | None, where: str, picture: Path | None) -> int:
    """Print the figures, draw the picture, and return the exit code."""
    near = bool((driven.missed_m < NEAR_M).all())
    print(f"  hand off its targets     {', '.join(f'{off * 1e3:.1f}' for off in driven.missed_m)} mm")
    print(
        f"  motors without torque    {driven.safe_after_s * 1e3:.0f} ms after the cut "
        f"(dead-man {DEAD_MAN_S * 1e3:.0f} ms, {driven.torque_before_nm:.2f} N m before)"
    )
    print(f"  safe until the line was back, {(driven.back_s - driven.cut_s) * 1e3:.0f} ms: {driven.safe}")
    print(
        f"  largest step of an angle {driven.step_at_return_rad:.3f} rad at the return, "
        f"{driven.largest_step_rad:.3f} rad elsewhere: {'a jump' if driven.jumped else 'no jump'}"
    )
    if picture is not None:
        import picture as pictures

        pictures.save(driven, learned, where, picture)
        print(f"  {picture}")
    return 0 if near and driven.safe and not driven.jumped else 1


if __name__ == "__main__":
    run_program(main, name="reach")
