# SPDX-License-Identifier: BSD-3-Clause
"""The wire hash: a change that could move the wrong joint changes it, and no other change does."""

from __future__ import annotations

import pytest

from unitylink.interface.wire_hash import wire_hash, wire_hashes
from unitylink.spec import Spec, compile_text

SPEC = """
// the motor
enum mode: u2 { idle = 0; run = 1; }
bits flags: u8 { hot: bool @ 0; level: u3 @ 6..4 (UNIT="V", SCALE=0.5); }
public robot() {
    @power = 0x10: u16 WRITE(ID="it", UNIT="V", SCALE=0.5, OFFSET=1, MIN=2, MAX=1000, INITIAL=7, SAFE=5);
    @speed = 0x11: i32 READ(PUBLISH(1, 10));
    @mode = 0x12: mode WRITE();
    @flags = 0x13: flags READ(PUBLISH(on change));
    x: axis() @ (0x20);
    y: axis() @ (0x21);
    both = x.target, y.target;
}
axis(): @ (target) { @target: fixed(8, 8) WRITE(); }
"""


def spec_of(text: str) -> Spec:
    result = compile_text(text)
    assert result.spec is not None, [str(one) for one in result.diagnostics]
    return result.spec


def of(text: str) -> int:
    return wire_hash(spec_of(text))


HARMLESS = [
    ("// the motor", ""),
    ('ID="it", ', ""),
    ("(1, 10)", "(1, 20)"),  # the program asks for the rate of its own spec
    ("enum mode", "enum way"),
    ("bits flags", "bits signs"),
    ("both =", "pair ="),
    ("MIN=2,", "MIN=2.0,"),
    ("    @speed = 0x11: i32 READ(PUBLISH(1, 10));\n    @mode = 0x12: mode WRITE();\n", "REVERSED"),
    ("READ(PUBLISH(1, 10))", "READ(CRC, PUBLISH(1, 10))"),
]
HARMFUL = [
    ("robot()", "arm()"),
    ("@power", "@voltage"),
    ("x: axis() @ (0x20);\n    y: axis() @ (0x21);", "x: axis() @ (0x21);\n    y: axis() @ (0x20);"),
    ("0x10", "0x18"),
    ("u16 WRITE", "u15 WRITE"),
    ("u16 WRITE", "i16 WRITE"),
    ("fixed(8, 8)", "fixed(4, 12)"),
    ("WRITE(ID", "READWRITE(ID"),
    ('UNIT="V", SCALE', 'UNIT="mV", SCALE'),
    ("SCALE=0.5, OFFSET", "SCALE=0.25, OFFSET"),
    ("OFFSET=1", "OFFSET=0"),
    ("MIN=2", "MIN=3"),
    ("MAX=1000", "MAX=999"),
    ("INITIAL=7", "INITIAL=8"),
    (", SAFE=5", ", SAFE=6"),
    (", SAFE=5", ""),
    ("run = 1", "run = 2"),
    ("idle = 0; run = 1", "idle = 1; run = 0"),
    ("enum mode", "open enum mode"),
    ("run", "walk"),
    ("6..4", "7..5"),
    ("hot", "cold"),
    ('UNIT="V", SCALE=0.5)', 'UNIT="V", SCALE=0.25)'),
    ("(on change)", "(1, 10)"),
]


@pytest.mark.parametrize(("old", "new"), HARMLESS)
def test_what_can_do_no_harm_does_not_count(old: str, new: str) -> None:
    assert old in SPEC
    if new == "REVERSED":
        new = "\n".join(reversed(old.rstrip("\n").split("\n"))) + "\n"
    changed = SPEC.replace(old, new)
    if old.startswith(("enum", "bits")):  # also where the type is used
        name = old.split()[1]
        changed = changed.replace(f": {name} ", f": {new.split()[1]} ")
    assert of(changed) == of(SPEC)


@pytest.mark.parametrize(("old", "new"), HARMFUL)
def test_what_could_move_the_wrong_joint_counts(old: str, new: str) -> None:
    assert old in SPEC
    assert of(SPEC.replace(old, new)) != of(SPEC)


def test_the_hardware_behind_an_address_counts() -> None:
    text = "public a() { @x = 0x1: WRITE(); }"
    bound = "public a() { DOUBLE_BUFFER(BASE=0, SIZE=16); @x = 0x1: WRITE(); }"
    assert of(bound) not in (of(text), of(bound.replace("16", "32")))


def test_two_arms_are_two_gatewares() -> None:
    """The same arm twice, each behind its own link. So swapped cables are noticed."""
    both = "public left() { @x = 0x1: WRITE(); } public right() { @x = 0x1: WRITE(); }"
    spec = spec_of(both)
    whole, left = wire_hashes(spec, "left")
    assert (whole, left) == (wire_hash(spec), of("public left() { @x = 0x1: WRITE(); }"))
    assert left != wire_hashes(spec, "right")[1]
    assert wire_hashes(spec.only("left"), "left") == (left,)
