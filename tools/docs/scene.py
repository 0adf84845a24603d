# SPDX-License-Identifier: BSD-3-Clause
"""A scene of a component: what is written to it, what its inputs do, and what its pins then do.

`components/NAME/picture.toml` has the scenes of a component. What its pins do comes from its model, the one
that is compared with the VHDL at every clock. A component without a model is played in GHDL, and
`picture_1.trace` keeps what its first scene gave.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from scene_bench import Stimulus, play_vhdl

from unitylink import _native
from unitylink.errors import UnityLinkError
from unitylink.interface.components import ComponentConfiguration, components_of
from unitylink.spec import compile_text, load
from unitylink.spec.model import Element
from unitylink.values import Codec, Quantity, format_value

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

KEYS = {
    "title",
    "spec",
    "clock_hz",
    "from_us",
    "to_us",
    "write",
    "drive",
    "wires",
    "step_us",
    "lines",
    "value",
}
DATA_BITS = 32
WIRE_BITS = 33  # of wire_pkg.vhd
ACCESS_CLOCKS = 4  # from one access to the next
SAMPLES = 120  # of a value, over the width of a picture


@dataclass(frozen=True)
class Track:
    """A line of a picture: `points` are (time in us, level), of which the first is before the window.

    The level None is a gap: a wire that is not valid.
    """

    name: str
    kind: str  # "in", "out", "event", "value"
    points: tuple[tuple[float, float | None], ...]
    unit: str = ""


@dataclass(frozen=True)
class Played:
    """What a scene shows. `written` are (time in us, text)."""

    title: str
    from_us: float
    to_us: float
    written: tuple[tuple[float, str], ...]
    tracks: tuple[Track, ...]


class Scene:
    """One scene of the component in `folder`. Raises SystemExit that names the place of a mistake."""

    def __init__(self, folder: Path, number: int, told: Mapping[str, Any]) -> None:
        self.folder, self.number, self.told = folder, number, told
        self.where = f"{folder.name}/picture.toml, scene {number + 1}"
        if unknown := sorted(set(told) - KEYS):
            raise SystemExit(f"{self.where}: unknown {unknown[0]!r}; there are {', '.join(sorted(KEYS))}")
        self.clock_hz: int = self._get("clock_hz")
        self.from_us, self.to_us = float(told.get("from_us", 0)), float(self._get("to_us"))
        self.one, self.items = _placed(folder, str(told.get("spec", "")), self.clock_hz)
        self.inputs = dict(_pins(self.one, "in"))
        self.outputs = dict(_pins(self.one, "out"))
        self.wires_in = _wires(self.one, "in", len(self.inputs))
        self.wires_out = _wires(self.one, "out", len(self.outputs))

    def stimuli(self) -> tuple[list[Stimulus], list[tuple[float, str]], dict[int, float]]:
        """Return what is played, what is written as text, and the times of the reads of `value`."""
        found: list[Stimulus] = []
        written = []
        at = 0
        for one in self.told.get("write", ()):
            if missing := {"at_us", "set"} - set(one):
                raise SystemExit(f"{self.where}: {missing.pop()} is missing in a write")
            at = max(at, self._clock(one["at_us"]))
            for name, value in one["set"].items():
                element, codec = self._item(name)
                try:
                    raw = codec.encode(_whole(value, codec))
                except UnityLinkError as error:
                    raise SystemExit(f"{self.where}: {error}") from None
                found.append((at, "w", element.address - self.one.base, raw))
                shown = _fields(value) if isinstance(value, dict) else format_value(value)
                unit = f" {element.unit}" if element.unit else ""
                written.append((at * 1e6 / self.clock_hz, f"{name} = {shown.strip()}{unit}"))
                at += ACCESS_CLOCKS
        busy = [clock for clock, *_ in found]
        reads = {}
        if "value" in self.told:
            element, _ = self._item(self.told["value"])
            for sample in range(SAMPLES + 1):
                at = self._clock(self.from_us + (self.to_us - self.from_us) * sample / SAMPLES)
                if all(abs(at - other) >= ACCESS_CLOCKS for other in busy):
                    found.append((at, "r", element.address - self.one.base, 0))
                    reads[at] = at * 1e6 / self.clock_hz
        for port, points in self._driven().items():
            found += [(self._clock(us), "p", self.inputs[port], int(level)) for us, level in points]
        found += self._wired()
        order = {"p": 0, "r": 1, "w": 1}
        return sorted(found, key=lambda one: (one[0], order[one[1]])), written, reads

    def play(self) -> Played:
        """Return what the pins do."""
        found, written, reads = self.stimuli()
        model = _native.has_component_model(self.one.entity)
        seen = sorted(_native.ComponentModel(self.one).play(found, self.end)) if model else self._kept()
        accesses = [one for one in found if one[1] in "rw"]
        answers = [one for one in seen if one[1] == "a"]
        values = []
        for access, answer in zip(accesses, answers, strict=False):
            if answer[2]:
                raise SystemExit(f"{self.where}: the component refuses {access[1]} of word {access[2]}")
            if access[0] in reads:
                _, codec = self._item(self.told["value"])
                values.append((reads[access[0]], float(codec.decode(answer[3]))))
        tracks = []
        driven = self._driven()
        for name in self.told.get("lines", (*self.inputs, *self.outputs, *self.one.events)):
            if name in self.inputs:
                tracks.append(Track(name, "in", ((-1.0, 0), *driven.get(name, ()))))
            elif name in self.outputs:
                tracks.append(self._seen(name, "out", "o", self.outputs[name], seen))
            elif name in self.wires_out:
                tracks.append(self._wire_seen(name, seen))
            elif name in self.one.events:
                tracks.append(self._seen(name, "event", "e", self.one.events.index(name), seen))
            else:
                raise SystemExit(f"{self.where}: {self.one.entity} has no line {name!r}")
        if values:
            element, _ = self._item(self.told["value"])
            tracks.append(Track(self.told["value"], "value", tuple(values), element.unit))
        shown = tuple(one for one in written if self.from_us <= one[0] <= self.to_us)
        return Played(self.told.get("title", ""), self.from_us, self.to_us, shown, tuple(tracks))

    @property
    def end(self) -> int:
        """The last clock."""
        return self._clock(self.to_us) + 1

    @property
    def trace(self) -> Path | None:
        """Where the edges are kept that GHDL has seen. None: a model plays the scene."""
        if _native.has_component_model(self.one.entity):
            return None
        return self.folder / f"picture_{self.number + 1}.trace"

    def trace_of_vhdl(self) -> str:
        """Return what the VHDL gives, a line for each edge and each answer."""
        seen = play_vhdl(self.one, self.stimuli()[0], self.end)
        return "".join(f"{clock} {what} {number} {value:x}\n" for clock, what, number, value in seen)

    def _kept(self) -> list[Stimulus]:
        assert self.trace is not None
        if not self.trace.is_file():
            raise SystemExit(f"{self.where}: there is no model; `gallery.py --record` plays the VHDL")
        rows = (line.split() for line in self.trace.read_text("ascii").splitlines())
        return [(int(clock), what, int(number), int(value, 16)) for clock, what, number, value in rows]

    def _seen(self, name: str, kind: str, what: str, number: int, seen: list[Stimulus]) -> Track:
        points = [(-1.0, 0.0)]
        points += [(s[0] * 1e6 / self.clock_hz, float(s[3])) for s in seen if s[1] == what and s[2] == number]
        return Track(name, kind, tuple(points))

    def _wire_seen(self, name: str, seen: list[Stimulus]) -> Track:
        """Return the values of an output wire. Its bits come one by one."""
        first, bits = self.wires_out[name], 0
        points: dict[int, float | None] = {}
        for clock, what, number, level in seen:
            if what == "o" and first <= number < first + WIRE_BITS:
                bits = bits & ~(1 << number - first) | level << number - first
                value = (bits & 0xFFFFFFFF ^ 0x80000000) - 0x80000000
                points[clock] = float(value) if bits >> WIRE_BITS - 1 else None
        times = ((clock * 1e6 / self.clock_hz, value) for clock, value in points.items())
        return Track(name, "value", ((-1.0, None), *times, (self.to_us, [None, *points.values()][-1])))

    def _wired(self) -> Iterator[Stimulus]:
        """Yield the bits of the input wires. `wires` has points (time in us, counts), with straight lines
        between them, of which each `step_us` is a value. A point without counts ends the wire.
        """
        for name, points in self.told.get("wires", {}).items():
            if name not in self.wires_in or any(len(one) not in (1, 2) for one in points):
                raise SystemExit(f"{self.where}: {name} is no input wire with points [us, counts]")
            before, step_us = 0, float(self._get("step_us"))
            for place in range(int(self.to_us / step_us)):
                value = _on_lines(points, place * step_us)
                bits = 0 if value is None else 1 << WIRE_BITS - 1 | round(value) & 0xFFFFFFFF
                for bit in range(WIRE_BITS):
                    if (bits ^ before) >> bit & 1:
                        pin = self.wires_in[name] + bit
                        yield self._clock(place * step_us), "p", pin, bits >> bit & 1
                before = bits

    def _driven(self) -> dict[str, list[tuple[float, float]]]:
        """Return the edges of the inputs. `drive` has a figure for each step."""
        found = {}
        for port, figures in self.told.get("drive", {}).items():
            if port not in self.inputs or set(figures) - set("01 "):
                raise SystemExit(f"{self.where}: {port} = {figures!r} is no input with figures 0 and 1")
            step_us, before = float(self._get("step_us")), "0"
            found[port] = []
            for place, level in enumerate(figures.replace(" ", "")):
                if level != before:
                    found[port].append((place * step_us, float(level)))
                before = level
        return found

    def _clock(self, us: float) -> int:
        return round(us * self.clock_hz / 1e6)

    def _get(self, key: str) -> Any:
        if key not in self.told:
            raise SystemExit(f"{self.where}: {key} is missing")
        return self.told[key]

    def _item(self, name: str) -> tuple[Element, Codec]:
        if name not in self.items:
            raise SystemExit(
                f"{self.where}: {self.one.entity} has no {name!r}; there are {', '.join(self.items)}"
            )
        return self.items[name]


def scenes(folder: Path) -> list[Scene]:
    """Return the scenes of a component. Without a picture.toml there are none."""
    file = folder / "picture.toml"
    if not file.is_file():
        return []
    try:
        return [
            Scene(folder, i, told) for i, told in enumerate(tomllib.loads(file.read_text("utf-8"))["scene"])
        ]
    except (tomllib.TOMLDecodeError, KeyError, UnityLinkError) as error:
        raise SystemExit(f"{file}: {error}") from None


def configuration(folder: Path) -> ComponentConfiguration:
    """Return the component as its example.ul places it."""
    return _placed(folder, "", 50_000_000)[0]


def _placed(
    folder: Path, line: str, clock_hz: int
) -> tuple[ComponentConfiguration, dict[str, tuple[Element, Codec]]]:
    if line:
        result = compile_text(f"link board (ADDRESS=8); public board() {{ {line} }}")
        if result.spec is None:
            raise SystemExit(f"{folder.name}/picture.toml: spec = {line!r} does not compile")
        spec = result.spec
    else:
        spec = load(str(folder / "example.ul"))
    one = next(one for one in components_of(spec, clock_hz) if one.entity == folder.name)
    one = replace(
        one, event_groups=tuple(range(len(one.events)))
    )  # the model tells only of events that are heard
    items = {
        path.removeprefix(f"{one.path}."): (element, Codec(path, Quantity.of(element), DATA_BITS))
        for path, element in spec.walk()
        if path.startswith(f"{one.path}.")
    }
    return one, items


def _wires(one: ComponentConfiguration, direction: str, pins: int) -> dict[str, int]:
    """Return the number of the lowest bit of each wire. Wires are pins behind the others."""
    names = [name for name, way in one.wires if way == direction]
    return {name: pins + place * WIRE_BITS for place, name in enumerate(names)}


def _on_lines(points: Sequence[Sequence[float]], at: float) -> float | None:
    """Return the value at a time on straight lines between points. None: none there, or an end."""
    passed = [one for one in points if one[0] <= at]
    if not passed or len(passed[-1]) == 1:
        return None
    begin, end = passed[-1], points[len(passed)] if len(passed) < len(points) else ()
    if len(end) < 2:
        return begin[1]
    return begin[1] + (end[1] - begin[1]) * (at - begin[0]) / (end[0] - begin[0])


def _fields(value: dict[str, Any]) -> str:
    """Return the fields of a packed value that are not 0."""
    named = (key if field is True else f"{key}={field}" for key, field in value.items() if field)
    return " ".join(named) or "0"


def _whole(value: Any, codec: Codec) -> Any:
    """Return a packed value with all its fields. Those that a scene does not name are 0."""
    if not isinstance(value, dict):
        return value
    idle = codec.decode(0)
    return {
        name: value.get(name, getattr(idle, name)) for name in (field.name for field in codec.type.fields)
    }


def _pins(one: ComponentConfiguration, direction: str) -> Iterator[tuple[str, int]]:
    """Yield (name, number): `pins[1]`, or `a` for a single signal."""
    number = 0
    for port, way, bits in one.pins:
        if way == direction:
            for bit in range(bits or 1):
                yield (f"{port}[{bit}]" if bits else port), number
                number += 1
