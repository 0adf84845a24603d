# SPDX-License-Identifier: BSD-3-Clause
"""The paper's SCARA robot: two revolute joints, a vertical axis and a rotating tool, each behind a position
servo.

Registers of a joint, as in Fig. 1 of the paper (units: counts; 100 counts are 1 degree, or 1 mm for the
vertical axis):

    cpos    READ   signed    encoder position, counts
    spd     READ   unsigned  magnitude of the speed, counts/s
    pos_sp  WRITE  signed    position set-point, counts; beyond a mechanical stop it means the stop
    spd_sp  WRITE  unsigned  speed limit of the move, counts/s; 0 holds the joint where it is
"""

from __future__ import annotations

import math

from unitylink.errors import UnityLinkError
from unitylink.spec.model import Instance, Spec

from ..registers import Registers
from .axis import Axis, Joint

COUNTS_PER_UNIT = 100.0  # per degree of a rotary joint, per millimetre of the vertical axis

JOINTS = (
    Joint("shoulder", "°", -150.0, 150.0, 360.0, 1800.0),
    Joint("elbow", "°", -145.0, 145.0, 540.0, 2700.0),
    Joint("lift", "mm", 0.0, 150.0, 400.0, 4000.0, inertia=1.1),
    Joint("tool", "°", -360.0, 360.0, 1080.0, 9000.0, inertia=0.9),
)


class ScaraPlant:
    """Four joints behind the first four instances of the spec with cpos, spd, pos_sp and spd_sp.

    They start at zero. The plant is deterministic: it depends only on the registers and the number of steps.
    """

    period_s = 0.001

    def __init__(self) -> None:
        self.axes = tuple(Axis(joint) for joint in JOINTS)
        self._commanded: list[int] = []  # addresses: of each joint its pos_sp and spd_sp
        self._measured: list[int] = []  # and its cpos and spd
        self._registers: Registers | None = None

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        """Find the joints' registers. Raise UnityLinkError if the spec does not have four joints."""
        joints = [words for root in spec.roots for words in _joints(root)] if spec else []
        if len(joints) < len(JOINTS):
            raise UnityLinkError(
                f"plant scara: the spec has {len(joints)} of the {len(JOINTS)} joints it needs "
                "(instances with cpos, spd, pos_sp and spd_sp); choose another plant, such as ramp"
            )
        joints = joints[: len(JOINTS)]
        self._commanded = [words[name] for words in joints for name in ("pos_sp", "spd_sp")]
        self._measured = [words[name] for words in joints for name in ("cpos", "spd")]
        self._sign = 1 << registers.data_bits - 1
        self._registers = registers

    def step(self, time_s: float) -> None:
        registers = self._registers
        if registers is None:
            raise UnityLinkError("plant scara: step() before attach()")
        # The further the forearm is stretched out, the heavier the arm is to turn.
        stretched = 0.75 + 0.25 * math.cos(math.radians(self.axes[1].position))
        words = iter(registers.read_many(self._commanded))
        sign, period_s = self._sign, self.period_s
        shown: list[int] = []
        for axis, set_point, speed_limit in zip(self.axes, words, words, strict=True):
            axis.step(
                ((set_point ^ sign) - sign) / COUNTS_PER_UNIT,
                speed_limit / COUNTS_PER_UNIT,
                axis.joint.inertia * stretched,
                period_s,
            )
            stretched = 1.0  # it is the shoulder that turns the arm
            shown += (round(axis.position * COUNTS_PER_UNIT), round(abs(axis.speed) * COUNTS_PER_UNIT))
        registers.write_many(self._measured, shown)


def _joints(instance: Instance) -> list[dict[str, int]]:
    found = {element.name: element.address for element in instance.elements}
    words = []
    if found.keys() >= {"cpos", "spd", "pos_sp", "spd_sp"}:
        words.append(found)
    for inner in instance.instances:
        words += _joints(inner)
    return words
