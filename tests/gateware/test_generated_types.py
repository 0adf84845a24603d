# SPDX-License-Identifier: BSD-3-Clause
"""Types, arrays, access modes, events and components in generated designs."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from unitylink.board_configuration import BoardConfiguration
from unitylink.spec import compile_text
from unitylink.spec.model import Component, Device, Element, Instance, Link, Spec, SubscriptionGroup
from unitylink.spec.types import EnumType, EnumValue, Field, ValueType

TEXT = """
public typed() {
   @flags = 0x0: READ();
   @mode = 0x1: WRITE();
   @status = 0x2: READ();
   @wide = 0x4: WRITE();
   @wide_in = 0x6: READ();
   @kick = 0x8: WRITE();
   @sticky = 0x9: READ();
   @count = 0xA: READ();
   @ok = 0xB: READ();
   @angle = 0xC: WRITE();
   @duty_0 = 0x10: WRITE();
   @duty_1 = 0x11: WRITE();
   leg_0: leg() @ (0x20,0x21);
   leg_1: leg() @ (0x22,0x23);
   drive: pwm();
}
leg(): @ (pos,sp) {
   @pos: signed READ();
   @sp: signed WRITE();
}
pwm() { @control = 0x40: WRITE(); }
"""
VALUES = (EnumValue("idle", 0), EnumValue("run", 1, "it moves"), EnumValue("stop", 3))
MODE = ValueType("enum", 2, enum=EnumType("mode", 2, VALUES), name="mode")
READY = Field("ready", ValueType("bool", 1), 0, 0, "ready to go")
FIELDS = (READY, Field("mode", MODE, 1, 2), Field("count", ValueType("uint", 4), 4, 7))
NEW: dict[str, dict[str, Any]] = {
    "mode": {"type": MODE, "initial": 1, "safe": 0},
    "status": {"type": ValueType("bits", 8, fields=FIELDS, name="status")},
    "wide": {"type": ValueType("uint", 64), "words": 2},
    "wide_in": {"type": ValueType("int", 40), "words": 2},
    "kick": {"access": "PULSE"},
    "sticky": {"access": "W1C", "type": ValueType("uint", 8)},
    "count": {"access": "READCLEAR"},
    "ok": {"type": ValueType("bool", 1)},
    "angle": {
        "access": "READWRITE",
        "type": ValueType("fixed", 16, 8),
        "unit": "rad",
        "initial": -1.5,
        "documentation": "synthesis translate_off",
    },
    "duty_0": {"type": ValueType("uint", 16), "array": "duty", "index": 0, "name": "duty[0]"},
    "duty_1": {"type": ValueType("uint", 16), "array": "duty", "index": 1, "name": "duty[1]"},
}
PWM = Component("pwm", 0x40, 6, (("channels", 4), ("clock_hz", 0)), (("pins", "out", 4),))


def typed(instance: Instance) -> Instance:
    members: list[Any] = []
    for member in instance.members:
        if isinstance(member, Element) and member.path in NEW:
            members.append(replace(member, **NEW[member.path]))
        elif isinstance(member, Instance) and member.constructor == "leg":
            number = int(member.name[-1])
            members.append(replace(typed(member), array="leg", index=number, name=f"leg[{number}]"))
        elif isinstance(member, Instance):
            members.append(replace(member, component=PWM))
        else:
            members.append(member)
    return replace(instance, members=tuple(members))


@pytest.fixture(scope="module")
def spec() -> Spec:
    classic = compile_text(TEXT, "typed.ul").spec
    assert classic is not None
    root = typed(classic.roots[0])
    elements = {element.path: element for element in root.walk()}
    groups = (
        SubscriptionGroup(0, "on change", "change", 0, None, "", (elements["wide_in"], elements["ok"])),
        SubscriptionGroup(1, "on limit", "event", 0, None, "limit", (elements["sticky"],)),
    )
    return replace(classic, roots=(root,), devices=(Device("typed", None, Link("typed"), groups),))


def test_types_arrays_and_access_modes(designs: Any, spec: Spec) -> None:
    steps = {
        "#RM:0201020A\n": b"#S_RM:0000000100000002",  # mode begins as run
        "#R:0C\n": b"#S_R:0000fe80",  # angle begins at -1.5
        "#W:0100000003\n": b"#S_W",
        "#RM:03020B09\n": b"#S_RM:000000060000000100000003",  # status.mode, ok, sticky
        "#W:0900000001\n": b"#S_W",  # clears one of them
        "#R:09\n": b"#S_R:00000002",
        "#W:0489ABCDEF\n": b"#S_W",
        "#W:0570000012\n": b"#S_W",
        "#RM:03060702\n": b"#S_RM:89abcdef0000001200000076",
        "#R:0A\n": b"#S_R:00000001",  # count: one whole write of wide
        "#R:0a\n": b"#S_R:00000000",  # which reading has cleared
        "#W:0800000007\n": b"#S_W",
        "#R:00\n": b"#S_R:00000001",  # kick has lasted one clock
        "#W:1100000005\n": b"#S_W",
        "#W:23FFFFFFF0\n": b"#S_W",
        "#RM:022022\n": b"#S_RM:00000000fffffff5",
        "#W:4100000064\n": b"#S_W",  # the PWM: a period of 100 clocks, channel 1 always high
        "#W:43000000C8\n": b"#S_W",
        "#W:4000000001\n": b"#S_W",
        "#R:02\n": b"#S_R:00000077",  # status.ready is pin 1
    }
    answers = designs.play(spec, "typed_tb", list(steps))
    assert dict(zip(steps, answers, strict=True)) == {step: text + b"\n" for step, text in steps.items()}


def test_publishes_on_change_and_on_an_event(designs: Any, spec: Spec) -> None:
    configuration = BoardConfiguration.for_spec(spec)
    assert configuration.edge_event_groups == (0, 1)
    steps = ["#WSA:0003060 70B\n".replace(" ", ""), "#WSA:010109\n", "#WIC:0003\n", "#EPS\n"]
    steps += ["#W:0400000007\n", "#W:0400000007\n", "#W:0100000003\n"]
    answers = designs.play(spec, "typed_tb", steps)
    assert b"%PUB:0003000000070000000000000000\n" in answers[4]
    assert answers[5] == b"#S_W\n", "the same value is no change"
    assert b"%PUB:0003000000070000000000000001\n" in answers[6]
    assert b"%PUB:010100000003\n" in answers[6]


def test_synthesis(designs: Any, spec: Spec) -> None:
    assert "entity typed_top is" in designs.library(spec).synthesise("typed_top")


def test_a_narrow_bus(designs: Any, spec: Spec) -> None:
    """Wide values take what their words hold; the packages and the design still agree."""
    configuration = BoardConfiguration.for_spec(spec, data_bits=16)
    assert "entity typed_top is" in designs.library(spec, configuration).synthesise("typed_top")
