# SPDX-License-Identifier: BSD-3-Clause
"""The program of a device on SPI, I²C or Modbus: from annotations to words of `bus_sequencer.vhd`.

`@sequence("spi", period=1 ms)` or `@sequence("i2c", address=0x68, period=1 ms)` says that there is a program.
`@setup("write", 0x11, 0x01)` is a step at the start, and `@cycle("read", 0x9D, words=7, bytes=2)` one of each
period. `docs/gateware/bus_sequencer.md` describes the words.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction

from ..text.syntax import AnnotationNode, Argument
from ..units import unit
from . import modbus
from .evaluate import Evaluator, Value
from .sequence_words import CHECK, CONTROL, FIRST, KEEP, LANE, LAST, RECEIVE

KINDS = ("sequence", "setup", "cycle")
MOST_WORDS = 27  # that a device may give: 32 less those of bus_sequencer
_MOST_ENTRIES = 256
_PAUSE_US = (
    1000  # before each set-up, so that a device that does not answer is asked a thousand times a second
)
_LONGEST_US = 2_000_000
_MOST_OUTPUTS = 8
# each bus, with its component and the addresses of its devices
_BUSES = {"spi": "spi_device", "i2c": "i2c_device", "modbus": "modbus_master"}
_ADDRESSES = {"i2c": (0x08, 0x77), "modbus": (1, 247)}

_WAIT, _SAMPLE, _COMMIT, _READY = (CONTROL | number << 11 for number in range(4))
_COARSE = 0x0400  # the time is in 256 us

_STEPS = {
    "wait": '`"wait", 1 ms`',
    "write": '`"write", 0x11, 0x01`',
    "check": '`"check", 0x75, reply=0x47`',
    "read": '`"read", 0x1D, words=7, bytes=2`',
    "exchange": '`"exchange", 0x06, 0x00, 0x00, keep=2`',
}
_OPTIONS = {"check": ("reply",), "read": ("words", "bytes", "order"), "exchange": ("words", "keep")}
_MODBUS_STEPS = {
    "wait": '`"wait", 1 ms`',
    "write": '`"write", 0x2000` for each period, `"write", 0x2000, 1` for a set-up',
    "read": '`"read", 0x100, words=2`',
}
_MODBUS_OPTIONS = {"read": ("words", "bytes", "order", "unit", "function"), "write": ("unit", "function")}


@dataclass
class Program:
    """The words of a program, as they are made."""

    bus: str
    address: int = 0
    words: list[int] = field(default_factory=list)
    values: int = 0
    outputs: int = 0

    def wait(self, microseconds: int) -> None:
        """Wait for the time that runs, then start this one.

        The longest part comes last: what follows is done while it runs.
        """
        coarse, fine = divmod(microseconds, 256)
        parts = [_COARSE | 255] * (coarse // 255)
        if coarse % 255:
            parts.insert(0, _COARSE | coarse % 255)
        if fine or not parts:
            parts.insert(0, fine)
        self.words += [_WAIT | part for part in parts]

    def frame(self, sent: list[int], received: list[int], *, keep: int = 0, words: int = 1) -> None:
        """Send bytes, then do `received`, which are words.

        Of the bytes sent the last replies are kept: `words` times `keep` of them.
        """
        lanes = [KEEP | lane * LANE for lane in reversed(range(keep))] * words
        frame = [
            byte | flags for byte, flags in zip(sent, [0] * (len(sent) - len(lanes)) + lanes, strict=True)
        ]
        if self.bus == "i2c":
            frame = [FIRST | self.address << 1, *frame] if frame else []
            if received:
                frame.append(FIRST | self.address << 1 | 1)
        frame += received
        frame[0] |= FIRST
        frame[-1] |= LAST
        self.words += frame
        self.values += words if keep else 0

    def text(self) -> str:
        return "".join(f"{word:04X}" for word in self.words)


def generics_of(
    nodes: list[AnnotationNode], evaluator: Evaluator, names: Mapping[str, Value], entity: str
) -> list[tuple[str, int | str]]:
    """Return the generics `program` and `values` for the steps of a constructor of `entity`.

    Return [] after a diagnostic.
    """
    return _Assembler(evaluator, names, entity).generics(nodes)


class _Assembler:
    def __init__(self, evaluator: Evaluator, names: Mapping[str, Value], entity: str) -> None:
        self.evaluator = evaluator
        self.names = names
        self.entity = entity
        self.good = True

    def generics(self, nodes: list[AnnotationNode]) -> list[tuple[str, int | str]]:
        heads = [node for node in nodes if node.name.text == "sequence"]
        if len(heads) != 1:
            self._report(nodes[-1], "a program has one `@sequence`", '`@sequence("spi", period=1 ms)`')
            return []
        program, period = self._head(heads[0])
        if program is None:
            return []
        for kind in ("setup", "cycle"):
            if kind == "setup":
                program.wait(_PAUSE_US)
                program.wait(0)
            else:
                program.words.append(_READY)
                again = len(program.words)
                program.wait(period)
                program.words.append(_SAMPLE)
            for node in nodes:
                if node.name.text == kind:
                    self._step(node, program)
        program.words.append(_COMMIT | again & 255)
        if not self.good:
            return []
        if len(program.words) > _MOST_ENTRIES:
            message = f"this program has {len(program.words)} words, and at most {_MOST_ENTRIES} fit"
            self._report(heads[0], message, "read fewer registers, or share them out over two devices")
        elif not 1 <= program.values <= MOST_WORDS:
            message = f"this program gives {program.values} values"
            self._report(heads[0], message, f"read 1 to {MOST_WORDS} words in all")
        elif program.outputs > _MOST_OUTPUTS or program.values + program.outputs > MOST_WORDS:
            message = f"this program writes {program.outputs} registers"
            self._report(heads[0], message, f"at most {_MOST_OUTPUTS}, {MOST_WORDS} with values")
        found: list[tuple[str, int | str]] = [("program", program.text()), ("values", program.values)]
        if program.bus == "modbus":
            found.append(("outputs", program.outputs))
        return found if self.good else []

    def _head(self, node: AnnotationNode) -> tuple[Program | None, int]:
        bus, options = self._arguments(node, ("period", "address"))
        name = self.evaluator.value(bus[0], self.names) if len(bus) == 1 else None
        if name not in _BUSES or "period" not in options or ("address" in options) != (name in _ADDRESSES):
            shown = '`@sequence("spi", period=1 ms)` or `@sequence("i2c", address=0x68, period=1 ms)`'
            self._report(node, "this is no `@sequence` of a program", shown)
            return None, 0
        others = [entity for one, entity in _BUSES.items() if one != name]
        if self.entity in others:  # their words look alike, and would be run as something else
            message = f"this is a program for {name}, and the component is `{self.entity}`"
            right = _BUSES[str(name)]
            self._report(node, message, f'`@component("{right}")`, or a `@sequence` for the other bus')
            return None, 0
        program = Program(str(name))
        if name in _ADDRESSES:
            low, high = _ADDRESSES[str(name)]
            program.address = self._number(options["address"], "the address of a device", low, high)
        return program, self._microseconds(options["period"], "a period")

    def _modbus_step(self, node: AnnotationNode, program: Program) -> None:
        """Read a register, or write it: a constant at the start, an output in each period."""
        arguments, options = self._arguments(node, ("words", "bytes", "order", "unit", "function"))
        step = self.evaluator.value(arguments[0], self.names) if arguments else None
        fits = set(options) <= set(_MODBUS_OPTIONS.get(str(step), ()))
        wanted = 3 if step == "write" and node.name.text == "setup" else 2
        if step not in _MODBUS_STEPS or not fits or len(arguments) != wanted:
            shown = _MODBUS_STEPS.get(str(step), ", ".join(_MODBUS_STEPS.values()))
            self._report(node, "this is no step of a program on modbus", shown)
            return
        if step == "wait":
            program.wait(self._microseconds(arguments[1], "a wait"))
            program.wait(0)
            return
        register = self._number(arguments[1], "a register", 0, 0xFFFF)
        unit_id = self._option(options, "unit", 1, 247, program.address)
        if step == "read":
            if node.name.text == "setup":
                self._report(node, "`read` is a step of each period", "write `@cycle` for `@setup`")
                return
            function = self._one_of(options, "function", (3, 4), 3)
            words = self._option(options, "words", 1, MOST_WORDS, 1)
            size = self._one_of(options, "bytes", (2, 4), 2)
            low_first = self._little(options.get("order"))
            program.words += modbus.read_words(unit_id, function, register, words, size, low_first=low_first)
            program.values += words
            return
        function = self._one_of(options, "function", (6, 16), 6)
        if node.name.text == "setup":
            value = modbus.constant(self._number(arguments[2], "the value of a register", 0, 0xFFFF))
            program.words += modbus.write_words(unit_id, function, register, value)
            return
        place, output = len(program.words), program.outputs & 7
        program.words += modbus.output_words(unit_id, function, register, output, place)
        program.outputs += 1

    def _one_of(
        self, options: Mapping[str, Argument], name: str, known: tuple[int, ...], default: int
    ) -> int:
        value = self._option(options, name, known[0], known[-1], default)
        if value not in known:
            self._refuse(options[name], f"`{name}` is {value}", " or ".join(map(str, known)))
        return value

    def _step(self, node: AnnotationNode, program: Program) -> None:
        if program.bus == "modbus":
            self._modbus_step(node, program)
            return
        arguments, options = self._arguments(node, ("reply", "words", "bytes", "order", "keep"))
        step = self.evaluator.value(arguments[0], self.names) if arguments else None
        known = [one for one in _STEPS if one != "exchange" or program.bus == "spi"]
        allowed = _OPTIONS.get(str(step), ())
        fits = set(options) <= set(allowed) and (step != "check" or "reply" in options)
        if step not in known or not fits or len(arguments) < 2:
            shown = _STEPS[str(step)] if step in known else ", ".join(_STEPS[one] for one in known)
            self._report(node, f"this is no step of a program on {program.bus}", shown)
            return
        if step == "wait":
            program.wait(self._microseconds(arguments[1], "a wait"))
            program.wait(0)
            return
        if node.name.text == "setup" and step in ("read", "exchange"):
            self._report(node, f"`{step}` is a step of each period", "write `@cycle` for `@setup`")
            return
        sent = [self._number(one, "a byte", 0, 255) for one in arguments[1:]]
        if step == "write":
            program.frame(sent, [])
        elif step == "check":
            reply = self._number(options["reply"], "a reply", 0, 255)
            program.frame(sent, [CHECK | RECEIVE | reply])
        elif step == "exchange":
            words = self._option(options, "words", 1, max(1, len(sent)), 1)
            most = min(4, len(sent) // words)
            keep = self._option(options, "keep", 0, most, 1 if "words" in options else 0)
            program.frame(sent, [], keep=keep, words=words)
        else:
            words = self._option(options, "words", 1, MOST_WORDS, 1)
            size = self._option(options, "bytes", 1, 4, 1)
            lanes = [*range(size)] if self._little(options.get("order")) else [*reversed(range(size))]
            one = [RECEIVE | KEEP | lane * LANE for lane in lanes]
            one[-1] |= 1  # the next byte belongs to the next word
            program.frame(sent, one * words)
            program.values += words

    def _arguments(
        self, node: AnnotationNode, known: tuple[str, ...]
    ) -> tuple[list[Argument], dict[str, Argument]]:
        plain = [one for one in node.arguments if one.key is None]
        options = {one.key.text: one for one in node.arguments if one.key is not None}
        strange = [name for name in options if name not in known]
        if strange:
            self._report(node, f"`@{node.name.text}` has no `{strange[0]}`", f"it has {', '.join(known)}")
        return plain, options

    def _option(self, options: Mapping[str, Argument], name: str, low: int, high: int, default: int) -> int:
        argument = options.get(name)
        return default if argument is None else self._number(argument, f"`{name}`", low, high)

    def _number(self, argument: Argument, what: str, low: int, high: int) -> int:
        value = self.evaluator.integer(argument, self.names, what, low, high)
        self.good = self.good and value is not None
        return low if value is None else value

    def _little(self, argument: Argument | None) -> bool:
        order = "big" if argument is None else self.evaluator.value(argument, self.names)
        if argument is not None and order not in ("big", "little"):
            self._refuse(argument, "`order` is the order of the bytes of a word", '"big" or "little"')
        return order == "little"

    def _microseconds(self, argument: Argument, what: str) -> int:
        seconds = self.evaluator.quantity(argument, self.names, what, unit("s"))
        if seconds is None:
            self.good = False
            return 0
        time = Fraction(seconds) * 1_000_000
        if time.denominator != 1 or not 1 <= time <= _LONGEST_US:
            message = f"{what} is {float(time):g} us"
            self._refuse(argument, message, f"a whole number of microseconds, at most {_LONGEST_US:,}")
            return 0
        return time.numerator

    def _report(self, node: AnnotationNode, message: str, hint: str) -> None:
        self.good = False
        self.evaluator.reporter.report("UL098", node.name.start, node.name.end, message, f"write {hint}")

    def _refuse(self, argument: Argument, message: str, hint: str) -> None:
        self.good = False
        self.evaluator.reporter.report("UL098", argument.start, argument.end, message, f"write {hint}")
