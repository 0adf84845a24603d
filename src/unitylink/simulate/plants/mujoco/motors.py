# SPDX-License-Identifier: BSD-3-Clause
"""The components that move a joint: from what is said about one to what is outside of its pins."""

from __future__ import annotations

import math
from collections.abc import Mapping
from difflib import get_close_matches
from typing import Any, TypeVar, Union

from ...machine import (
    BRUSHLESS,
    GEARS,
    SERVOS,
    Bridge,
    Gear,
    Inverter,
    RcServoData,
    Supply,
    TurnedBrushless,
    TurnedMotor,
)
from .couplings import Coupler, Couplings, Outside
from .drives import Axis, BrushlessDrive, Drive, MotorDrive, ServoDrive, ShareDrive, StepDrive
from .model_joint import ModelJoint, Push
from .part_wish import PartWish
from .quantities import factor_of, si_of_count

Preset = TypeVar("Preset")
_PLACE = ("joint", "actuator", "sign")
_MOTOR = (*_PLACE, "motor", "gear", "ratio", "efficiency", "turn_m", "supply_v")
_SERVO = RcServoData("any", seconds_per_60_deg=0.2, stall_torque_kg_cm=3.0)  # 1500 us, and 10 us for a degree


def couple_bridge(wish: PartWish, coupler: Coupler, into: Couplings) -> None:
    """An `h_bridge`, or one or two channels of a `pwm`: a DC motor, or a share of what an actuator can do."""
    assert wish.instance.component is not None
    if dict(wish.instance.component.generics).get("servo"):
        couple_servo(wish, coupler, into)
        return
    is_pwm = wish.instance.component.entity == "pwm"
    wish.check_keys((*_MOTOR, "channel", "reverse_channel") if is_pwm else _MOTOR)
    if not wish.get("motor"):
        _couple_share(wish, coupler, into)
        return
    joint, sign, channels = coupler.needed_joint(wish), int(wish.get("sign", 1)), _channels(wish)
    data = _preset(wish, "motor", coupler.motors)
    gear = _gear(wish, joint)
    volts = float(wish.get("supply_v", data.nominal_v))
    motor = _motor_of(wish, coupler, joint)
    _add(coupler, joint, TurnedMotor(data, gear))

    def made(outside: Outside) -> Drive:
        bridge = Bridge(outside.pins, Supply(volts), channels=channels)
        push = Push(coupler.model, outside.data, joint, motor)
        return MotorDrive(bridge, TurnedMotor(data, gear), Axis(joint, outside.data, sign), push)

    into.drive(wish, joint, motor, made)
    into.motors.add(joint.number)


def _channels(wish: PartWish) -> tuple[int, ...]:
    first = int(wish.get("channel", 0))
    return (first, int(wish.get("reverse_channel"))) if "reverse_channel" in wish.said else (first,)


def _couple_share(wish: PartWish, coupler: Coupler, into: Couplings) -> None:
    joint, sign, channels = coupler.needed_joint(wish), int(wish.get("sign", 1)), _channels(wish)
    model = coupler.model
    kinds = ("effort", "velocity")
    found = [number for number, kind in joint.actuators if kind in kinds]
    if name := wish.get("actuator"):
        found = [number for number in found if model.actuator(number).name == name]
    if not found or not model.actuator_ctrllimited[found[0]]:
        raise wish.refused(
            f'say motor="…" ({_some(coupler.motors)}), or give joint {joint.name} a motor with a ctrlrange'
        )
    most = sign * float(max(abs(end) for end in model.actuator_ctrlrange[found[0]]))

    def made(outside: Outside) -> Drive:
        bridge = Bridge(outside.pins, Supply(1.0), channels=channels)
        return ShareDrive(bridge, outside.data, found[0], most)

    into.drive(wish, joint, found[0], made)


def couple_inverter(wish: PartWish, coupler: Coupler, into: Couplings) -> None:
    """A `three_phase_pwm`: a brushless motor."""
    wish.check_keys(_MOTOR)
    joint, sign = coupler.needed_joint(wish), int(wish.get("sign", 1))
    if not wish.get("motor"):
        raise wish.refused(f'say motor="…" ({_some(BRUSHLESS)})')
    data = _preset(wish, "motor", BRUSHLESS)
    gear = _gear(wish, joint)
    if not wish.get("supply_v"):
        raise wish.refused("say supply_v, the voltage of the supply; a brushless motor has none of its own")
    volts = float(wish.get("supply_v"))
    motor = _motor_of(wish, coupler, joint)
    _add(coupler, joint, TurnedBrushless(data, gear))

    def made(outside: Outside) -> Drive:
        inverter = Inverter(outside.pins, Supply(volts))
        push = Push(coupler.model, outside.data, joint, motor)
        return BrushlessDrive(inverter, TurnedBrushless(data, gear), Axis(joint, outside.data, sign), push)

    into.drive(wish, joint, motor, made)
    into.motors.add(joint.number)


def couple_servo(wish: PartWish, coupler: Coupler, into: Couplings) -> None:
    """An `rc_servo`: a position actuator goes to where its pulses say."""
    wish.check_keys((*_PLACE, "servo", "channel", "zero", "unit"))
    joint = coupler.needed_joint(wish)
    actuator = _position_actuator(wish, coupler, joint)
    servo = _preset(wish, "servo", SERVOS) if wish.get("servo") else _SERVO
    zero_rad = float(wish.get("zero", 0.0)) * factor_of(wish, "rad", "deg")
    channel, sign = int(wish.get("channel", 0)), int(wish.get("sign", 1))

    def made(outside: Outside) -> Drive:
        axis = Axis(joint, outside.data, sign)
        return ServoDrive(outside.pins, servo, axis, actuator, channel=channel, zero_rad=zero_rad)

    into.drive(wish, joint, actuator, made)


def couple_stepgen(wish: PartWish, coupler: Coupler, into: Couplings) -> None:
    """An axis of a `stepgen`: a position actuator follows its steps."""
    wish.check_keys((*_PLACE, "channel", "unit", "scale"))
    joint = coupler.needed_joint(wish)
    actuator = _position_actuator(wish, coupler, joint)
    step, sign = si_of_count(wish, "target", joint.unit), int(wish.get("sign", 1))
    channel = int(wish.get("channel", 0))

    def made(outside: Outside) -> Drive:
        axis = Axis(joint, outside.data, sign)
        return StepDrive(outside.pins, axis, actuator, channel=channel, step=step)

    into.drive(wish, joint, actuator, made)


def _motor_of(wish: PartWish, coupler: Coupler, joint: ModelJoint) -> int | None:
    """Return the motor of the model that passes a torque on. None: the joint has no actuator at all."""
    motor = coupler.actuator(wish, joint, "effort")
    if motor is None and joint.actuators:
        raise wish.refused(
            f"joint {joint.name} has {joint.other_actuators(coupler.model)}, which would work against a "
            "motor; give it a <motor> instead, or nothing"
        )
    return motor


def _position_actuator(wish: PartWish, coupler: Coupler, joint: ModelJoint) -> int:
    actuator = coupler.actuator(wish, joint, "position")
    if actuator is None:
        raise wish.refused(
            f"joint {joint.name} has {joint.other_actuators(coupler.model)}; give it a <position> actuator, "
            "whose kp and forcerange are those of the drive"
        )
    return actuator


def _gear(wish: PartWish, joint: ModelJoint) -> Gear:
    """Return what is between motor and joint. Behind it, a slide moves by `turn_m` with each turn."""
    found = _preset(wish, "gear", GEARS) if wish.get("gear") else Gear()
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


def _preset(wish: PartWish, key: str, presets: Mapping[str, Preset]) -> Preset:
    name = wish.get(key)
    if name not in presets:
        near = get_close_matches(name, presets, 3, 0.3) or sorted(presets)[:3]
        raise wish.refused(f"there is no {key} {name!r}; nearest: {', '.join(near)}")
    return presets[name]


def _some(presets: Mapping[str, Any]) -> str:
    return ", ".join(list(presets)[:2]) + ", …"


def _add(coupler: Coupler, joint: ModelJoint, motor: Union[TurnedMotor, TurnedBrushless]) -> None:
    """Give a joint what turns with it."""
    joint.add(coupler.model, motor.inertia_kg_m2, motor.friction_nm, motor.damping_nm_s)
