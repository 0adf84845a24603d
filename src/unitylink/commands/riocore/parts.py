# SPDX-License-Identifier: BSD-3-Clause
"""What the plugins of a configuration become: components, and words at pins."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from ..spec_names import Names
from .left_out import KINDS, NO_COMPONENT, left_out
from .plugins import Plugin, PluginPin

AXES_MOST = 8  # of one stepgen
AXIS_HZ = 5_898_240  # of the clock, which stepgen needs for each axis
CHANNELS_MOST = 64  # of one pwm
CHANGES_MOST = 60  # words in the frame of a publish on change
SPEED_MOST, ACCELERATION_MOST = 1_048_575, 67_108_800  # of stepgen, in count/s and count/s^2
RATE = "rate=100 Hz"
SERVO_HZ = 50
_AXES = "XYZABCUVW"
_SWITCHES = {"home-sw-in": "home", "neg-lim-sw-in": "limit_low", "pos-lim-sw-in": "limit_high"}
_VHDL = frozenset(
    ("in", "out", "signal", "label", "reset", "clock", "range", "process", "port", "wait", "on")
)


@dataclass
class Part:
    """A member of the spec: `line` after the name, comments before it, and the pins of its ports.

    A word at a pin has one port, which is called "".
    """

    name: str
    line: str
    comments: list[str]
    pins: dict[str, list[PluginPin | None]]

    @property
    def is_word(self) -> bool:
        return "" in self.pins


class Parts:
    """Makes the parts.

    `notes` gets what has no counterpart. `clock_hz` is that of the design. With `inches` the lengths of the
    file are inches.
    """

    def __init__(self, plugins: Sequence[Plugin], notes: list[str], *, clock_hz: int, inches: bool) -> None:
        self.plugins, self.notes, self.inches = plugins, notes, inches
        self.axes_most = max(1, min(AXES_MOST, clock_hz // AXIS_HZ))
        self.names = Names()
        self.found: list[Part] = []
        self.switches = self._switches()
        makers: dict[Callable[[list[Plugin]], None], tuple[str, ...]] = {
            self._steppers: ("stepdir",),
            self._bridges: ("hbridge",),
            self._pwms: ("pwmout",),
            self._servos: ("rcservo",),
            self._encoders: ("quadencoder", "quadencoderz"),
            self._inputs: ("bitin",),
            self._outputs: ("bitout",),
        }
        for make, kinds in makers.items():
            make([one for one in plugins if one.kind in kinds])
        made = {kind for kinds in makers.values() for kind in kinds}
        for one in plugins:
            if one.kind in made:
                self.notes += left_out(one.node)
            elif one.kind != "fpga":
                why = KINDS.get(one.kind, NO_COMPONENT)
                self.notes.append(f"{one.node.place} ({one.kind} {one.name}): left out: {why}")

    def _steppers(self, plugins: list[Plugin]) -> None:
        scales: dict[str, list[Plugin]] = {}
        for one in plugins:
            scales.setdefault(self._scale(one), []).append(one)
        for scale, same in scales.items():
            for axes in _chunks(same, self.axes_most):
                name = self._name(axes[0].name if len(axes) == 1 else "motors")
                comments = [f"axis {i} is {one.name}{self._limits(one)}" for i, one in enumerate(axes)]
                line = f"stepgen(axes={len(axes)}{scale}, {RATE})"
                pins = {"step": [self._plain(one, "step") for one in axes]}
                pins["direction"] = [one.pins.get("dir") for one in axes]
                for port in _SWITCHES.values():
                    pins[port] = [self._switch(one, port) for one in axes]
                self._add(name, line, comments, pins)
                for one in axes:
                    self._output(one, "en", f"{one.name}_enable")

    def _scale(self, one: Plugin) -> str:
        """Return the length of a step, and whether the axis is reversed, as parameters of stepgen."""
        joint = one.node.get("joint")
        scale = joint.number("scale") if joint is not None else None
        turned = ", reversed=1" if self._is_reversed(one) else ""
        if scale is None:
            return turned
        if joint is not None and not 1e-6 <= abs(scale) <= 1e9:
            where = joint.get("scale")
            assert where is not None
            raise where.wrong("steps per unit, 1e-6 to 1e9, are expected")
        angle = one.node.text("axis").upper() in ("A", "B", "C")
        length = "1 deg" if angle else "25.4 mm" if self.inches else "1 mm"
        number, unit = length.split()
        return f", scale={number}/{_number(abs(scale))} {unit}{turned}"

    def _is_reversed(self, one: Plugin) -> bool:
        """Tell whether its position grows where `direction` of stepgen is low."""
        joint = one.node.get("joint")
        scale = joint.number("scale") if joint is not None else None
        return ("dir" in one.pins and one.pins["dir"].inverted) != (scale is not None and scale < 0)

    def _limits(self, one: Plugin) -> str:
        joint = one.node.get("joint")
        if joint is None:
            return ""
        scale = abs(joint.number("scale") or 1.0)
        told = []
        for key, most, unit in (
            ("max_velocity", SPEED_MOST, "count/s"),
            ("max_acceleration", ACCELERATION_MOST, "count/s^2"),
        ):
            value = joint.number(key)
            if value is not None:
                told.append(f"{_number(round(abs(value) * scale))} {unit}")
                if abs(value) * scale > most:
                    self.notes.append(f"{joint.place}.{key}: {told[-1]} is more than the {most} of stepgen")
        return f": at most {', '.join(told)}" if told else ""

    def _switches(self) -> dict[tuple[int, str], Plugin]:
        """Return which bitin is a switch of which joint, by (joint, input of stepgen)."""
        # LinuxCNC numbers joints. The file has them in some order, and each may have an axis.
        in_file = [one for one in self.plugins if one.joint is not None]
        by_axis = sorted(in_file, key=lambda one: (_AXES + " ").find(one.node.text("axis", " ").upper()[0]))
        found: dict[tuple[int, str], Plugin] = {}
        for one in self.plugins:
            nets = re.split(r"[,\s]+", one.nets.get("bit", "")) if one.kind == "bitin" else []
            tokens = [token for net in nets if (token := re.fullmatch(r"joint\.(\d{1,3})\.(.+)", net))]
            for token in tokens:
                joint, port = int(token[1]), _SWITCHES.get(token[2])
                place = f"{one.node.place} ({one.kind} {one.name})"
                if port is None or joint >= len(in_file) or in_file[joint].kind != "stepdir":
                    continue
                if in_file[joint] is not by_axis[joint]:
                    self.notes.append(f"{place}: joint {joint} is not certain, so it is a word of its own")
                    continue
                if one.pins.get("bit") and one.pins["bit"].inverted:
                    self.notes.append(f"{place}: inverted, so it is a word and no input of stepgen")
                    continue
                if port != "home" and self._is_reversed(in_file[joint]):
                    # limit_low of stepgen is where `direction` is low
                    port = "limit_high" if port == "limit_low" else "limit_low"
                if one in found.values() or (joint, port) in found:
                    self.notes.append(f"{place}: {token[0]}: one switch is one input; it has another already")
                else:
                    found[joint, port] = one
        return found

    def _switch(self, one: Plugin, port: str) -> PluginPin | None:
        switch = self.switches.get((one.joint, port)) if one.joint is not None else None
        if switch is None:
            return None
        signals = switch.node.get("signals")
        bit = signals.get("bit") if signals is not None else None
        if bit is not None:
            bit.get("net")
        return switch.pins.get("bit")

    def _bridges(self, plugins: list[Plugin]) -> None:
        for one in plugins:
            hertz = self._whole(one, "frequency", 10_000, 10, 1_000_000)
            pins = {"pins": [self._plain(one, "out1"), self._plain(one, "out2"), None, None]}
            line = f"h_bridge(form=1, frequency_hz={hertz})"
            self._add(self._name(one.name), line, [f"{one.name}: pin 0 is IN1, pin 1 is IN2"], pins)
            self._output(one, "en", f"{one.name}_enable")

    def _pwms(self, plugins: list[Plugin]) -> None:
        periods: dict[int, list[Plugin]] = {}
        for one in plugins:
            periods.setdefault(self._whole(one, "frequency", 10_000, 10, 1_000_000), []).append(one)
        for hertz, same in periods.items():
            for channels in _chunks(same, CHANNELS_MOST):
                name = self._name(channels[0].name if len(channels) == 1 else "pwms")
                comments = [f"channel {i} is {one.name}" for i, one in enumerate(channels)]
                pins = {"pins": [self._plain(one, "pwm") for one in channels]}
                self._add(name, f"pwm(channels={len(channels)}, frequency_hz={hertz})", comments, pins)
                for one in channels:
                    self._output(one, "dir", f"{one.name}_direction")
                    self._output(one, "en", f"{one.name}_enable")

    def _servos(self, plugins: list[Plugin]) -> None:
        for channels in _chunks(plugins, CHANNELS_MOST):
            comments = [f"channel {i} is {one.name}" for i, one in enumerate(channels)]
            comments.append("-100 of riocore is 1000 us, and 100 is 2000 us")
            for one in channels:
                hertz = one.node.get("frequency")
                if hertz is not None and self._whole(one, "frequency", SERVO_HZ, 20, 150) != SERVO_HZ:
                    self.notes.append(
                        f"{hertz.place} = {hertz.value}: our servos get {SERVO_HZ} pulses a second"
                    )
            name = self._name(channels[0].name if len(channels) == 1 else "servos")
            pins = {"pins": [self._plain(one, "pwm") for one in channels]}
            self._add(name, f"rc_servo(channels={len(channels)})", comments, pins)

    def _encoders(self, plugins: list[Plugin]) -> None:
        for one in plugins:
            divided = 1 << self._whole(one, "quad_type", 2, 0, 4)
            turned = sum(one.pins[line].inverted for line in ("a", "b") if line in one.pins) == 1
            scale = f"{'-' if turned else ''}1{f'/{divided}' if divided > 1 else ''} count"
            each = "each edge is a count" if divided == 1 else f"a count is {divided} edges"
            comments = [f"{one.name}: {each}, as in riocore"]
            pins = {"a": [one.pins.get("a")], "b": [one.pins.get("b")]}
            more = ""
            if one.kind == "quadencoderz":
                pins["index"] = [self._plain(one, "z")]
                more = ", with_index=1"
            line = f"quadrature_encoder(scale={scale}, {RATE}{more})"
            self._add(self._name(one.name), line, comments, pins)

    def _inputs(self, plugins: list[Plugin]) -> None:
        changes = 0
        for one in plugins:
            pin = one.pins.get("bit")
            if pin is None:
                self.notes.append(f"{one.node.place} ({one.kind} {one.name}): left out: it has no pin")
            elif one not in self.switches.values():
                changes += 1
                when = "on change" if changes <= CHANGES_MOST else "10 Hz"
                self._add(self._name(one.name), f"{_bit(pin)} READ(PUBLISH({when}))", [], {"": [pin]})

    def _outputs(self, plugins: list[Plugin]) -> None:
        for one in plugins:
            if not self._output(one, "bit", one.name):
                self.notes.append(f"{one.node.place} ({one.kind} {one.name}): left out: it has no pin")

    def _output(self, one: Plugin, role: str, name: str) -> bool:
        pin = one.pins.get(role)
        if pin is not None:
            off = pin.inverted if pin.error_level is None else pin.error_level
            safe = ("on" if off != pin.inverted else "off") if pin.inverted else int(off)
            self._add(self._name(name), f"{_bit(pin)} WRITE(SAFE={safe})", [], {"": [pin]})
        return pin is not None

    def _plain(self, one: Plugin, role: str) -> PluginPin | None:
        """Return a pin of a component. Only the board can invert it."""
        pin = one.pins.get(role)
        if pin is not None and pin.inverted:
            self.notes.append(
                f'{pin.node.place}: invert: mark the pin active = "low" in a board.toml of your own'
            )
        return pin

    def _whole(self, one: Plugin, key: str, default: int, least: int, most: int) -> int:
        value = one.node.number(key, default)
        if value is None or value != int(value) or not least <= value <= most:
            where = one.node.get(key)
            assert where is not None
            raise where.wrong(f"a whole number from {least} to {most} is expected")
        return int(value)

    def _name(self, wanted: str) -> str:
        snake = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", wanted).lower()
        plain = re.sub(r"[^a-z0-9]+", "_", snake).strip("_") or "part"
        plain = f"{plain}_pin" if plain in _VHDL else plain if plain[0].isalpha() else f"n_{plain}"
        return self.names.unique(plain)

    def _add(
        self, name: str, line: str, comments: list[str], pins: dict[str, list[PluginPin | None]]
    ) -> None:
        self.found.append(Part(name, line, comments, pins))


def _bit(pin: PluginPin) -> str:
    return "inverted" if pin.inverted else "bool"


def _number(value: float) -> str:
    return str(int(value)) if value == int(value) else repr(value)


def _chunks(found: list[Plugin], most: int) -> Iterator[list[Plugin]]:
    for first in range(0, len(found), most):
        yield found[first : first + most]
