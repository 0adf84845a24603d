#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws docs/images/mujoco.png: what the SCARA, the walker and the two PA10 do in MuJoCo, four pictures each.

    python tools/docs/robots_in_mujoco.py

Each robot is behind its virtual boards, in steps, and its own program's path goes over the links.
"""

from __future__ import annotations

import runpy
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np

from unitylink import connect
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate.plants.mujoco import Film
from unitylink.simulate.plants.mujoco.film import write_png

ROOT = Path(__file__).resolve().parents[2]
FILE = ROOT / "docs" / "images" / "mujoco.png"
WIDTH, HEIGHT, GAP = 300, 225, 6
PICTURES = 4


def _robots(
    folder: str, spec: str, model: str, roots: list[str], stack: ExitStack
) -> Iterator[tuple[Any, Any]]:
    """Yield the link and the robot of each board."""
    for root in roots:
        part = f"&root={root}" if root else ""
        place = ROOT / "examples" / folder
        url = f"sim:{place / spec}?plant=mujoco:{place / model}{part}"
        link = stack.enter_context(connect(url, time="lockstep"))
        yield link, load_spec_objects(link.board.spec, link)


def scara(film: Callable[[Any], Film], stack: ExitStack) -> Film:
    """Reach out, draw the flower, and go home."""
    sys.path.insert(0, str(ROOT / "examples" / "scara"))
    path = runpy.run_path(str(ROOT / "examples" / "scara" / "path.py"))
    ((link, arm),) = _robots("scara", "scara.ul", "scara.toml", [""], stack)
    joints = ("j1", "j2", "j3", "j4")
    for joint in joints:
        arm[f"{joint}.spd_sp"].write(40_000)
    taken = film(link.board.plant)
    for _, positions in path["demonstration"](0.02):
        for position in positions:
            for joint, target in zip(joints, position, strict=True):
                arm[f"{joint}.pos_sp"].write(round(100 * target))
            link.step(0.02)
            taken.take()
    return taken


def walker(film: Callable[[Any], Film], stack: ExitStack) -> Film:
    """Stand up, and make one cycle of the gait."""
    gait = runpy.run_path(str(ROOT / "examples" / "walker18" / "gait.py"))
    ((link, robot),) = _robots("walker18", "walker18_si.ul", "walker18_si.toml", [""], stack)
    robot["sp"].write(gait["angles"](gait["feet_at"](0.25, lift=0.0)).ravel().tolist())
    link.step(0.6)
    taken = film(link.board.plant)
    for step in range(60):
        robot["sp"].write(gait["angles"](gait["feet_at"](0.25 + step / 60)).ravel().tolist())
        link.step(0.02)
        taken.take()
    return taken


def pa10(film: Callable[[Any], Film], stack: ExitStack) -> Film:
    """Lift the box, and put it back."""
    arm = runpy.run_path(str(ROOT / "examples" / "pa10" / "arm.py"))
    sides = list(_robots("pa10", "pa10_pair.ul", "pa10_pair.toml", ["left_arm", "right_arm"], stack))
    link = sides[0][0]
    for _, one in sides:
        for joint in range(7):
            one[f"arm.j[{joint}].limit"].write(3.0)
        one["arm.target"].write(arm["REST"].tolist())
    link.step(1.2)
    taken = film(link.board.plant)
    for joints in arm["demonstration"](0.02):
        for (_, one), angles in zip(sides, joints, strict=True):
            one["arm.target"].write(angles.tolist())
        link.step(0.02)
        taken.take()
    return taken


def main() -> None:
    rows = []
    for make, parts in (
        (scara, (0.17, 0.4, 0.6, 0.75)),
        (walker, (0.1, 0.4, 0.65, 0.9)),
        (pa10, (0, 0.26, 0.4, 0.5)),
    ):
        with ExitStack() as stack:
            taken = make(lambda plant: Film(plant, width=WIDTH, height=HEIGHT), stack)
            rows.append(taken.pictures([round(part * (len(taken) - 1)) for part in parts]))
    sheet = np.full((3 * (HEIGHT + GAP) - GAP, PICTURES * (WIDTH + GAP) - GAP, 3), 255, dtype=np.uint8)
    for row, pictures in enumerate(rows):
        for column, pixels in enumerate(pictures):
            y, x = row * (HEIGHT + GAP), column * (WIDTH + GAP)
            sheet[y : y + HEIGHT, x : x + WIDTH] = pixels
    write_png(FILE, sheet)
    print(f"{FILE.relative_to(ROOT)}: {FILE.stat().st_size // 1000} kB")


if __name__ == "__main__":
    main()
