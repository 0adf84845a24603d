# SPDX-License-Identifier: BSD-3-Clause
"""Any robot with position servos: a joint is behind every instance with a set-point and a position."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from unitylink.errors import UnityLinkError
from unitylink.spec.model import Element, Instance, Spec
from unitylink.values import Codec, Quantity

from ..registers import Registers
from .axis import Axis, Joint


@dataclass(frozen=True)
class ServoNames:
    """The names of the elements of one servo, which are together in an instance.

    The speeds may be missing.
    """

    position: str
    set_point: str
    speed: str = ""
    speed_limit: str = ""


@dataclass(frozen=True)
class _Servo:
    axis: Axis
    position: tuple[int, Codec]
    set_point: tuple[int, Codec]
    speed: tuple[int, Codec] | None
    speed_limit: tuple[int, Codec] | None


class ServoPlant:
    """Every servo of the spec follows its set-point as `joint` says. It starts at zero.

    Registers are in engineering units. Without a scale in the spec, they count in steps of `step` (with
    0.001, a count is 1 mrad or 1 mm). The plant is deterministic: it depends only on the registers and the
    number of steps.
    """

    period_s = 0.002

    def __init__(self, names: list[ServoNames], joint: Joint, *, step: float = 0.001) -> None:
        self.names = names
        self.joint = joint
        self.step_size = step
        self.servos: list[_Servo] = []
        self._registers: Registers | None = None

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        """Find the servos. Raise UnityLinkError if the spec has none."""
        self._registers = registers
        self.servos = []
        for root in spec.roots if spec else ():
            for instance in _instances(root):
                self.servos += self._of(instance, registers.data_bits)
        if not self.servos:
            wanted = "; ".join(f"{one.position} and {one.set_point}" for one in self.names)
            raise UnityLinkError(f"servo plant: no instance of the spec has {wanted}; choose another plant")

    def _of(self, instance: Instance, data_bits: int) -> Iterator[_Servo]:
        elements = {element.name: element for element in instance.elements}

        def found(name: str) -> tuple[int, Codec] | None:
            return self._register(elements[name], data_bits) if name in elements else None

        for names in self.names:
            position, set_point = found(names.position), found(names.set_point)
            if position is not None and set_point is not None:
                speeds = found(names.speed), found(names.speed_limit)
                yield _Servo(Axis(self.joint), position, set_point, *speeds)

    def _register(self, element: Element, data_bits: int) -> tuple[int, Codec]:
        quantity = replace(Quantity.of(element), overflow="saturate")  # a sensor stops at its limit
        if not quantity.scaled and quantity.type.kind != "float":
            quantity = replace(quantity, scale=self.step_size)
        return element.address, Codec(element.path, quantity, data_bits)

    def step(self, time_s: float) -> None:
        registers = self._registers
        if registers is None:
            raise UnityLinkError("servo plant: step() before attach()")
        for servo in self.servos:
            address, codec = servo.set_point
            set_point = codec.decode(registers[address])
            limit = math.inf
            if servo.speed_limit is not None:
                address, codec = servo.speed_limit
                limit = codec.decode(registers[address])
            servo.axis.step(set_point, limit, servo.axis.joint.inertia, self.period_s)
            address, codec = servo.position
            registers[address] = codec.encode(servo.axis.position)
            if servo.speed is not None:
                address, codec = servo.speed
                registers[address] = codec.encode(servo.axis.speed)


def _instances(instance: Instance) -> Iterator[Instance]:
    yield instance
    for inner in instance.instances:
        yield from _instances(inner)
