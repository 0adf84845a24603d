# SPDX-License-Identifier: BSD-3-Clause
"""A servo on the line of `servo_bus`, as a plant uses it."""

from __future__ import annotations

from unitylink.errors import ValueRangeError

from .device_registers import DeviceRegisters

_ALARM = 255
# Registers of the torque, of the goal, and of what is measured: place, bytes, and the bit of the sign.
_DYNAMIXEL = {"torque": (64, 1), "goal": (116, 4), "position": (132, 4), "speed": (128, 4), "load": (126, 2)}
_FEETECH = {"torque": (40, 1), "goal": (42, 2), "position": (56, 2), "speed": (58, 2), "load": (60, 2)}
_SIGN_BITS = {"goal": 15, "position": 15, "speed": 15, "load": 10}


class BusServo:
    """A servo. It takes the torque and the goal, and answers with what a plant says that it measures.

        servo = board.components["arm"].servo(0)
        if servo.torque:
            servo.tell(position=servo.goal)
        servo.plugged = False  # it neither hears nor answers

    Numbers are counts, as in its registers. `registers` is its control table: 256 bytes. Calls may come
    from any thread. Raises ValueRangeError for a number that its registers cannot hold.
    """

    def __init__(self, registers: DeviceRegisters, feetech: bool) -> None:
        self.registers = registers
        self._feetech = feetech
        self._places = _FEETECH if feetech else _DYNAMIXEL

    @property
    def plugged(self) -> bool:
        """Whether the servo is there."""
        return self.registers.plugged

    @plugged.setter
    def plugged(self, plugged: bool) -> None:
        self.registers.plugged = plugged

    @property
    def torque(self) -> bool:
        """Whether its torque is on."""
        return self._word("torque") != 0

    @property
    def goal(self) -> int:
        """The position to which it shall go."""
        return self._word("goal")

    @property
    def position(self) -> int:
        """The position that it tells."""
        return self._word("position")

    def tell(self, position: float, speed: float = 0, load: float = 0, *, alarm: int = 0) -> None:
        """Let it measure this from now on. Fractions are rounded.

        Loads of Feetech are -1023 to 1023. `alarm` is the error byte of its replies.
        """
        first = min(place for place, _ in (self._places[name] for name in ("position", "speed", "load")))
        words = {"position": position, "speed": speed, "load": load}
        text = bytearray(sum(self._places[name][1] for name in words))
        for name, value in words.items():
            place, size = self._places[name]
            text[place - first : place - first + size] = self._coded(name, round(value))
        self.registers[first : first + len(text)] = bytes(text)
        self.registers[_ALARM] = alarm

    def _word(self, name: str) -> int:
        place, size = self._places[name]
        found = self.registers[place : place + size]
        assert isinstance(found, bytes)
        if not self._feetech:
            return int.from_bytes(found, "little", signed=size > 1)
        word, sign = int.from_bytes(found, "little"), 1 << _SIGN_BITS.get(name, 15)
        return -(word & (sign - 1)) if word & sign else word

    def _coded(self, name: str, value: int) -> bytes:
        _, size = self._places[name]
        most = (1 << _SIGN_BITS[name]) - 1 if self._feetech else (1 << (8 * size - 1)) - 1
        if not -most <= value <= most:
            raise ValueRangeError(f"the {name} of a servo is {-most} to {most}, not {value}")
        if self._feetech and value < 0:
            value = most + 1 - value
        return value.to_bytes(size, "little", signed=not self._feetech)
