# SPDX-License-Identifier: BSD-3-Clause
"""The units of a spec, the quantities that they measure, and conversion between them.

A unit is a name of the table, or a combination of names: `rad/s`, `N m`, `m/s^2`, `1/min`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

# The measured quantity, as powers of: length, mass, time, current, temperature, angle, things counted.
Dimension = tuple[int, int, int, int, int, int, int]

NONE: Dimension = (0, 0, 0, 0, 0, 0, 0)
_LENGTH: Dimension = (1, 0, 0, 0, 0, 0, 0)
_MASS: Dimension = (0, 1, 0, 0, 0, 0, 0)
_TIME: Dimension = (0, 0, 1, 0, 0, 0, 0)
_CURRENT: Dimension = (0, 0, 0, 1, 0, 0, 0)
_TEMPERATURE: Dimension = (0, 0, 0, 0, 1, 0, 0)
_ANGLE: Dimension = (0, 0, 0, 0, 0, 1, 0)
_COUNT: Dimension = (0, 0, 0, 0, 0, 0, 1)
_FORCE: Dimension = (1, 1, -2, 0, 0, 0, 0)
_PRESSURE: Dimension = (-1, 1, -2, 0, 0, 0, 0)
_ENERGY: Dimension = (2, 1, -2, 0, 0, 0, 0)
_POWER: Dimension = (2, 1, -3, 0, 0, 0, 0)
_CHARGE: Dimension = (0, 0, 1, 1, 0, 0, 0)
_VOLTAGE: Dimension = (2, 1, -3, -1, 0, 0, 0)
_RESISTANCE: Dimension = (2, 1, -3, -2, 0, 0, 0)
_CAPACITANCE: Dimension = (-2, -1, 4, 2, 0, 0, 0)
_INDUCTANCE: Dimension = (2, 1, -2, -2, 0, 0, 0)
_FIELD: Dimension = (0, 1, -2, -1, 0, 0, 0)
_FREQUENCY: Dimension = (0, 0, -1, 0, 0, 0, 0)

_PI = Fraction(math.pi)
_MAX_POWER = 9


@dataclass(frozen=True)
class Unit:
    """One unit. A value in it, times `factor` plus `offset`, is the value in SI units."""

    text: str
    dimension: Dimension
    factor: Fraction
    offset: Fraction = Fraction(0)

    def to(self, value: Fraction, other: Unit) -> Fraction:
        """Return a value of this unit in another unit. Both must measure the same quantity."""
        return (value * self.factor + self.offset - other.offset) / other.factor


def _table() -> dict[str, Unit]:
    plain: dict[str, tuple[Dimension, Fraction]] = {
        "%": (NONE, Fraction(1, 100)),
        "rad": (_ANGLE, Fraction(1)),
        "deg": (_ANGLE, _PI / 180),
        "°": (_ANGLE, _PI / 180),
        "turn": (_ANGLE, 2 * _PI),
        "rev": (_ANGLE, 2 * _PI),
        "rpm": ((0, 0, -1, 0, 0, 1, 0), _PI / 30),
        "min": (_TIME, Fraction(60)),
        "h": (_TIME, Fraction(3600)),
        "inch": (_LENGTH, Fraction(254, 10000)),
        "bar": (_PRESSURE, Fraction(100_000)),
        "l": ((3, 0, 0, 0, 0, 0, 0), Fraction(1, 1000)),
        "Wh": (_ENERGY, Fraction(3600)),
        "Ah": (_CHARGE, Fraction(3600)),
        "mAh": (_CHARGE, Fraction(36, 10)),
        "g0": ((1, 0, -2, 0, 0, 0, 0), Fraction(980_665, 100_000)),
        **{name: (_COUNT, Fraction(1)) for name in ("count", "step", "pulse", "tick", "clock", "sample")},
        "bit": (_COUNT, Fraction(1)),
        "byte": (_COUNT, Fraction(8)),
    }
    prefixes = {"": 0, "n": -9, "u": -6, "µ": -6, "m": -3, "k": 3, "M": 6, "G": 9}
    prefixed: dict[str, tuple[Dimension, Fraction]] = {
        "m": (_LENGTH, Fraction(1)),
        "g": (_MASS, Fraction(1, 1000)),
        "s": (_TIME, Fraction(1)),
        "A": (_CURRENT, Fraction(1)),
        "K": (_TEMPERATURE, Fraction(1)),
        "N": (_FORCE, Fraction(1)),
        "Pa": (_PRESSURE, Fraction(1)),
        "J": (_ENERGY, Fraction(1)),
        "W": (_POWER, Fraction(1)),
        "V": (_VOLTAGE, Fraction(1)),
        "Ohm": (_RESISTANCE, Fraction(1)),
        "C": (_CHARGE, Fraction(1)),
        "F": (_CAPACITANCE, Fraction(1)),
        "H": (_INDUCTANCE, Fraction(1)),
        "T": (_FIELD, Fraction(1)),
        "Hz": (_FREQUENCY, Fraction(1)),
    }
    for name, (dimension, factor) in prefixed.items():
        for prefix, power in prefixes.items():
            plain[prefix + name] = (dimension, factor * Fraction(10) ** power)
    plain["cm"] = (_LENGTH, Fraction(1, 100))
    plain["mrad"] = (_ANGLE, Fraction(1, 1000))
    plain["Nm"] = (_ENERGY, Fraction(1))
    plain["mNm"] = (_ENERGY, Fraction(1, 1000))
    units = {name: Unit(name, dimension, factor) for name, (dimension, factor) in plain.items()}
    celsius = Fraction(27315, 100)
    units["degC"] = Unit("degC", _TEMPERATURE, Fraction(1), celsius)
    units["°C"] = Unit("°C", _TEMPERATURE, Fraction(1), celsius)
    return units


UNITS = _table()
# `hz` gives `Hz`, the first one of this spelling
UNITS_FOLDED = {name.lower(): name for name in reversed(UNITS)}

# Other names of units. Their plurals are accepted too, and so are milli, kilo and so on before them.
_SPOKEN = {
    "radian": "rad",
    "degree": "deg",
    "revolution": "rev",
    "meter": "m",
    "metre": "m",
    "second": "s",
    "sec": "s",
    "minute": "min",
    "hour": "h",
    "hertz": "Hz",
    "gram": "g",
    "newton": "N",
    "volt": "V",
    "ampere": "A",
    "amp": "A",
    "watt": "W",
    "joule": "J",
    "pascal": "Pa",
    "ohm": "Ohm",
    "farad": "F",
    "henry": "H",
    "tesla": "T",
    "coulomb": "C",
    "kelvin": "K",
    "celsius": "degC",
    "liter": "l",
    "litre": "l",
    "percent": "%",
}
_SPOKEN_PREFIXES = {
    "nano": "n",
    "micro": "u",
    "milli": "m",
    "centi": "c",
    "kilo": "k",
    "mega": "M",
    "giga": "G",
}
_POWER_DIGIT = re.compile(r"([A-Za-z])(-?[23])\b")
_WORD = re.compile(r"[A-Za-z]+")

_STEP = re.compile(r"\s*([/*·]?)\s*(1|[A-Za-zµ°%][A-Za-z0°]*)(?:\^(-?[0-9])|([²³]))?\s*")


@lru_cache(1000)
def unit(text: str) -> Unit | None:
    """Return a unit by its text, or None if there is none of this name.

    >>> unit("rad/s").dimension == unit("rpm").dimension
    True
    >>> float(unit("deg").to(Fraction(180), unit("rad")))
    3.141592653589793
    """
    found = UNITS.get(text)
    if found is not None or not text:
        return found
    dimension, factor, position, steps = list(NONE), Fraction(1), 0, 0
    while position < len(text):
        step = _STEP.match(text, position)
        if step is None or steps == _MAX_POWER:
            return None
        part = Unit("1", NONE, Fraction(1)) if step.group(2) == "1" else UNITS.get(step.group(2))
        if part is None or part.offset or (steps == 0 and step.group(1)):
            return None
        power = int(step.group(3) or {"²": 2, "³": 3}.get(step.group(4), 1))
        power = -power if step.group(1) == "/" else power
        dimension = [sum_ + power * one for sum_, one in zip(dimension, part.dimension, strict=True)]
        factor *= part.factor**power
        position = step.end()
        steps += 1
    a, b, c, d, e, f, g = dimension
    return Unit(text, (a, b, c, d, e, f, g), factor)


def combined(left: str, right: str, *, divided: bool) -> str | None:
    """Return the unit of a product, or of a quotient. Return None if it cannot be written as a unit.

    >>> combined("rad", "s", divided=True), combined("m/s", "s", divided=True)
    ('rad/s', 'm/s^2')
    >>> combined("", "rad", divided=True), combined("rad/s", "s", divided=False)
    ('1/rad', 'rad')
    """
    powers: dict[str, int] = {}
    for text, sign in ((left, 1), (right, -1 if divided else 1)):
        for name, power in _factors(text):
            powers[name] = powers.get(name, 0) + sign * power
    above = " ".join(_power(name, power) for name, power in powers.items() if power > 0)
    below = "".join(f"/{_power(name, -power)}" for name, power in powers.items() if power < 0)
    text = (above or "1") + below
    return text if unit(text) is not None else None


def _factors(text: str) -> Iterator[tuple[str, int]]:
    """Yield each name of a unit, and its power."""
    for step in _STEP.finditer(text):
        power = int(step.group(3) or {"²": 2, "³": 3}.get(step.group(4), 1))
        if step.group(2) != "1":
            yield step.group(2), -power if step.group(1) == "/" else power


def _power(name: str, power: int) -> str:
    return name if power == 1 else f"{name}^{power}"


def spoken(text: str) -> str | None:
    """Return the symbol of the unit that people call `text`, or None if it is unknown.

    >>> spoken("Volt"), spoken("millimeters per second"), spoken("m/s2"), spoken("furlong")
    ('V', 'mm/s', 'm/s^2', None)
    """
    written = re.sub(r"\s+per\s+", "/", text.strip())
    written = _WORD.sub(lambda word: _written(word.group()), _POWER_DIGIT.sub(r"\1^\2", written))
    return written if written != text and unit(written) is not None else None


def _written(word: str) -> str:
    name = word.lower()
    for prefix, letter in _SPOKEN_PREFIXES.items():
        if name.startswith(prefix):
            return letter + _called(name.removeprefix(prefix), word)
    return _called(name, word)


def _called(name: str, otherwise: str) -> str:
    singular = name.removesuffix("s")
    if singular in UNITS and len(singular) > 2:  # counts, steps
        return singular
    return _SPOKEN.get(name) or _SPOKEN.get(singular) or otherwise
