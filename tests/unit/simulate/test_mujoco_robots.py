# SPDX-License-Identifier: BSD-3-Clause
"""The models in MuJoCo that come along: they do what a robot does, with the link in the loop."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from unitylink import connect
from unitylink.layer4_data import load_spec_objects

ROBOTS = Path(__file__).parents[3] / "examples"


@pytest.mark.parametrize("spec", ["walker18", "walker18_si"])
def test_the_walker_moves_its_body_and_its_feet_hardly_slip(spec: str) -> None:
    folder = ROBOTS / "walker18"
    gait: Any = runpy.run_path(str(folder / "gait.py"))
    url = f"sim:{folder / spec}.ul?plant=mujoco:{folder / spec}.toml"
    names, in_counts = ("hip", "knee", "foot"), spec == "walker18"
    with connect(url, time="lockstep") as link:
        walker: Any = load_spec_objects(link.board.spec, link)
        plant = link.board.plant
        assert plant.notes == ()
        legs = list(dict.fromkeys(path.rpartition(".")[0] for path in walker["sp"].values))
        soles = [plant.model.geom(number).id for number in range(plant.model.ngeom)]
        soles = [number for number in soles if plant.model.geom(number).name.endswith("_sole")]
        assert len(legs) == len(soles) == 6

        def ask(phase: float, lift: float) -> None:
            joints = gait["angles"](gait["feet_at"](phase, lift=lift))
            walker["sp"].write(
                {
                    f"{leg}.{name}_sp": round(angle * 1000) if in_counts else angle
                    for leg, of_leg in zip(legs, joints, strict=True)
                    for name, angle in zip(names, of_leg, strict=True)
                }
            )

        ask(0.25, 0.0)
        link.step(0.6)  # it stands up
        began, slipped, height = plant.data.sensor("body_at").data.copy(), np.zeros(6), []
        for step in range(1, 61):  # one cycle of 1.2 s
            ask(0.25 + step / 60, gait["LIFT"] * min(1.0, step / 10, (60 - step) / 10))
            for _ in range(20):
                before = plant.data.geom_xpos[soles][:, :2].copy()
                link.step(0.001)
                on_ground = np.isin(soles, plant.data.contact.geom)
                slipped += on_ground * np.linalg.norm(plant.data.geom_xpos[soles][:, :2] - before, axis=1)
            height.append(plant.data.sensor("body_at").data[2])
        link.step(0.3)
        way = plant.data.sensor("body_at").data - began
        asked = 2 * gait["STRIDE"]
        assert way[0] == pytest.approx(asked, rel=0.06)  # the feet push, and the body goes forward
        assert abs(way[1]) < 0.02 * asked
        assert slipped.max() < 0.1 * asked
        assert min(height) > 0.08 and max(height) < 0.1  # it stays up all the way
        measured = walker["pos"].snapshot()
        last = gait["angles"](gait["feet_at"](0.25, lift=0.0)).ravel() * (1000 if in_counts else 1)
        np.testing.assert_allclose(list(measured.values()), last, atol=20 if in_counts else 0.02)


def test_two_boards_move_one_model_and_their_arms_carry_a_box_together() -> None:
    folder = ROBOTS / "pa10"
    arm: Any = runpy.run_path(str(folder / "arm.py"))
    url = f"sim:{folder / 'pa10_pair.ul'}?plant=mujoco:{folder / 'pa10_pair.toml'}&root="
    with (
        connect(f"{url}left_arm", time="lockstep") as left,
        connect(f"{url}right_arm", time="lockstep") as right,
    ):
        world = left.board.plant.data
        assert right.board.plant.data is world
        assert left.board.plant.notes == right.board.plant.notes == ()
        arms: list[Any] = [load_spec_objects(link.board.spec, link) for link in (left, right)]
        for one in arms:
            for joint in range(7):
                one[f"arm.j[{joint}].limit"].write(3.0)
            one["arm.target"].write(arm["REST"].tolist())
        left.step(1.2)
        place, highest = world.sensor("box_at").data.copy(), 0.0
        for joints in arm["demonstration"](0.04):
            for one, angles in zip(arms, joints, strict=True):
                one["arm.target"].write(angles.tolist())
            left.step(0.04)  # the time of both
            highest = max(highest, world.sensor("box_at").data[2])
        left.step(0.5)
        assert highest - place[2] == pytest.approx(2 * arm["RADIUS"], abs=0.03)
        np.testing.assert_allclose(world.sensor("box_at").data, place, atol=0.04)
        assert world.body("box").xquat[0] > 0.99  # it stands as before
        steps = left.board.statistics.plant_steps - 1
        assert world.time == pytest.approx(0.001 * steps, abs=0.0011)  # and nobody has moved it twice
        for one, angles in zip(arms, joints, strict=True):
            np.testing.assert_allclose(list(one["arm.pos"].snapshot().values()), angles, atol=2e-3)

    with connect(f"{url}left_arm", time="lockstep") as link:
        assert link.board.plant.data is not world  # another board of this part begins in a world of its own
