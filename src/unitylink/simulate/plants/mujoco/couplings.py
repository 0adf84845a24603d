# SPDX-License-Identifier: BSD-3-Clause
"""Which component of a spec is at which joint or sensor of a model: as a wish says, or by name."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from typing import Any, NamedTuple, TypeVar

import mujoco  # type: ignore[import-untyped]

from unitylink.errors import UnityLinkError
from unitylink.interface.joint_names import plain

from ...components import BoardComponent, BoardComponents
from ...machine import DcMotorData
from .drives import Drive
from .model_joint import ModelJoint, joints_of
from .part_wish import PartWish
from .places import Place, kind_of, measured
from .shown import Shown

Found = TypeVar("Found")
_NO_JOINT = -1


class Outside(NamedTuple):
    """What a coupling is made from, each time when the board begins."""

    pins: BoardComponent
    data: Any
    drives: dict[int, Any]  # the motors made so far, by the number of their joint


@dataclass
class Couplings:
    """How components and model are coupled. `driven` and `shown` are places that need no value any more."""

    drives: list[tuple[str, int, Callable[[Outside], Drive]]] = field(default_factory=list)
    senses: list[tuple[str, Callable[[Outside], Shown]]] = field(default_factory=list)
    driven: dict[tuple[str, int], str] = field(default_factory=dict)  # actuator -> path of the component
    shown: set[tuple[str, int]] = field(default_factory=set)
    motors: set[int] = field(default_factory=set)  # joints that a motor with a current turns
    notes: list[str] = field(default_factory=list)

    def made(self, components: BoardComponents, data: Any) -> tuple[list[Drive], list[Shown]]:
        """Put all that is outside of the pins where the model is."""
        motors: dict[int, Any] = {}
        drives = []
        for path, joint, make in self.drives:
            drives.append(make(Outside(components[path], data, motors)))
            motors[joint] = drives[-1]
        return drives, [make(Outside(components[path], data, motors)) for path, make in self.senses]

    def drive(
        self, wish: PartWish, joint: ModelJoint, actuator: int | None, make: Callable[[Outside], Drive]
    ) -> None:
        """Add what a component drives. Raises UnityLinkError if another one does already."""
        key = ("actuator", actuator) if actuator is not None else ("joint", joint.number)
        self._drive(wish, key, f"joint {joint.name}", joint.number, make)

    def drive_actuator(
        self, wish: PartWish, actuator: int, name: str, make: Callable[[Outside], Drive]
    ) -> None:
        """The same for an actuator that may be at no joint."""
        self._drive(wish, ("actuator", actuator), f"actuator {name}", _NO_JOINT, make)

    def _drive(
        self, wish: PartWish, key: tuple[str, int], what: str, joint: int, make: Callable[[Outside], Drive]
    ) -> None:
        if key in self.driven:
            raise wish.refused(f"{self.driven[key]} drives {what} already; name another")
        self.driven[key] = wish.path
        self.drives.append((wish.path, joint, make))


class Coupler:
    """Finds joints and sensors of a model by name."""

    def __init__(self, model: Any, motors: Mapping[str, DcMotorData]) -> None:
        self.model, self.motors = model, motors
        self.joints = joints_of(model)
        self.sensors = [place for place in measured(model) if place.what == "sensor"]
        self._actuators = {model.actuator(number).name: number for number in range(model.nu)}

    def joint(self, wish: PartWish) -> ModelJoint | None:
        """Return the joint that is said, or that has the name of the component, or of the part around it.

        None if there is none of its name. Raises UnityLinkError for one that is said and is not there.
        """
        actuator, name = wish.get("actuator"), wish.get("joint")
        if actuator:
            joint = self._turned_by(_named(self._actuators, actuator, "actuator", wish), wish)
            if name and joint.name != name:
                raise wish.refused(f"actuator {actuator!r} is at joint {joint.name!r}, not at {name!r}")
            return joint
        if name:
            return _named(self.joints, name, "joint", wish)
        by_name = (joint for joint in self.joints.values() if plain(joint.name) in wish.names)
        return next(by_name, None)

    def needed_joint(self, wish: PartWish) -> ModelJoint:
        """Return the joint. Raises UnityLinkError if there is none."""
        joint = self.joint(wish)
        if joint is None:
            near = self._near(wish, self.joints)
            raise wish.refused(f'it belongs to no joint; say @mujoco(joint="…"); nearest: {near}')
        return joint

    def actuator(self, wish: PartWish, joint: ModelJoint, kind: str) -> int | None:
        """Return the actuator that is said, or the one at the joint that wants what the drive gives."""
        if name := wish.get("actuator"):
            number = self._actuators[name]
            if (number, kind) not in joint.actuators:
                what, there = {"effort": "motor"}.get(kind, kind), joint.other_actuators(self.model)
                raise wish.refused(f"{name!r} is no {what} actuator: joint {joint.name} has {there}")
            return number
        return joint.actuator_of(kind)

    def pusher(self, wish: PartWish) -> int:
        """Return the motor that is said, or the one at the joint, whose ctrlrange says what it can do most.

        It may be at no joint, as the thrust of a propeller is at a site.
        """
        name = wish.get("actuator")
        if name:
            number: int | None = _named(self._actuators, name, "actuator", wish)
        else:
            number = self.needed_joint(wish).actuator_of("effort")
        if (
            number is None
            or kind_of(self.model, number) != "effort"
            or not self.model.actuator_ctrllimited[number]
        ):
            what = f"actuator {name!r} is no motor with a ctrlrange" if name else "its joint has none"
            raise wish.refused(f'say motor="…", or name a motor with a ctrlrange by actuator="…"; {what}')
        return number

    def sensor(self, wish: PartWish) -> Place:
        """Return the sensor that is said, or that has the name of the component."""
        by_name = {place.name: place for place in self.sensors}
        if name := wish.get("sensor"):
            return _named(by_name, name, "sensor", wish)
        for place in self.sensors:
            if plain(place.name) in wish.names:
                return place
        near = self._near(wish, by_name)
        raise wish.refused(f'it belongs to no sensor; say @mujoco(sensor="…"); nearest: {near}')

    def _turned_by(self, number: int, wish: PartWish) -> ModelJoint:
        if int(self.model.actuator_trntype[number]) == int(mujoco.mjtTrn.mjTRN_JOINT):
            turned = int(self.model.actuator_trnid[number, 0])
            for joint in self.joints.values():
                if joint.number == turned:
                    return joint
        raise wish.refused(f"actuator {wish.get('actuator')!r} is at no hinge and at no slide")

    @staticmethod
    def _near(wish: PartWish, names: Iterable[str]) -> str:
        there = sorted(names)
        found = [near for name in sorted(wish.names) for near in get_close_matches(name, there, 2, 0.3)]
        return ", ".join(dict.fromkeys(found or there[:3])) or "none"


def _named(there: dict[str, Found], name: str, what: str, wish: PartWish) -> Found:
    if name not in there:
        near = get_close_matches(name, sorted(there), 3, 0.3) or sorted(there)[:3]
        raise UnityLinkError(
            f"{wish.path}: {wish.by}: the model has no {what} {name!r}; nearest: {', '.join(near) or 'none'}"
        )
    return there[name]
