# SPDX-License-Identifier: BSD-3-Clause
"""Which items `watch`, `record` and `plot` take."""

from __future__ import annotations

import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from unitylink.cli import main
from unitylink.commands.failure import Failure
from unitylink.commands.link_option import Target
from unitylink.commands.names import Names
from unitylink.commands.sampling_options import sampled_items
from unitylink.errors import BusError
from unitylink.simulate import Board
from unitylink.spec import compile_text, load


class Still:
    """A plant in which nothing moves."""

    period_s = 0.001

    def attach(self, spec: object, registers: object) -> None:
        """Need nothing."""

    def step(self, time_s: float) -> None:
        """Change nothing."""


SPEC = """
public arm() {
   @position = 0x1: READ();
   @target = 0x2: WRITE();
   @mode = 0x3: u8 READWRITE();
   @faults = 0x4: u8 W1C();
   @steps = 0x5: READCLEAR();
   @start = 0x6: PULSE();
}
"""


def target(text: str) -> Target:
    link: Any = SimpleNamespace(url="sim:arm.ul")
    return Target(link, Names(compile_text(text).spec))


def items(*names: str) -> list[str]:
    return [item.name for item in sampled_items(target(SPEC), names, "watch")]


def test_without_names_all_items_that_a_read_does_not_change_are_taken() -> None:
    assert items() == ["position", "mode", "faults"]


def test_an_item_that_a_read_changes_is_taken_only_by_its_own_name() -> None:
    assert items("arm") == ["position", "target", "mode", "faults"]
    assert items("steps", "target", "0x20") == ["steps", "target", "0x0020"]


class HalfDumb:
    """A link whose device does not let some words be read back."""

    url = "sim:arm.ul"

    def __init__(self, refused: set[int]) -> None:
        self.refused = refused

    def read(self, address: int) -> int:
        if address in self.refused:
            raise BusError("refused")
        return 0


@pytest.mark.parametrize("refused", [set[int](), {0x2}])
def test_set_points_are_items_that_the_device_allows_to_read_back(
    refused: set[int], capsys: pytest.CaptureFixture[str]
) -> None:
    link: Any = HalfDumb(refused)
    half = Target(link, Names(compile_text(SPEC).spec))
    found = [item.name for item in sampled_items(half, (), "record", set_points=True)]
    assert found == ["position", *(["target"] if not refused else []), "mode", "faults"]
    note = "note: target left out: the device does not allow reading it back\n"
    assert capsys.readouterr().err == (note if refused else "")


@pytest.mark.parametrize("name", ["watch", "record"])
def test_a_value_published_on_change_has_a_sample_before_it_changes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    spec = tmp_path / "door.ul"
    spec.write_text("public door() { @open = 0x1: u8 READ(PUBLISH(on change)); }")
    out = tmp_path / "door.csv"
    with Board(load(spec), plant=Still(), endpoint="tcp") as board:
        board.registers[1] = 3
        given = [f"{board.url}?timeout=2", "--spec", str(spec), "--count", "1", "--duration", "60"]
        assert main([name, *given, *(["--out", str(out)] if name == "record" else [])]) == 0
    shown = out.read_text() if name == "record" else capsys.readouterr().out
    assert re.search(r"[=,]3$", shown.strip(), re.M), shown


def test_nothing_is_told_with_what_to_do() -> None:
    with pytest.raises(Failure, match=r"there is nothing to plot on sim:arm\.ul") as failed:
        sampled_items(target("public arm() { @start = 0x6: PULSE(); }"), (), "plot")
    assert "--spec FILE.ul" in failed.value.help_line
