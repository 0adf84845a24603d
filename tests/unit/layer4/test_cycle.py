# SPDX-License-Identifier: BSD-3-Clause
"""A control loop: each call writes all outputs and reads all inputs."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from unitylink import Link
from unitylink.errors import ValueRangeError
from unitylink.layer4_data import ValueGroup, load_spec_objects
from unitylink.simulate import Board, BoardConfiguration
from unitylink.spec import Spec, compile_text, load

TEXT = """
public drive() {
   @angle = 0x10: i16 READ(UNIT="rad", SCALE=0.001);
   @ready = 0x11: bool READ();
   @target = 0x12: i16 WRITE(UNIT="rad", SCALE=0.001, INITIAL=0);
   @on = 0x13: bool WRITE();
   @turns = 0x14: i48 READWRITE();
   @lost = 0x16: u16 READCLEAR();
}"""


def drive() -> Spec:
    spec = compile_text(TEXT, "drive.ul").spec
    assert spec is not None
    return spec


@pytest.fixture(params=["both", "classic"])
def link(request: pytest.FixtureRequest) -> Iterator[Link]:
    configuration = BoardConfiguration.for_spec(drive(), protocol=request.param)
    with Board(configuration=configuration) as board, Link(f"{board.url}?timeout=2") as link:
        link.board = board
        yield link


def test_each_call_writes_and_reads_all(link: Link) -> None:
    robot = load_spec_objects(drive(), link)
    registers = link.board.registers
    registers[0x10], registers[0x11] = 0xFFFF_FFFF, 0xFFFF_FF00  # bits above the type's own are ignored
    with robot.cycle() as cycle:
        with pytest.raises(ValueRangeError, match="on, turns: no value yet"):
            cycle()
        with pytest.raises(ValueRangeError, match=r"target: 99 rad"):
            cycle(target=99, on=True, turns=1)
        assert registers[0x12] == 0, "nothing was sent"
        state = cycle(on=True, turns=-5)
        assert dict(state) == {"angle": pytest.approx(-0.001), "ready": False, "turns": -5}
        registers[0x10], registers[0x11] = 250, 1
        state = cycle({"target": -0.25})
        assert (state["angle"], state["ready"], state["turns"]) == (pytest.approx(0.25), True, -5)
        assert [registers[0x12], registers[0x13], registers[0x15]] == [0x10000 - 250, 1, 0xFFFF]
        assert (robot["target"].latest, robot["turns"].latest) == (pytest.approx(-0.25), -5)


def test_on_a_framed_link_it_is_one_message_of_bare_data(link: Link) -> None:
    with load_spec_objects(drive(), link).cycle() as cycle:
        cycle(on=True, turns=0)
        before = link.statistics()
        cycle()
        after = link.statistics()
        assert cycle.atomic == (link.protocol == "framed")
        if cycle.atomic:
            assert after.requests == before.requests + 1
            # kind, COBS, id, group, 2 + 1 + 6 of outputs, check, border
            assert after.bytes_sent - before.bytes_sent == 1 + 1 + 3 + 9 + 3 + 1
            assert not cycle.notice
        else:
            assert "no framed protocol" in cycle.notice


def test_too_large_for_a_group_it_names_its_words_each_time() -> None:
    rows = "\n".join(
        f"@x{n} = 0x{n:x}: u8 WRITE(INITIAL=1); @y{n} = 0x{100 + n:x}: u8 READ();" for n in range(17)
    )
    spec = compile_text(f"public wide() {{ {rows} }}", "wide.ul").spec
    assert spec is not None
    configuration = BoardConfiguration.for_spec(spec, exchange_size=32)
    with (
        Board(configuration=configuration) as board,
        Link(f"{board.url}?timeout=2") as link,
        load_spec_objects(spec, link).cycle() as cycle,
    ):
        before = link.statistics().requests
        board.registers[100] = 9
        assert cycle(x0=4)["y0"] == 9
        assert link.statistics().requests == before + 1
        assert cycle.atomic and "too large" in cycle.notice
        assert board.registers[0] == 4


def test_outputs_behind_a_commit_go_first() -> None:
    spec = load("examples/scara/scara.ul")
    with Board(spec) as board, Link(f"{board.url}?timeout=2") as link:
        robot = load_spec_objects(spec, link)
        outputs = [value for value in robot if value.path in ("j1.pos_sp", "j1.spd_sp", "j1.cpos")]
        with ValueGroup(outputs).cycle() as cycle:
            assert not cycle.atomic and "commit" in cycle.notice
            state = cycle(pos_sp=-100, spd_sp=5)
            assert list(state) == ["j1.cpos"]
            assert board.registers.signed(robot["j1.pos_sp"].address) == -100  # type: ignore[union-attr]


def test_what_reading_changes_cannot_be_in_it(link: Link) -> None:
    robot = load_spec_objects(drive(), link)
    with pytest.raises(ValueRangeError, match="lost: a read of it has a side effect"):
        ValueGroup([robot["lost"]]).cycle()  # type: ignore[list-item]
