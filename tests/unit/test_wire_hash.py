# SPDX-License-Identifier: BSD-3-Clause
"""The wire hash: what reaches the wire changes it, and nothing else."""

from __future__ import annotations

import pytest

from unitylink.spec import compile_text
from unitylink.wire_hash import wire_hash

SPEC = """
// the motor
public robot() {
    @power = 0x10: u16 WRITE(UNIT="mV", MAX=1000, SAFE=7);
    @speed = 0x11: i32 READ(PUBLISH(1, 10));
}
"""


def of(text: str, data_bits: int = 32) -> int:
    result = compile_text(text)
    assert result.spec is not None, result
    return wire_hash(result.spec, data_bits)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("// the motor", ""),
        ("power", "voltage"),
        ('UNIT="mV", ', ""),
        ("MAX=1000", "MAX=999"),
        ("robot", "arm"),
    ],
)
def test_names_units_and_limits_do_not_count(old: str, new: str) -> None:
    assert old in SPEC
    assert of(SPEC.replace(old, new)) == of(SPEC)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("0x10", "0x12"),
        ("u16", "u8"),
        ("SAFE=7", "SAFE=8"),
        (", SAFE=7", ""),
        ("WRITE(", "READWRITE("),
        ("(1, 10)", "(1, 20)"),
    ],
)
def test_what_reaches_the_wire_counts(old: str, new: str) -> None:
    assert old in SPEC
    assert of(SPEC.replace(old, new).replace("MAX=1000", "MAX=200")) != of(SPEC)


def test_the_width_of_the_bus_counts() -> None:
    assert of(SPEC, 32) != of(SPEC, 16)
