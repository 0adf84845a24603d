# SPDX-License-Identifier: BSD-3-Clause
"""The components that drive a motor at a joint: from what is said about one to what is at its pins."""

from __future__ import annotations

from ...machine import BRUSHLESS, Bridge, Inverter, Supply, TurnedBrushless, TurnedMotor
from .chosen import add_to, gear_of, motor_of, preset_of, some
from .couplings import Coupler, Couplings, Outside
from .drives import Axis, BrushlessDrive, Drive, MotorDrive, ShareDrive
from .followers import couple_servo
from .model_joint import Push
from .part_wish import PartWish
from .speed_drive import SpeedDrive, ThrottleDrive

_MOTOR = ("joint", "actuator", "sign", "motor", "gear", "ratio", "efficiency", "turn_m", "supply_v")


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
    data = preset_of(wish, "motor", coupler.motors)
    gear = gear_of(wish, joint)
    volts = float(wish.get("supply_v", data.nominal_v))
    motor = motor_of(wish, coupler, joint)
    add_to(coupler, joint, TurnedMotor(data, gear))

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
            f'say motor="…" ({some(coupler.motors)}), or give joint {joint.name} a motor with a ctrlrange'
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
        raise wish.refused(f'say motor="…" ({some(BRUSHLESS)})')
    data = preset_of(wish, "motor", BRUSHLESS)
    gear = gear_of(wish, joint)
    if not wish.get("supply_v"):
        raise wish.refused("say supply_v, the voltage of the supply; a brushless motor has none of its own")
    volts = float(wish.get("supply_v"))
    motor = motor_of(wish, coupler, joint)
    add_to(coupler, joint, TurnedBrushless(data, gear))

    def made(outside: Outside) -> Drive:
        inverter = Inverter(outside.pins, Supply(volts))
        push = Push(coupler.model, outside.data, joint, motor)
        return BrushlessDrive(inverter, TurnedBrushless(data, gear), Axis(joint, outside.data, sign), push)

    into.drive(wish, joint, motor, made)
    into.motors.add(joint.number)


def couple_dshot(wish: PartWish, coupler: Coupler, into: Couplings) -> None:
    """A channel of a `dshot`: a brushless motor, or a share of what an actuator can do, also a thrust."""
    wish.check_keys((*_MOTOR, "channel"))
    channel, sign = int(wish.get("channel", 0)), int(wish.get("sign", 1))
    if not wish.get("motor"):
        _couple_throttle(wish, coupler, into)
        return
    joint = coupler.needed_joint(wish)
    brushless = preset_of(wish, "motor", BRUSHLESS)
    if not wish.get("supply_v"):
        raise wish.refused("say supply_v, the voltage of the supply; a brushless motor has none of its own")
    volts = float(wish.get("supply_v"))
    data, gear = brushless.in_blocks(volts), gear_of(wish, joint)
    motor = motor_of(wish, coupler, joint)
    add_to(coupler, joint, TurnedMotor(data, gear))

    def made(outside: Outside) -> Drive:
        turned, push = TurnedMotor(data, gear), Push(coupler.model, outside.data, joint, motor)
        axis = Axis(joint, outside.data, sign)
        pairs, supply = brushless.pole_pairs, Supply(volts)
        return SpeedDrive(outside.pins, supply, turned, axis, push, pole_pairs=pairs, channel=channel)

    into.drive(wish, joint, motor, made)
    into.motors.add(joint.number)


def _couple_throttle(wish: PartWish, coupler: Coupler, into: Couplings) -> None:
    assert wish.instance.component is not None
    number = coupler.pusher(wish)
    if dict(wish.instance.component.generics).get("bidirectional"):
        raise wish.refused(f'with bidirectional=1 it shows a speed, so say motor="…" ({some(BRUSHLESS)})')
    model, channel = coupler.model, int(wish.get("channel", 0))
    most = int(wish.get("sign", 1)) * float(max(abs(end) for end in model.actuator_ctrlrange[number]))
    into.drive_actuator(
        wish,
        number,
        model.actuator(number).name,
        lambda outside: ThrottleDrive(outside.pins, outside.data, number, most, channel=channel),
    )
