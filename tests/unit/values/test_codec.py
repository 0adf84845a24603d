# SPDX-License-Identifier: BSD-3-Clause
"""The codec: a written value is read back.

A value that does not fit is refused or saturates. Arrays work like single values.
"""

from __future__ import annotations

import importlib
import math
import struct
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from unitylink.errors import UnexpectedValue, ValueRangeError
from unitylink.spec.types import INT32, EnumType, EnumValue, Field, ValueType
from unitylink.values import Codec, Quantity, member_text

classes, codec_module, names, quantity = (
    importlib.import_module(f"unitylink.values.{name}") for name in ("classes", "codec", "names", "quantity")
)
MODE = EnumType("mode", 2, (EnumValue("idle", 0), EnumValue("class", 1), EnumValue("stop", 3)))
OPEN = EnumType("level", 4, MODE.values, open=True)
STATUS = ValueType(
    "bits",
    8,
    name="status",
    fields=(
        Field("ready", ValueType("bool", 1), 0, 0),
        Field("mode", ValueType("enum", 2, enum=MODE), 1, 2),
        Field("heat", ValueType("uint", 4), 4, 7, unit="K", scale=0.5, offset=-1.0),
    ),
)

widths = st.integers(1, 64)
buses = st.sampled_from([8, 16, 24, 32])


@st.composite
def numeric(draw: st.DrawFn) -> tuple[Codec, int]:
    """Draw a codec of a whole or fixed-point kind, and a raw number of its width."""
    kind = draw(st.sampled_from(["int", "uint", "fixed", "ufixed"]))
    width = draw(widths)
    fraction = draw(st.integers(0, width)) if kind.endswith("fixed") else 0
    scaled = kind.endswith("fixed") or draw(st.booleans())
    if scaled:
        width = min(width, 48)  # what a float holds exactly, with room for scale and offset
        fraction = min(fraction, width)
    scale = draw(st.sampled_from([1.0, 0.001, -0.5, 3.0, math.pi / 180])) if scaled else 1.0
    offset = draw(st.sampled_from([0.0, -40.0, 1e3])) if scaled and width < 30 and fraction < 20 else 0.0
    quantity = Quantity(ValueType(kind, width, fraction), scale=scale, offset=offset)
    return Codec("v", quantity, draw(buses)), draw(st.integers(0, (1 << width) - 1))


@given(numeric())
def test_round_trip(pair: tuple[Codec, int]) -> None:
    codec, raw = pair
    value = codec.decode(raw)
    assert codec.encode(value) == raw
    assert codec.join(codec.split(raw)) == raw
    assert codec.minimum <= value <= codec.maximum
    many = codec.decode_array(np.array([raw, raw], np.uint64))
    assert many.shape == (2,) and many[0] == many[1] == value


@given(numeric(), st.data())
def test_order_is_kept_and_limits_hold(pair: tuple[Codec, int], data: st.DataObject) -> None:
    kind = pair[0].quantity
    codec = Codec("v", Quantity(kind.type, kind.scale, kind.offset, overflow="saturate"), 32)
    number = st.floats(allow_nan=False) if kind.scaled else st.integers(-(1 << 70), 1 << 70)
    low, high = sorted([data.draw(number), data.draw(number)])
    below, above = codec.decode(codec.encode(low)), codec.decode(codec.encode(high))
    assert codec.minimum <= below <= above <= codec.maximum


@pytest.mark.parametrize("scale", [0.001, -0.001])
def test_limits_are_steps_of_the_raw_number(scale: float) -> None:
    quantity = Quantity(ValueType("int", 16), scale=scale, unit="rad", minimum=-math.pi, maximum=math.pi)
    codec = Codec("hip", quantity, 32)
    for value in (math.pi, -math.pi):
        assert codec.encode(codec.decode(codec.encode(value))) == codec.encode(value)
    for value in (3.15, -3.15, math.inf, math.nan, 10**400):
        with pytest.raises(
            ValueRangeError, match=r"^hip: .* rad is not in -3.14159265 to 3.14159265 rad; nothing"
        ):
            codec.encode(value)
    with pytest.raises(ValueRangeError, match=r"^hip: 'x' is not a number"):
        codec.encode("x")


def test_saturating_still_refuses_nan() -> None:
    codec = Codec("v", Quantity(ValueType("fixed", 16, 8), maximum=20.0, overflow="saturate"), 32)
    assert [codec.decode(codec.encode(value)) for value in (1e9, math.inf, -math.inf)] == [20.0, 20.0, -128.0]
    with pytest.raises(ValueRangeError, match="nan is not in -128 to 20"):
        codec.encode(math.nan)


def test_whole_numbers_only_where_nothing_is_scaled() -> None:
    codec = Codec("n", Quantity(ValueType("int", 16)), 32)
    assert codec.encode(np.int64(-2)) == 0xFFFE
    with pytest.raises(ValueRangeError, match=r"n: 1.5 is not an integer; round it"):
        codec.encode(1.5)
    assert codec.decode(0xABCD_FFFE) == -2, "bits above the value are not looked at"


@given(st.floats(width=32))
def test_single_floats_are_exact(value: float) -> None:
    codec = Codec("f", Quantity(ValueType("float", 32)), 16)
    raw = codec.encode(value)
    assert struct.pack("<f", value) == struct.pack("<I", raw) or math.isnan(value)
    back = codec.decode(raw)
    assert back == value or (math.isnan(back) and math.isnan(value))
    assert len(codec.split(raw)) == 2 and codec.join(codec.split(raw)) == raw


@given(st.floats())
def test_double_floats_are_exact(value: float) -> None:
    codec = Codec("f", Quantity(ValueType("float", 64)), 32)
    back = codec.decode(codec.join(codec.split(codec.encode(value))))
    assert back == value or (math.isnan(back) and math.isnan(value))
    many = codec.decode_array(np.array([codec.encode(value)], np.uint64))[0]
    assert many == value or (math.isnan(many) and math.isnan(value))


def test_floats_with_limits() -> None:
    single = ValueType("float", 32)
    codec = Codec("f", Quantity(single, minimum=-1.0, maximum=1.0, unit="m"), 32)
    for value in (1.1, math.inf, math.nan):
        with pytest.raises(ValueRangeError, match=r"is not in -1 to 1 m"):
            codec.encode(value)
    with pytest.raises(ValueRangeError, match="1e\\+39 is not in"):
        Codec("f", Quantity(single), 32).encode(1e39)
    saturating = Codec("f", Quantity(single, overflow="saturate"), 32)
    assert saturating.decode(saturating.encode(1e39)) == pytest.approx(3.4028235e38)


@pytest.mark.parametrize("bits", [16, 32, 64])
@pytest.mark.parametrize("overflow", ["error", "saturate"])
def test_a_set_point_is_finite(bits: int, overflow: str) -> None:
    """The value of a sensor need not be finite: `test_single_floats_are_exact`."""
    codec = Codec("f", Quantity(ValueType("float", bits), overflow=overflow), 32, commanded=True)
    with pytest.raises(ValueRangeError, match="f: nan is not in"):
        codec.encode(math.nan)
    for value in (math.inf, -math.inf, 10**400):
        if overflow == "error":
            with pytest.raises(ValueRangeError, match="is not in"):
                codec.encode(value)
        else:
            assert math.isfinite(codec.decode(codec.encode(value)))


@pytest.mark.parametrize("value", ["3.5", b"3", None, [1.0], np.array([1.0]), 1j, object()])
def test_what_is_no_number_is_refused(value: Any) -> None:
    for kind in (
        ValueType("float", 32),
        ValueType("fixed", 16, 8),
        ValueType("int", 16),
        ValueType("bool", 1),
    ):
        with pytest.raises(ValueRangeError, match=r"^f: .*othing was sent"):
            Codec("f", Quantity(kind), 32).encode(value)


def test_enumerations() -> None:
    codec = Codec("m", Quantity(ValueType("enum", 2, enum=MODE)), 8)
    run = codec.decode(1)
    assert (run.name, int(run), codec.encode(run), codec.encode("class")) == ("class_", 1, 1, 1)
    assert member_text(codec.type, run) == "class"
    for wrong in ("fast", 2, 4, None, 1.0):
        with pytest.raises(ValueRangeError, match=r"m: .*there are idle \(0\), class \(1\), stop \(3\)"):
            codec.encode(wrong)
    with pytest.raises(UnexpectedValue, match=r"m: .* holds 2, which is no mode; .* `open enum mode`"):
        codec.decode(2)
    free = Codec("l", Quantity(ValueType("enum", 4, enum=OPEN)), 8)
    assert free.decode(9) == 9 and free.encode(9) == 9
    with pytest.raises(ValueRangeError):
        free.encode(16)


def test_packed_values_are_records() -> None:
    codec = Codec("s", Quantity(STATUS), 32)
    status = codec.decode(0b0110_0011)
    assert (status.ready, status.mode.name, status.heat) == (True, "class_", 2.0)
    assert codec.encode(status) == codec.encode({"ready": True, "mode": "class", "heat": 2.0}) == 0b0110_0011
    assert codec.encode(0x63) == 0x63
    wrong: list[tuple[Any, str]] = [
        ({"ready": True, "mode": 0}, "s: heat missing"),
        (
            {"ready": True, "mode": 0, "heat": 1, "cold": 2},
            "s: no field cold; .*ready, mode, heat",
        ),
        ({"ready": 2, "mode": 0, "heat": 1}, "s.ready: 2 is neither"),
        ({"ready": 1, "mode": 0, "heat": 99}, "s.heat: 99 K is not in -1 to 6.5 K"),
        (256, "s: 256 is not in"),
        (0b100, r"s\.mode: 4: the device holds 2, which is no mode; .*nothing was sent"),
        (10**5000, "s: a number that is too long to be shown is not in"),
        ("3", "s: ready, mode, heat missing"),
    ]
    for value, text in wrong:
        with pytest.raises(ValueRangeError, match=text):
            codec.encode(value)
    with pytest.raises(UnexpectedValue, match=r"s\.mode"):
        codec.decode(0b100)


def test_bool_and_classic_words() -> None:
    codec = Codec("b", Quantity(ValueType("bool", 1)), 32)
    assert (codec.encode(np.bool_(True)), codec.decode(2), codec.decode(3)) == (1, False, True)
    with pytest.raises(ValueRangeError, match="neither true nor false"):
        codec.encode(2)
    word = Codec("w", Quantity(INT32), 24)
    assert (word.minimum, word.maximum, word.encode(-1)) == (-(1 << 23), (1 << 23) - 1, 0xFFFFFF)
    assert word.integer_sign == 1 << 23


@pytest.mark.parametrize(
    ("quantity", "text"),
    [
        (Quantity(scale=0.0), "scale"),
        (Quantity(scale=math.nan), "scale"),
        (Quantity(ValueType("float", 24)), "16, 32 or 64 bits"),
        (Quantity(overflow="wrap"), "overflow"),
        (Quantity(ValueType("enum", 2)), "without its names"),
    ],
)
def test_impossible_quantities_are_refused(quantity: Quantity, text: str) -> None:
    with pytest.raises(ValueRangeError, match=text):
        Codec("q", quantity, 32)


@pytest.mark.parametrize(
    ("scale", "offset", "raw", "text"),
    [(0.01, 0, 1254, "12.54"), (0.001, 0, 8191, "8.191"), (0.1, -40, 653, "25.3"), (0.3, 0, 3, "0.9")],
)
def test_a_decimal_scale_gives_the_decimal_number_that_is_meant(
    scale: float, offset: float, raw: int, text: str
) -> None:
    codec = Codec("x", Quantity(ValueType("int", 16), scale=scale, offset=offset), 32)
    assert repr(codec.decode(raw)) == text
    assert repr(codec.decode_array(np.array([raw], np.uint64)).tolist()) == f"[{text}]"
    assert codec.encode(codec.decode(raw)) == raw


def test_members_are_printed_by_name_and_are_numbers() -> None:
    codec = Codec("m", Quantity(ValueType("enum", 2, enum=MODE)), 32)
    stop = codec.decode(3)
    texts = (str(stop), f"{stop}", f"{stop:>6}", f"{stop:d}", f"{stop:02x}")
    assert (texts, stop + 1) == (("stop", "stop", "  stop", "3", "03"), 4)
