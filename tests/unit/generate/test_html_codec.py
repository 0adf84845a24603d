# SPDX-License-Identifier: BSD-3-Clause
"""The register map's boxes and the library convert alike: codec.js is compared with unitylink.values."""

from __future__ import annotations

import json
import math
import random
import struct
from collections.abc import Iterator
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import pytest
import quickjs

import unitylink.generate.html
from unitylink.errors import UnexpectedValue, ValueRangeError
from unitylink.generate.html.page import page_data
from unitylink.spec.types import EnumType, EnumValue, Field, ValueType
from unitylink.values import Codec, Quantity

SCRIPT = (Path(unitylink.generate.html.__file__).parent / "codec.js").read_text("utf-8")
MODES = EnumType("mode", 3, (EnumValue("idle", 0), EnumValue("run", 1), EnumValue("stop", 5)))
TYPES = [
    ValueType("bool", 1),
    *(ValueType(kind, width) for kind in ("uint", "int") for width in (1, 7, 8, 16, 31, 32, 53, 63, 64)),
    *(ValueType("float", width) for width in (32, 64)),
    *(ValueType(kind, width, width // 2) for kind in ("fixed", "ufixed") for width in (8, 16, 24, 40)),
    ValueType("enum", 3, enum=MODES, name="mode"),
    ValueType("enum", 3, enum=replace(MODES, name="other", open=True), name="other"),
]
STATUS = ValueType(
    "bits",
    24,
    fields=(
        Field("ready", ValueType("bool", 1), 0, 0),
        Field("mode", TYPES[-2], 1, 3),
        Field("temperature", ValueType("int", 8), 4, 11, unit="degC", scale=0.5, offset=-20),
        Field("count", ValueType("uint", 12), 12, 23),
    ),
    name="status",
)


@pytest.fixture(scope="module")
def engine() -> quickjs.Context:
    context = quickjs.Context()
    context.eval(SCRIPT)
    context.eval(
        """
        function answer(call) {
          const plain = (value) => typeof value === "bigint" ? { whole: String(value) }
            : typeof value === "number" ? { real: String(value) }
            : typeof value === "object"
              ? { fields: Object.fromEntries(Object.entries(value).map(([n, v]) => [n, plain(v)])) }
              : { word: value };
          try { return JSON.stringify(plain(call())); } catch (error) {
            if (!(error instanceof ValueError)) throw error;
            return JSON.stringify({ error: error.message });
          }
        }
        """
    )
    return context


class Sides:
    """One quantity in both languages."""

    def __init__(self, engine: quickjs.Context, quantity: Quantity) -> None:
        self.engine = engine
        self.python = Codec("x", quantity, 32)
        enums = {enum.name: asdict(enum) for enum in (MODES, replace(MODES, name="other", open=True))}
        bits = {"status": asdict(STATUS)}
        types = json.dumps({"enums": enums, "bits": bits})
        given = json.dumps(page_data(asdict(quantity)))
        engine.eval(f"var codec = new Codec({given}, {types})")

    def decode(self, raw: int) -> Any:
        return json.loads(self.engine.eval(f"answer(() => codec.decode({raw}n))"))

    def encode(self, text: str) -> Any:
        return json.loads(self.engine.eval(f"answer(() => codec.encode({json.dumps(text)}))"))

    def same_decoding(self, raw: int) -> None:
        try:
            expected = told(self.python.decode(raw))
        except UnexpectedValue:
            assert "error" in self.decode(raw)
            return
        assert numbers(self.decode(raw)) == numbers(expected)

    def same_encoding(self, text: str, value: Any) -> None:
        try:
            expected = {"whole": str(self.python.encode(value))}
        except ValueRangeError:
            assert "error" in self.encode(text), (text, self.python.quantity)
            return
        assert self.encode(text) == expected, (text, self.python.quantity)


def told(value: Any) -> dict[str, Any]:
    """Return a value as `answer` does."""
    if hasattr(value, "__dataclass_fields__"):
        fields = {name.rstrip("_"): told(getattr(value, name)) for name in value.__dataclass_fields__}
        return {"fields": fields}
    if isinstance(value, bool):
        return {"word": value}
    if isinstance(value, int):
        name = getattr(value, "name", None)
        return {"whole": str(value)} if name is None else {"word": name}
    return {"real": str(value)}


def numbers(said: dict[str, Any]) -> dict[str, Any]:
    """Return reals as exact doubles, however they were written. A NaN becomes a text, and -0 becomes 0."""
    if "fields" in said:
        return {name: numbers(one) for name, one in said["fields"].items()}
    return {"real": str(float(said["real"]) + 0.0)} if "real" in said else said


def quantities(chance: random.Random, kind: ValueType) -> list[Quantity]:
    """Return a plain quantity. For numbers, also return some with scale, limits and policies."""
    found = [Quantity(kind)]
    if kind.numeric:
        for _ in range(6):
            scale = chance.choice([1, 0.5, 0.001, -0.25, 3, math.pi])
            offset = chance.choice([0, 0, -20, 0.125])
            one = Quantity(kind, scale, offset, chance.choice(["", "rad"]))
            ends = [Codec("x", one, 32).decode(chance.getrandbits(kind.width)) for _ in range(2)]
            finite = all(math.isfinite(end) and abs(end) < 1e200 for end in ends)
            limits = {"minimum": min(ends), "maximum": max(ends)} if finite and chance.random() < 0.7 else {}
            found.append(replace(one, overflow=chance.choice(["error", "saturate"]), **limits))
    return found


def raws(chance: random.Random, kind: ValueType) -> list[int]:
    top = (1 << kind.width) - 1
    found = [0, 1, top, top >> 1, (top >> 1) + 1, *(chance.getrandbits(kind.width) for _ in range(12))]
    if kind.kind == "float":
        code = "<f" if kind.width == 32 else "<d"
        some = (0.1, -1e-30, 3.5e7, math.inf, -math.inf, -0.0)
        found += [int.from_bytes(struct.pack(code, one), "little") for one in some]
    return found


def test_both_sides_decode_alike(engine: quickjs.Context) -> None:
    for kind in (*TYPES, STATUS):
        chance = random.Random(kind.text)
        for quantity in quantities(chance, kind):
            sides = Sides(engine, quantity)
            for raw in raws(chance, kind):
                sides.same_decoding(raw)


def drawn_numbers() -> Iterator[tuple[ValueType, Quantity, random.Random]]:
    """Yield each numeric type with its quantities, and the random source for values of them."""
    for kind in (kind for kind in TYPES if kind.numeric):
        chance = random.Random(kind.text)
        for quantity in quantities(chance, kind):
            yield kind, quantity, chance


def test_both_sides_encode_numbers_alike(engine: quickjs.Context) -> None:
    """Values at the limits, one step beside them, between two steps, far away, and results of decoding."""
    for kind, quantity, chance in drawn_numbers():
        sides = Sides(engine, quantity)
        low, high = sides.python.minimum, sides.python.maximum
        step = abs(quantity.scale) / (1 << kind.fraction)
        values = [low, high, low - step, high + step, 0, 1, -1, 10**30]
        decoded = [sides.python.decode(raw) for raw in raws(chance, kind)]
        # a text does not tell which NaN it is
        values += [value for value in decoded if not math.isnan(value)]
        if quantity.scaled or kind.kind == "float":
            values += [
                low + 0.5 * step,
                low + 1.5 * step,
                chance.uniform(-300, 300),
                math.inf,
                -math.inf,
                math.nan,
            ]
        else:
            values = [int(value) for value in values]
        for value in values:
            sides.same_encoding(repr(value), value)


def test_enumerations_and_switches_encode_alike(engine: quickjs.Context) -> None:
    for kind in (one for one in TYPES if one.kind == "enum"):
        sides = Sides(engine, Quantity(kind))
        for name in ("idle", "run", "stop", "walk", ""):
            sides.same_encoding(name, name)
        for number in (0, 1, 2, 5, 7, 8):
            sides.same_encoding(str(number), number)
    sides = Sides(engine, Quantity(ValueType("bool", 1)))
    assert [sides.encode(text) for text in ("true", "0", "2")] == [
        {"whole": "1"},
        {"whole": "0"},
        {"error": "true or false"},
    ]


@pytest.mark.parametrize("text", ["", "1.2.3", "abc", "--1", "0x", "1e", "1 2", "１", "0b2"])
def test_what_is_no_number_is_refused(engine: quickjs.Context, text: str) -> None:
    for quantity in (Quantity(ValueType("int", 16)), Quantity(ValueType("int", 16), scale=0.5)):
        assert "error" in Sides(engine, quantity).encode(text)


def test_units_may_be_typed(engine: quickjs.Context) -> None:
    assert Sides(engine, Quantity(ValueType("int", 16), 0.5, unit="mm")).encode("1.5 mm") == {"whole": "3"}
