# SPDX-License-Identifier: BSD-3-Clause
"""What a wish has chosen for the drive of a joint: a preset, a gear, an actuator of the model."""

from __future__ import annotations

import math
from collections.abc import Mapping
from difflib import get_close_matches
from typing import Any, TypeVar, Union

from ...machine import GEARS, Gear, TurnedBrushless, TurnedMotor
from .couplings import Coupler
from .model_joint import ModelJoint
from .part_wish import PartWish

Preset = TypeVar("Preset")


def motor_of(wish: PartWish, coupler: Coupler, joint: ModelJoint) -> int | None:
    """Return the motor of the model that passes a torque on. None: the joint has no actuator at all."""
    motor = coupler.actuator(wish, joint, "effort")
    if motor is None and joint.actuators:
        raise wish.refused(
            f"joint {joint.name} has {joint.other_actuators(coupler.model)}, which would work against a "
            "motor; give it a <motor> instead, or nothing"
        )
    return motor


def position_actuator(wish: PartWish, coupler: Coupler, joint: ModelJoint) -> int:
    actuator = coupler.actuator(wish, joint, "position")
    if actuator is None:
        raise wish.refused(
            f"joint {joint.name} has {joint.other_actuators(coupler.model)}; give it a <position> actuator, "
            "whose kp and forcerange are those of the drive"
        )
    return actuator


def gear_of(wish: PartWish, joint: ModelJoint) -> Gear:
    """Return what is between motor and joint. Behind it, a slide moves by `turn_m` with each turn."""
    found = preset_of(wish, "gear", GEARS) if wish.get("gear") else Gear()
    ratio = float(wish.get("ratio", found.ratio))
    if joint.unit == "m":
        if not wish.get("turn_m"):
            raise wish.refused(
                f"joint {joint.name} is a slide; say turn_m, how far a turn behind the gear moves it, in m"
            )
        ratio *= 2 * math.pi / float(wish.get("turn_m"))
    elif "turn_m" in wish.own:
        raise wish.refused(f"turn_m is for a slide, and joint {joint.name} turns; say ratio")
    return Gear(ratio, float(wish.get("efficiency", found.efficiency)), inertia_g_cm2=found.inertia_g_cm2)


def preset_of(wish: PartWish, key: str, presets: Mapping[str, Preset]) -> Preset:
    name = wish.get(key)
    if name not in presets:
        near = get_close_matches(name, presets, 3, 0.3) or sorted(presets)[:3]
        raise wish.refused(f"there is no {key} {name!r}; nearest: {', '.join(near)}")
    return presets[name]


def some(presets: Mapping[str, Any]) -> str:
    return ", ".join(list(presets)[:2]) + ", …"


def add_to(coupler: Coupler, joint: ModelJoint, motor: Union[TurnedMotor, TurnedBrushless]) -> None:
    """Give a joint what turns with it."""
    joint.add(coupler.model, motor.inertia_kg_m2, motor.friction_nm, motor.damping_nm_s)
