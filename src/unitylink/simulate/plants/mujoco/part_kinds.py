# SPDX-License-Identifier: BSD-3-Clause
"""Which components may be at a model, and how each is coupled."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from difflib import get_close_matches
from typing import Any

import mujoco  # type: ignore[import-untyped]

from unitylink.errors import UnityLinkError

from ...machine import DcMotorData, EndSwitch
from .couplings import Coupler, Couplings
from .followers import couple_servo_bus, couple_stepgen
from .motors import couple_bridge, couple_dshot, couple_inverter
from .part_wish import PLACES, PartWish
from .quantities import factor_of, si_of_count, value_unit
from .shown import (
    ShownAbsolute,
    ShownCurrents,
    ShownDistance,
    ShownEncoder,
    ShownForce,
    ShownHall,
    ShownSwitch,
)

_SWITCH = ("joint", "port", "channel", "below", "above", "hysteresis", "closed_level", "unit", "sign", "zero")
_SENSED = {"sonar": ("sensor",), "hx711": ("sensor",)}  # they do not belong to a joint
_WHOLE = 1e-6  # so near to a whole number, counts of a turn are one


def couple(wishes: Sequence[PartWish], model: Any, motors: Mapping[str, DcMotorData]) -> Couplings:
    """Couple the components of a spec to a model. Motors and gears give their inertia to it.

    Raises UnityLinkError for what is said and cannot be. What has only the name of a joint, and does not fit,
    is noted.
    """
    coupler, found = Coupler(model, motors), Couplings()
    # sensors of a motor's current come behind the motor
    for wish in sorted(wishes, key=lambda one: _entity(one) == "sigma_delta_adc"):
        entity = _entity(wish)
        kind = _KINDS.get(entity)
        if "below" in wish.own or "above" in wish.own:
            kind = _couple_switch
        elif entity == "gpio" and not wish.own:
            continue  # its pins may be anything
        if kind is None:
            if wish.own:
                near = get_close_matches(entity, _KINDS, 1, 0.5)
                raise wish.refused(
                    f"{entity} is at no joint: {', '.join(near or _KINDS)} can be; write a plant of your own"
                )
            continue
        try:
            kind(wish, coupler, found)
        except UnityLinkError as error:
            places = _SENSED.get(entity, PLACES)
            if wish.own or any(place in wish.said for place in places):
                raise
            found.notes.append(str(error))
    if found.drives:
        mujoco.mj_setConst(model, mujoco.MjData(model))  # what follows from inertia
    return found


def _entity(wish: PartWish) -> str:
    assert wish.instance.component is not None
    return wish.instance.component.entity


def _couple_encoder(wish: PartWish, coupler: Coupler, into: Couplings) -> None:
    wish.check_keys(("joint", "sign", "unit", "scale"))
    joint = coupler.needed_joint(wish)
    a_count = si_of_count(wish, "position", joint.unit)
    per_turn = abs(2 * math.pi / a_count)
    facts: dict[str, Any] = dict(wish.instance.component.generics) if wish.instance.component else {}
    index = 0
    if facts.get("with_index"):
        if joint.unit != "rad" or abs(per_turn - round(per_turn)) > _WHOLE * per_turn:
            raise wish.refused(
                f"its index is at each turn, and a turn of joint {joint.name} has {per_turn:g} counts"
                if joint.unit == "rad"
                else f"its index is at each turn, and joint {joint.name} is a slide; leave with_index out"
            )
        index = round(per_turn)
    into.shown.add(("position", joint.position))
    turned = a_count * int(wish.get("sign", 1))
    into.senses.append(
        (
            wish.path,
            lambda outside: ShownEncoder(outside.pins, outside.data, joint.position, turned, per_turn=index),
        )
    )


def _couple_bank(wish: PartWish, coupler: Coupler, into: Couplings) -> None:
    wish.check_keys(("joint", "sign", "unit", "scale", "channel"))
    joint, channel = coupler.needed_joint(wish), int(wish.get("channel", 0))
    turned = si_of_count(wish, "position", joint.unit) * int(wish.get("sign", 1))
    into.shown.add(("position", joint.position))
    into.senses.append(
        (
            wish.path,
            lambda outside: ShownEncoder(outside.pins, outside.data, joint.position, turned, channel=channel),
        )
    )


def _couple_absolute(wish: PartWish, coupler: Coupler, into: Couplings) -> None:
    wish.check_keys(("joint", "sign", "unit", "scale", "zero"))
    joint = coupler.needed_joint(wish)
    a_count, sign = si_of_count(wish, "position", joint.unit), int(wish.get("sign", 1))
    own = wish.get("unit") or value_unit(wish, "position")
    assert wish.instance.component is not None
    facts: dict[str, Any] = dict(wish.instance.component.generics)
    zero = int(facts["zero"]) + float(wish.get("zero", 0.0)) * factor_of(wish, joint.unit, own) / a_count
    into.shown.add(("position", joint.position))
    into.senses.append(
        (
            wish.path,
            lambda outside: ShownAbsolute(outside.pins, outside.data, joint, sign * a_count, zero),
        )
    )


def _couple_hall(wish: PartWish, coupler: Coupler, into: Couplings) -> None:
    wish.check_keys(("joint", "sign", "unit", "scale", "zero"))
    joint = coupler.needed_joint(wish)
    sign, a_sector = int(wish.get("sign", 1)), si_of_count(wish, "position", joint.unit)
    unit = wish.get("unit") or value_unit(wish, "position")
    zero = sign * float(wish.get("zero", 0.0)) * (factor_of(wish, joint.unit, unit) if unit else 1.0)
    into.shown.add(("position", joint.position))
    into.senses.append(
        (
            wish.path,
            lambda outside: ShownHall(outside.pins, outside.data, joint.position, sign * a_sector, zero),
        )
    )


def _couple_switch(wish: PartWish, coupler: Coupler, into: Couplings) -> None:
    wish.check_keys(_SWITCH)
    joint = coupler.needed_joint(wish)
    port = wish.get("port") or ("pin_in" if _entity(wish) == "gpio" else "")
    if not port:
        raise wish.refused(f"say port: which input of the {_entity(wish)} the switch is at")
    sign, zero = int(wish.get("sign", 1)), float(wish.get("zero", 0.0))
    factor = sign / factor_of(wish, joint.unit, joint.unit)
    said = {key: float(wish.get(key)) for key in ("below", "above", "hysteresis") if key in wish.said}
    level, bit = bool(wish.get("closed_level", 1)), int(wish.get("channel", 0))
    if ("below" in said) == ("above" in said):
        raise wish.refused("give either below or above, the position where it closes")
    into.senses.append(
        (
            wish.path,
            lambda outside: ShownSwitch(
                EndSwitch(outside.pins, port, bit, closed_level=level, **said),
                outside.data,
                joint.position,
                factor,
                zero,
            ),
        )
    )


def _couple_sonar(wish: PartWish, coupler: Coupler, into: Couplings) -> None:
    wish.check_keys(("sensor",))
    place = coupler.sensor(wish)
    if place.unit != "m":
        raise wish.refused(f"a sonar shows a distance, and {place} is none; name a rangefinder")
    into.senses.append((wish.path, lambda outside: ShownDistance(outside.pins, outside.data, place.index)))


def _couple_load_cell(wish: PartWish, coupler: Coupler, into: Couplings) -> None:
    wish.check_keys(("sensor", "sign", "zero", "unit", "scale"))
    place = coupler.sensor(wish)
    if place.unit != "N":
        raise wish.refused(f"a load cell shows a force, and {place} is none; name a force or touch sensor")
    a_count = int(wish.get("sign", 1)) * si_of_count(wish, "value", "N")
    own = wish.get("unit") or value_unit(wish, "value")
    zero = int(wish.get("sign", 1)) * float(wish.get("zero", 0.0)) * factor_of(wish, "N", own)
    into.senses.append(
        (wish.path, lambda outside: ShownForce(outside.pins, outside.data, place.index, a_count, zero))
    )


def _couple_currents(wish: PartWish, coupler: Coupler, into: Couplings) -> None:
    wish.check_keys(("joint", "full_scale_a"))
    joint = coupler.needed_joint(wish)
    if joint.number not in into.motors:
        raise wish.refused(f"no component with a motor drives joint {joint.name}, so it has no current")
    assert wish.instance.component is not None
    facts: dict[str, Any] = dict(wish.instance.component.generics)
    channels = int(facts["channels"])
    if "full_scale_a" in wish.said:
        amps = float(wish.get("full_scale_a"))
    else:
        amps = si_of_count(wish, "value", "A") * int(facts["osr"]) ** 3 / 2
    into.senses.append(
        (wish.path, lambda outside: ShownCurrents(outside.pins, outside.drives[joint.number], channels, amps))
    )


_KINDS: dict[str, Callable[[PartWish, Coupler, Couplings], None]] = {
    "h_bridge": couple_bridge,
    "pwm": couple_bridge,
    "three_phase_pwm": couple_inverter,
    "dshot": couple_dshot,
    "servo_bus": couple_servo_bus,
    "stepgen": couple_stepgen,
    "quadrature_encoder": _couple_encoder,
    "encoder_bank": _couple_bank,
    "absolute_encoder": _couple_absolute,
    "hall": _couple_hall,
    "gpio": _couple_switch,
    "sonar": _couple_sonar,
    "hx711": _couple_load_cell,
    "sigma_delta_adc": _couple_currents,
}
