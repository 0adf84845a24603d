# SPDX-License-Identifier: BSD-3-Clause
"""What the plugins of a configuration become: components, and words at pins."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from .devices import DEVICES
from .left_out import KINDS, NO_COMPONENT, left_out
from .part import PartList, bit_type, chunks
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


class Parts(PartList):
    """Makes the parts.

    `notes` gets what has no counterpart. `clock_hz` is that of the design. With `inches` the lengths of the
    file are inches.
    """

    def __init__(self, plugins: Sequence[Plugin], notes: list[str], *, clock_hz: int, inches: bool) -> None:
        super().__init__(notes, clock_hz)
        self.plugins, self.inches = plugins, inches
        self.axes_most = max(1, min(AXES_MOST, clock_hz // AXIS_HZ))
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
        for kind, make_device in DEVICES.items():
            make_device(self, [one for one in plugins if one.kind == kind])
        made = {kind for kinds in makers.values() for kind in kinds} | DEVICES.keys()
        for one in plugins:
            if one.kind in made:
                self.notes += left_out(one.node)
            elif one.kind != "fpga":
                self.leave_out(one, KINDS.get(one.kind, NO_COMPONENT))

    def _steppers(self, plugins: list[Plugin]) -> None:
        scales: dict[str, list[Plugin]] = {}
        for one in plugins:
            scales.setdefault(self._scale(one), []).append(one)
        for scale, same in scales.items():
            for axes in chunks(same, self.axes_most):
                name = self.new_name(axes[0].name if len(axes) == 1 else "motors")
                comments = [f"axis {i} is {one.name}{self._limits(one)}" for i, one in enumerate(axes)]
                line = f"stepgen(axes={len(axes)}{scale}, {RATE})"
                pins = {"step": [self.plain(one, "step") for one in axes]}
                pins["direction"] = [one.pins.get("dir") for one in axes]
                for port in _SWITCHES.values():
                    pins[port] = [self._switch(one, port) for one in axes]
                self.add(name, line, comments, pins)
                for one in axes:
                    self.output(one, "en", f"{one.name}_enable")

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
            hertz = self.whole(one, "frequency", 10_000, 10, 1_000_000)
            pins = {"pins": [self.plain(one, "out1"), self.plain(one, "out2"), None, None]}
            line = f"h_bridge(form=1, frequency_hz={hertz})"
            self.add(self.new_name(one.name), line, [f"{one.name}: pin 0 is IN1, pin 1 is IN2"], pins)
            self.output(one, "en", f"{one.name}_enable")

    def _pwms(self, plugins: list[Plugin]) -> None:
        periods: dict[int, list[Plugin]] = {}
        for one in plugins:
            periods.setdefault(self.whole(one, "frequency", 10_000, 10, 1_000_000), []).append(one)
        for hertz, same in periods.items():
            for channels in chunks(same, CHANNELS_MOST):
                name = self.new_name(channels[0].name if len(channels) == 1 else "pwms")
                comments = [f"channel {i} is {one.name}" for i, one in enumerate(channels)]
                pins = {"pins": [self.plain(one, "pwm") for one in channels]}
                self.add(name, f"pwm(channels={len(channels)}, frequency_hz={hertz})", comments, pins)
                for one in channels:
                    self.output(one, "dir", f"{one.name}_direction")
                    self.output(one, "en", f"{one.name}_enable")

    def _servos(self, plugins: list[Plugin]) -> None:
        for channels in chunks(plugins, CHANNELS_MOST):
            comments = [f"channel {i} is {one.name}" for i, one in enumerate(channels)]
            comments.append("-100 of riocore is 1000 us, and 100 is 2000 us")
            for one in channels:
                hertz = one.node.get("frequency")
                if hertz is not None and self.whole(one, "frequency", SERVO_HZ, 20, 150) != SERVO_HZ:
                    self.notes.append(
                        f"{hertz.place} = {hertz.value}: our servos get {SERVO_HZ} pulses a second"
                    )
            name = self.new_name(channels[0].name if len(channels) == 1 else "servos")
            pins = {"pins": [self.plain(one, "pwm") for one in channels]}
            self.add(name, f"rc_servo(channels={len(channels)})", comments, pins)

    def _encoders(self, plugins: list[Plugin]) -> None:
        for one in plugins:
            divided = 1 << self.whole(one, "quad_type", 2, 0, 4)
            turned = sum(one.pins[line].inverted for line in ("a", "b") if line in one.pins) == 1
            scale = f"{'-' if turned else ''}1{f'/{divided}' if divided > 1 else ''} count"
            each = "each edge is a count" if divided == 1 else f"a count is {divided} edges"
            comments = [f"{one.name}: {each}, as in riocore"]
            pins = {"a": [one.pins.get("a")], "b": [one.pins.get("b")]}
            more = ""
            if one.kind == "quadencoderz":
                pins["index"] = [self.plain(one, "z")]
                more = ", with_index=1"
            line = f"quadrature_encoder(scale={scale}, {RATE}{more})"
            self.add(self.new_name(one.name), line, comments, pins)

    def _inputs(self, plugins: list[Plugin]) -> None:
        changes = 0
        for one in plugins:
            pin = one.pins.get("bit")
            if pin is None:
                self.leave_out(one, "it has no pin")
            elif one not in self.switches.values():
                changes += 1
                when = "on change" if changes <= CHANGES_MOST else "10 Hz"
                self.add(self.new_name(one.name), f"{bit_type(pin)} READ(PUBLISH({when}))", [], {"": [pin]})

    def _outputs(self, plugins: list[Plugin]) -> None:
        for one in plugins:
            if not self.output(one, "bit", one.name):
                self.leave_out(one, "it has no pin")


def _number(value: float) -> str:
    return str(int(value)) if value == int(value) else repr(value)
