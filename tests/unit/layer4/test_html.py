# SPDX-License-Identifier: BSD-3-Clause
"""What a notebook shows of a robot, also when its board is silent."""

from __future__ import annotations

import time
from collections.abc import Iterator
from html.parser import HTMLParser
from typing import Any

import pytest
from unit.dashboard.robot import Still
from unit.link.cut_wire import CutWire

from unitylink import Link
from unitylink.html_table import html_table
from unitylink.layer4_data import Node, load_spec_objects
from unitylink.layer4_data.html import HEADERS, MOST, values_html
from unitylink.simulate import Board, BoardConfiguration
from unitylink.spec import compile_text

REFUSED = 0x60  # the bus of the board refuses this address
TEXT = """
enum Grip: u8 { open = 0; hold = 1; }
joint(name: string): @ (angle, target) {
   @angle: i16 READ(ID=name, UNIT="deg", SCALE=0.1, PUBLISH(100 Hz));
   @target: i16 WRITE(UNIT="deg", SCALE=0.1, MIN=-90, MAX=90);
}
public arm() {
   j1: joint("<script>&") @ (0x10, 0x12);
   leg[2]: joint("leg") @ (0x20+4*i, 0x22+4*i);
   @grip = 0x30: Grip READWRITE();
   @level = 0x31: u8 READ(MIN=1, MAX=5);
   @count = 0x33: u16 READCLEAR();
   @reset = 0x34: bool PULSE();
   @broken = 0x60: u16 READ();
}
"""


class Tables(HTMLParser):
    """The rows of a table, its title, and the names of all elements."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.title, self.elements, self._cell = "", set[str](), ""
        self.feed(html)
        self.close()

    def handle_starttag(self, tag: str, attributes: Any) -> None:
        self.elements.add(tag)
        self._cell = ""
        if tag == "tr":
            self.rows.append([])

    def handle_data(self, data: str) -> None:
        self._cell += data

    def handle_endtag(self, tag: str) -> None:
        if tag in ("td", "th"):
            self.rows[-1].append(self._cell)
        if tag in {"caption", "b"}:
            self.title += self._cell
            self._cell = ""


class Arm:
    """A robot, and the wire to its board. `count` says how many requests there have been."""

    def __init__(self, link: Link, board: Board, wire: CutWire) -> None:
        spec = compile_text(TEXT, "arm.ul").spec
        assert spec is not None
        self.link, self.board, self.wire = link, board, wire
        self.robot = load_spec_objects(spec, link)

    @property
    def count(self) -> int:
        return self.link.statistics().requests

    def rows(self, part: Any = None) -> dict[str, list[str]]:
        table = Tables((self.robot if part is None else part)._repr_html_())
        assert table.rows[0] == list(HEADERS)
        return {row[0]: row[1:] for row in table.rows[1:]}


@pytest.fixture
def arm() -> Iterator[Arm]:
    spec = compile_text(TEXT, "arm.ul").spec
    assert spec is not None
    configuration = BoardConfiguration.for_spec(spec, bus_error_ranges=((REFUSED, REFUSED),))
    with Board(spec, configuration=configuration, plant=Still(), endpoint="tcp") as board:
        wire = CutWire(board.url)
        with Link(f"{wire.url}?timeout=1") as link:
            yield Arm(link, board, wire)
        wire.close()


def test_a_robot_is_a_table_with_units_addresses_and_ranges(arm: Arm) -> None:
    arm.board.registers[0x10], arm.board.registers[0x30] = 123, 1
    arm.robot["j1.target"].write(5)  # type: ignore[union-attr]
    rows = arm.rows()
    assert rows["j1.target"] == ["5", "deg", "WRITE", "0x0012", "-90 to 90"]
    assert rows["grip"] == ["hold", "", "READWRITE", "0x0030", ""]
    assert rows["level"][4] == "1 to 5" and rows["j1.angle"][1:] == ["deg", "READ", "0x0010", ""]
    assert rows["broken"][0] == "bus error"
    assert rows["count"][0] == "-" and rows["reset"][0] == "-", "a read would change it, or has no meaning"
    assert len(rows) == len(list(arm.robot))


def test_every_text_is_escaped(arm: Arm) -> None:
    table = Tables(html_table("<i>", ["<b>"], [["<script>", "</td>&"]], "<u>"))
    assert table.rows == [["<b>"], ["<script>", "</td>&"]] and table.title == "<i><u>"
    assert not {"i", "u", "script"} & table.elements
    html = arm.robot.j1.angle._repr_html_()  # type: ignore[attr-defined]
    assert Tables(html).title == "<script>&" and "script" not in Tables(html).elements


@pytest.mark.parametrize(("part", "names"), [("j1", ["j1.angle", "j1.target"]), ("grip", ["grip"])])
def test_a_part_and_a_value(arm: Arm, part: str, names: list[str]) -> None:
    assert list(arm.rows(arm.robot[part])) == names


def test_an_array_shows_its_members(arm: Arm) -> None:
    names = [f"leg[{number}].{name}" for number in (0, 1) for name in ("angle", "target")]
    assert list(arm.rows(arm.robot.leg)) == names  # type: ignore[attr-defined]


def test_what_publishes_bring_is_not_read(arm: Arm) -> None:
    angle = arm.robot.j1.angle  # type: ignore[attr-defined]
    arm.board.registers[0x10] = 77
    with arm.robot.publishing():
        while angle.latest != 7.7:
            time.sleep(0.01)
        before = arm.count
        assert arm.rows(angle)["j1.angle"][0] == "7.7"
        assert arm.count == before
    before = arm.count
    arm.rows(angle)
    assert arm.count == before + 1


def test_a_silent_board_is_asked_once_and_what_is_known_is_shown(arm: Arm) -> None:
    arm.board.registers[0x10] = 50
    arm.rows()
    arm.wire.stopped = True
    before = arm.count
    table = Tables(arm.robot._repr_html_())
    rows = {row[0]: row[1:] for row in table.rows[1:]}
    assert arm.count - before <= 2, "the first read fails, a SYNC follows, and no further read is tried"
    assert "unreachable" in table.title and "too slowly" not in table.title
    assert rows["j1.angle"][0] != "unreachable" and rows["broken"][0] == "unreachable"


def test_a_closed_link_is_asked_nothing(arm: Arm) -> None:
    arm.link.close()
    before = arm.count
    assert arm.rows()["j1.angle"][0] == "unreachable" and arm.count == before
    assert "closed" in arm.link._repr_html_()


def test_a_slow_board_holds_up_nobody(arm: Arm, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("unitylink.layer4_data.html.READS_S", -1.0)
    before = arm.count
    assert "too slowly" in arm.robot._repr_html_() and arm.count == before


def test_a_link_is_a_table_of_its_counters(arm: Arm) -> None:
    before = arm.count
    facts = dict(Tables(arm.link._repr_html_()).rows[1:])
    assert facts["state"] == "up" and facts["protocol"] == "framed" and int(facts["requests"]) == before


def test_a_large_robot_is_cut_off(arm: Arm) -> None:
    one = next(iter(arm.robot))
    table = Tables(values_html("many", [one] * (MOST + 3)))
    assert len(table.rows) == MOST + 1 and f"the first {MOST} of {MOST + 3} values" in table.title


def test_names_are_offered_after_a_bracket(arm: Arm) -> None:
    assert "j1.angle" in arm.robot._ipython_key_completions_()
    j1 = arm.robot["j1"]
    assert isinstance(j1, Node) and j1._ipython_key_completions_() == ["angle", "target"]
    assert all(arm.robot[path] for path in arm.robot._ipython_key_completions_())
