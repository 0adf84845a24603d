# SPDX-License-Identifier: BSD-3-Clause
"""Types, arrays, access modes, events and components in generated designs."""

from __future__ import annotations

from typing import Any

import pytest

from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.spec import Spec, compile_text, render

TEXT = """
enum mode: u2 {
   idle = 0;
   /// it moves
   run = 1;
   stop = 3;
}
bits status: u8 {
   /// ready to go
   ready: bool @ 0;
   mode: mode @ 2..1;
   count: u4 @ 7..4;
}
public typed() {
   @flags = 0x0: READ();
   @mode = 0x1: mode WRITE(INITIAL=run, SAFE=idle);
   @status = 0x2: status READ();
   @wide = 0x4: u64 WRITE();
   @wide_in = 0x6: i40 READ(PUBLISH(on change));
   @kick = 0x8: PULSE();
   @sticky = 0x9: u8 W1C(PUBLISH(on limit));
   @count = 0xA: READCLEAR();
   @ok = 0xB: bool READ(PUBLISH(on change));
   /// synthesis translate_off
   @angle = 0xC: fixed(8,8) READWRITE(UNIT="rad", INITIAL=-1.5);
   @duty[2] = 0x10: u16 WRITE();
   leg[2]: leg() @ (0x20+i*2,0x21+i*2);
   drive: pwm(channels=4) @ 0x40;
}
leg(): @ (pos,sp) {
   @pos: signed READ();
   @sp: signed WRITE();
}
"""


@pytest.fixture(scope="module")
def spec() -> Spec:
    result = compile_text(TEXT, "typed.ul")
    assert result.spec is not None, render(result.diagnostics)
    return result.spec


def test_types_arrays_and_access_modes(designs: Any, spec: Spec) -> None:
    steps = {
        "#RM:0201020A\n": b"#S_RM:0000000100000002",  # mode starts as run
        "#R:0C\n": b"#S_R:0000fe80",  # angle starts at -1.5
        "#W:0100000003\n": b"#S_W",
        "#RM:03020B09\n": b"#S_RM:000000060000000100000003",  # status.mode, ok, sticky
        "#W:0900000001\n": b"#S_W",  # clears one of the flags
        "#R:09\n": b"#S_R:00000002",
        "#W:0489ABCDEF\n": b"#S_W",
        "#W:0570000012\n": b"#S_W",
        "#RM:03060702\n": b"#S_RM:89abcdef0000001200000076",
        "#R:0A\n": b"#S_R:00000001",  # the count: wide was written as a whole once
        "#R:0a\n": b"#S_R:00000000",  # the read has cleared it
        "#W:0800000007\n": b"#S_W",
        "#R:00\n": b"#S_R:00000001",  # kick was high for one clock
        "#W:1100000005\n": b"#S_W",
        "#W:23FFFFFFF0\n": b"#S_W",
        "#RM:022022\n": b"#S_RM:00000000fffffff5",
        "#W:4200000064\n": b"#S_W",  # the PWM: channel 0 is high for 100/4096 of a period, channel 1 always
        "#W:4300001000\n": b"#S_W",
        "#W:4000000001\n": b"#S_W",
        "#R:02\n": b"#S_R:00000077",  # status.ready is pin 1
    }
    answers = designs.play(spec, "typed_tb", list(steps))
    assert dict(zip(steps, answers, strict=True)) == {step: text + b"\n" for step, text in steps.items()}


def test_publishes_on_change_and_on_an_event(designs: Any, spec: Spec) -> None:
    configuration = BoardConfiguration.for_spec(spec)
    assert configuration.edge_events == (0, 1)
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
    """Wide values take as many bits as their words hold. The packages and the design still agree."""
    configuration = BoardConfiguration.for_spec(spec, data_bits=16)
    assert "entity typed_top is" in designs.library(spec, configuration).synthesise("typed_top")
