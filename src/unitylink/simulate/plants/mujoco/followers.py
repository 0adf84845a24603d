# SPDX-License-Identifier: BSD-3-Clause
"""The components that say where a joint shall be: servos and steppers."""

from __future__ import annotations

import math

from unitylink.errors import UnityLinkError, ValueRangeError

from ...machine import SERVOS, STEPPERS, RcServoData, Supply, TurnedStepper
from .chosen import motor_of, position_actuator, preset_of
from .couplings import Coupler, Couplings, Outside
from .drives import Axis, Drive, ServoDrive, StepDrive
from .model_joint import ModelJoint, Push
from .part_wish import PartWish
from .quantities import factor_of, ratio_of_counts, si_of_count, value_offset, value_unit
from .servo_drive import BusServoDrive, ServoCounts
from .stepper_drive import StepperDrive

_PLACE = ("joint", "actuator", "sign")
_SERVO = RcServoData("any", seconds_per_60_deg=0.2, stall_torque_kg_cm=3.0)  # 1500 us, and 10 us for a degree
_EFFORTS = {"rad": "N m", "m": "N"}  # of a joint, by the unit of its position


def couple_servo(wish: PartWish, coupler: Coupler, into: Couplings) -> None:
    """An `rc_servo`: a position actuator goes to where its pulses say."""
    wish.check_keys((*_PLACE, "servo", "channel", "zero", "unit"))
    joint = coupler.needed_joint(wish)
    actuator = position_actuator(wish, coupler, joint)
    servo = preset_of(wish, "servo", SERVOS) if wish.get("servo") else _SERVO
    zero_rad = float(wish.get("zero", 0.0)) * factor_of(wish, "rad", "deg")
    channel, sign = int(wish.get("channel", 0)), int(wish.get("sign", 1))

    def made(outside: Outside) -> Drive:
        axis = Axis(joint, outside.data, sign)
        return ServoDrive(outside.pins, servo, axis, actuator, channel=channel, zero_rad=zero_rad)

    into.drive(wish, joint, actuator, made)


def couple_stepgen(wish: PartWish, coupler: Coupler, into: Couplings) -> None:
    """An axis of a `stepgen`: a stepper, or a position actuator that loses no step."""
    if wish.get("stepper"):
        _couple_stepper(wish, coupler, into)
        return
    wish.check_keys((*_PLACE, "channel", "unit", "scale", "stepper"))
    joint = coupler.needed_joint(wish)
    actuator = position_actuator(wish, coupler, joint)
    step, sign = si_of_count(wish, "target", joint.unit), int(wish.get("sign", 1))
    channel = int(wish.get("channel", 0))

    def made(outside: Outside) -> Drive:
        axis = Axis(joint, outside.data, sign)
        return StepDrive(outside.pins, axis, actuator, channel=channel, step=step)

    into.drive(wish, joint, actuator, made)


def _couple_stepper(wish: PartWish, coupler: Coupler, into: Couplings) -> None:
    """What a step is at the joint says the gear: a turn of the motor has so many of them."""
    wish.check_keys((*_PLACE, "channel", "unit", "scale", "stepper", "supply_v", "microsteps", "current_a"))
    joint = coupler.needed_joint(wish)
    data = preset_of(wish, "stepper", STEPPERS)
    if not wish.get("supply_v"):
        raise wish.refused("say supply_v, the voltage of the driver; a stepper has none of its own")
    volts, microsteps = float(wish.get("supply_v")), int(wish.get("microsteps", 16))
    current_a = float(wish.get("current_a", data.current_a))
    motor, model = motor_of(wish, coupler, joint), coupler.model
    step, channel = si_of_count(wish, "target", joint.unit), int(wish.get("channel", 0))
    sign = int(math.copysign(1, step)) * int(wish.get("sign", 1))
    ratio = 2 * math.pi / data.steps_per_turn / microsteps / abs(step)

    def turned() -> TurnedStepper:
        return TurnedStepper(data, Supply(volts), microsteps=microsteps, current_a=current_a, ratio=ratio)

    joint.add(model, turned().inertia_kg_m2, 0.0, 0.0)  # its friction is in it

    def made(outside: Outside) -> Drive:
        push = Push(model, outside.data, joint, motor)
        drive = StepperDrive(outside.pins, turned(), Axis(joint, outside.data, sign), push, channel=channel)
        try:
            drive.check_period(model)
        except ValueRangeError as error:
            raise wish.refused(str(error)) from error
        return drive

    into.drive(wish, joint, motor, made)


def couple_servo_bus(wish: PartWish, coupler: Coupler, into: Couplings) -> None:
    """A servo of a `servo_bus`: a position actuator goes to its goal, and it tells how the joint is."""
    wish.check_keys((*_PLACE, "channel", "unit", "scale", "zero"))
    joint = coupler.needed_joint(wish)
    actuator = position_actuator(wish, coupler, joint)
    sign, channel = int(wish.get("sign", 1)), int(wish.get("channel", 0))
    count = si_of_count(wish, "position", joint.unit)
    own = wish.get("unit") or value_unit(wish, "position")
    offset = value_offset(wish, "position") - float(wish.get("zero", 0.0))
    a_speed = count * ratio_of_counts(wish, "speed", "position")  # they are counts a second
    a_load = _load_of_count(wish, coupler, joint, actuator, into)
    at_zero = offset * factor_of(wish, joint.unit, own)

    def made(outside: Outside) -> Drive:
        axis = Axis(joint, outside.data, sign)
        counts = ServoCounts(count, at_zero, a_speed, a_load)
        return BusServoDrive(outside.pins, axis, actuator, channel=channel, counts=counts)

    into.drive(wish, joint, actuator, made)
    into.shown.add(("position", joint.position))
    into.senses.append((wish.path, lambda outside: outside.drives[joint.number]))


def _load_of_count(
    wish: PartWish, coupler: Coupler, joint: ModelJoint, actuator: int, into: Couplings
) -> float:
    """Return what one count of a load is, in N m or N: as the spec says, or 0.1 % of what it can do."""
    if value_unit(wish, "load") not in ("", "count", "%"):
        try:
            return si_of_count(wish, "load", _EFFORTS[joint.unit])
        except UnityLinkError:  # a current, say
            into.notes.append(
                f"{wish.path}.load has {value_unit(wish, 'load')}, which a model does not know: it reads 0"
            )
            return math.inf
    if coupler.model.actuator_forcelimited[actuator]:
        return float(max(abs(end) for end in coupler.model.actuator_forcerange[actuator])) / 1000
    name = coupler.model.actuator(actuator).name
    into.notes.append(
        f"{wish.path}.load has no unit, and actuator {name} no forcerange of which it is a share: it reads 0"
    )
    return math.inf
