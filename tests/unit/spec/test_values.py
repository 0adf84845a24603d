# SPDX-License-Identifier: BSD-3-Clause
"""Types, units, limits and kinds of access: what they mean in the model."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest

from unitylink.spec import Element, Spec, compile_text
from unitylink.spec.units import unit


def clean(text: str, file: str = "<text>") -> Spec:
    """Compile a text that must give no diagnostic."""
    result = compile_text(text, file)
    assert [(d.code, d.message) for d in result.diagnostics] == []
    assert result.spec is not None
    return result.spec


def element(member: str, before: str = "") -> Element:
    return clean(f"{before}\npublic a() {{ {member} }}").root().elements[0]


def codes(text: str) -> list[str]:
    return [d.code for d in compile_text(text).diagnostics]


@pytest.mark.parametrize(
    ("written", "kind", "width", "fraction", "words"),
    [
        ("bool", "bool", 1, 0, 1),
        ("u1", "uint", 1, 0, 1),
        ("u33", "uint", 33, 0, 2),
        ("u64", "uint", 64, 0, 2),
        ("i12", "int", 12, 0, 1),
        ("f32", "float", 32, 0, 1),
        ("f64", "float", 64, 0, 2),
        ("fixed(8,8)", "fixed", 16, 8, 1),
        ("ufixed(0,16)", "ufixed", 16, 16, 1),
        ("u(4*3)", "uint", 12, 0, 1),
        ("signed", "int", 32, 0, 1),
        ("", "uint", 32, 0, 1),
    ],
)
def test_types(written: str, kind: str, width: int, fraction: int, words: int) -> None:
    made = element(f"@x = 0x10: {written} READ();")
    assert (made.type.kind, made.type.width, made.type.fraction, made.words) == (kind, width, fraction, words)
    assert made.addresses == tuple(range(0x10, 0x10 + words))


def test_width_of_the_bus_decides_how_many_words_a_value_takes() -> None:
    spec = clean(
        "link a (DATA=16);\n"
        "public a() { @x = 0x0: u64 READ(); @y = 0x4: signed READ(); @z = 0x5: u17 READ(); }"
    )
    assert [(e.type.width, e.words) for e in spec.root().elements] == [(64, 4), (16, 1), (17, 2)]


def test_words_of_wide_values_overlap_as_words() -> None:
    assert codes("public a() { @x = 0x10: u64 READ(); @y = 0x11: READ(); }") == ["UL051"]
    assert codes("public a() { @x = 0x10: u64 READ(); @y = 0x11: u64 READ(); }") == ["UL051"]
    clean("public a() { @x = 0x10: u64 READ(); @y = 0x12: READ(); }")
    assert codes("public a() { @x = 0xFFFFFFFF: u64 READ(); }") == ["UL050"]


def test_engineering_values_are_in_the_unit_of_the_element() -> None:
    made = element(
        '@x = 0x1: i16 WRITE(UNIT="rad", SCALE=0.001, OFFSET=1 deg, MIN=-180 deg, MAX=0.5 turn, SAFE=90 deg);'
    )
    assert made.unit == "rad"
    assert made.scale == 0.001
    assert made.offset == pytest.approx(math.pi / 180, rel=1e-15)
    assert (made.minimum, made.maximum, made.safe) == (-math.pi, math.pi, math.pi / 2)
    made = element('@x = 0x1: i16 READ(UNIT="degC", SCALE=1/16, MIN=233.15 K, MAX=85);')
    assert (made.minimum, made.maximum, made.scale) == (-40, 85, 0.0625)
    made = element('@x = 0x1: u16 READ(UNIT="rad/s", MAX=3000 rpm);')
    assert made.maximum == pytest.approx(100 * math.pi, rel=1e-15)
    made = element('@x = 0x1: i16 WRITE(UNIT="deg", MAX=2*TOP);', "const TOP = 30 deg;")
    assert made.maximum == 60


def test_whole_numbers_stay_whole() -> None:
    made = element("@x = 0x1: u64 WRITE(MAX=18446744073709551615, MIN=0, INITIAL=9007199254740993);")
    assert (made.maximum, made.minimum, made.initial) == (2**64 - 1, 0, 2**53 + 1)
    assert isinstance(made.initial, int)


@pytest.mark.parametrize(
    ("member", "code"),
    [
        ("@x = 0x1: i16 WRITE(SCALE=0.001, MAX=33);", "UL090"),
        ("@x = 0x1: i16 WRITE(SCALE=-0.001, MAX=32.768);", ""),
        ("@x = 0x1: u8 WRITE(MIN=-1);", "UL090"),
        ("@x = 0x1: u8 WRITE(SAFE=0.3);", "UL090"),
        ("@x = 0x1: u8 WRITE(SCALE=1 us, INITIAL=1.5);", "UL090"),
        ("@x = 0x1: bool WRITE(SAFE=0.5);", "UL090"),
        ("@x = 0x1: u8 WRITE(OFFSET=-1, MIN=-1);", ""),
        ("@x = 0x1: f32 WRITE(MAX=1e38);", ""),
        ("@x = 0x1: f32 WRITE(MAX=1e39);", "UL090"),
        ("@x = 0x1: fixed(4,4) WRITE(MAX=7.9375);", ""),
        ("@x = 0x1: fixed(4,4) WRITE(MAX=8);", "UL090"),
        ("@x = 0x1: u8 WRITE(MIN=5, MAX=9, INITIAL=4);", "UL090"),
        ("@x = 0x1: u8 WRITE(MIN=5, MAX=9, SAFE=10);", "UL090"),
        ("@x = 0x1: bool WRITE(INITIAL=true);", ""),
        ("@x = 0x1: bool WRITE(INITIAL=2);", "UL090"),
        ("@x = 0x1: bool WRITE(SCALE=2);", "UL092"),
        ("@x = 0x1: u8 PULSE(INITIAL=1);", "UL092"),
        ("@x = 0x1: i8 W1C();", "UL092"),
        ('@x = 0x1: u8 READ(UNIT="furlong");', "UL087"),
        ('@x = 0x1: u8 READ(UNIT="rad", MAX=1 furlong);', "UL087"),
        ("@x = 0x1: u8 READ(MAX=1 rad);", "UL088"),
        ('@x = 0x1: u8 READ(UNIT="rad", MAX=1 rad + 1);', "UL088"),
        ('@x = 0x1: u8 READ(UNIT="rad", MAX=(1 turn)/(2 rad));', ""),
        ("@x = 0x1: u8 READ(UNIT=rad);", "UL025"),
        ('@x = 0x1: u8 READ(SCALE="one");', "UL047"),
    ],
)
def test_limits_and_units_are_checked(member: str, code: str) -> None:
    assert codes(f"public a() {{ {member} }}") == ([code] if code else [])


def test_enumerations_and_packed_bits() -> None:
    before = """
    /// how it moves
    enum mode: u2 { idle = 0; /// not at all
       run = 1; stop = 3 }
    open enum colour: u8 { red = 1 }
    bits status: u8 { ready: bool @ 0; mode: mode @ 2..1; count: u4 @ 7..4 (UNIT="A", SCALE=0.1, MAX=1.5) }
    """
    members = """
    @x = 0x1: mode READWRITE(INITIAL=run, SAFE=3); @c = 0x2: colour WRITE(INITIAL=7); @s = 0x3: status READ();
    """
    made, colour, status = clean(f"{before}\npublic a() {{ {members} }}").root().elements
    assert (colour.initial, colour.type.enum and colour.type.enum.open) == (7, True)
    found = [(f.name, f.type.text, f.low, f.high, f.unit, f.scale, f.maximum) for f in status.type.fields]
    assert found == [
        ("ready", "bool", 0, 0, "", 1, None),
        ("mode", "mode", 1, 2, "", 1, None),
        ("count", "u4", 4, 7, "A", 0.1, 1.5),
    ]
    assert (made.initial, made.safe, made.type.kind, made.type.width) == (1, 3, "enum", 2)
    enum = made.type.enum
    assert enum is not None
    assert [(v.name, v.value, v.documentation) for v in enum.values] == [
        ("idle", 0, "not at all"),
        ("run", 1, ""),
        ("stop", 3, ""),
    ]
    assert (enum.open, enum.documentation) == (False, "how it moves")


def test_access_says_what_may_be_done() -> None:
    members = "".join(
        f"@x{i} = 0x{i:X}: {access}();"
        for i, access in enumerate(["READ", "WRITE", "READWRITE", "W1C", "PULSE", "READCLEAR"])
    )
    found = [
        (e.access, e.readable, e.writable, e.pollable)
        for e in clean(f"public a() {{ {members} }}").root().elements
    ]
    assert found == [
        ("READ", True, False, True),
        ("WRITE", False, True, False),
        ("READWRITE", True, True, True),
        ("W1C", True, True, True),
        ("PULSE", False, True, False),
        ("READCLEAR", True, False, False),
    ]


def test_a_strobe_may_share_its_word_with_a_read() -> None:
    clean("public a() { @status = 0x1: READ(); @go = 0x1: PULSE(); }")
    assert codes("public a() { @status = 0x1: READ(); @go = 0x1: WRITE(); }") == ["UL052"]
    assert codes("public a() { @a = 0x1: READWRITE(); @go = 0x1: PULSE(); }") == ["UL051"]


@pytest.mark.parametrize(
    ("text", "value", "other", "expected"),
    [
        ("deg", 180, "rad", math.pi),
        ("rpm", 60, "rad/s", 2 * math.pi),
        ("km/h", 36, "m/s", 10),
        ("degC", 20, "K", 293.15),
        ("K", 0, "degC", -273.15),
        ("N m", 1, "Nm", 1),
        ("kg m/s^2", 3, "N", 3),
        ("m/s²", 9.80665, "g0", 1),
        ("1/min", 60, "Hz", 1),
        ("%", 50, "%", 50),
        ("mAh", 1000, "Ah", 1),
    ],
)
def test_units_convert(text: str, value: float, other: str, expected: float) -> None:
    one, two = unit(text), unit(other)
    assert one is not None and two is not None and one.dimension == two.dimension
    assert float(one.to(Fraction(value), two)) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    "text",
    ["", "rad rad rad rad rad rad rad rad rad rad", "/s", "rad//s", "degC/s", "m^", "×", "rad s " * 60],
)
def test_what_is_no_unit(text: str) -> None:
    assert unit(text) is None
