# SPDX-License-Identifier: BSD-3-Clause
"""The table of bitstreams on docs/robots.md is the record of `make bitstreams`, and fits the sources."""

from __future__ import annotations

import importlib
import json
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[3]
RECORD = json.loads((ROOT / "gateware" / "bitstreams.json").read_text("utf-8"))
ROBOTS = ("xyz_stage", "diff_drive", "scara_stepper", "bus_arm", "foc_joint")


@pytest.fixture
def bitstreams(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Import tools/synth/bitstreams.py, which is in no package."""
    monkeypatch.syspath_prepend(str(ROOT / "tools" / "synth"))
    return importlib.import_module("bitstreams")


def test_every_robot_has_two_boards(bitstreams: Any) -> None:
    commands = bitstreams.commands(bitstreams.PAGE.read_text("utf-8"))
    assert {command.robot for command in commands} == set(ROBOTS)
    for robot in ROBOTS:
        assert len({command.board for command in commands if command.robot == robot}) >= 2


def test_the_record_is_of_the_specs_the_boards_and_the_pins(bitstreams: Any) -> None:
    commands = {command.name: command for command in bitstreams.commands(bitstreams.PAGE.read_text("utf-8"))}
    assert RECORD.keys() <= commands.keys()
    stale = [name for name in RECORD if RECORD[name]["inputs"] != bitstreams.inputs_digest(commands[name])]
    assert not stale, "`make bitstreams CHANGED=1` builds them"
    assert bitstreams.complaints(RECORD) == [], "each is fast enough and leaves room on its chip"


def test_the_table_is_the_record(bitstreams: Any) -> None:
    page = bitstreams.PAGE.read_text("utf-8")
    assert page == bitstreams.with_table(page, RECORD)
    other = {**RECORD, next(iter(RECORD)): {**next(iter(RECORD.values())), "mhz": 1.0}}
    assert page != bitstreams.with_table(page, other)
    assert "not built yet" in bitstreams.with_table(page, {})
    with pytest.raises(ValueError, match="not 0 times"):
        bitstreams.with_table("no table", RECORD)


def test_a_design_that_is_too_slow_or_too_large_is_told(bitstreams: Any) -> None:
    good = {"cells": [80, 100], "memories": [8, 10], "mhz": 48.0, "asked_mhz": 48.0}
    assert bitstreams.complaints({"a": good}) == []
    for worse in ({"cells": [81, 100]}, {"memories": [9, 10]}, {"mhz": 47.9}):
        assert len(bitstreams.complaints({"a": {**good, **worse}})) == 1


def test_another_pin_makes_another_digest_and_a_comment_does_not(
    bitstreams: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    spec, manifest = tmp_path / "a.ul", tmp_path / "boards" / "b" / "board.toml"
    manifest.parent.mkdir(parents=True)
    monkeypatch.setattr(bitstreams, "ROOT", tmp_path)
    one, other = (
        bitstreams.Command(spec="a.ul", robot="a", board="b:c", pins=(pin,)) for pin in ("d=1", "d=2")
    )

    def digests(spec_text: str, manifest_text: str) -> tuple[str, str]:
        spec.write_text(spec_text, "utf-8")
        manifest.write_text(manifest_text, "utf-8")
        return bitstreams.inputs_digest(one), bitstreams.inputs_digest(other)

    plain = digests("public a() { }\n", "hz = 1\n")
    assert plain[0] != plain[1]
    assert digests("// why\npublic a() { } // so\n\n", "hz = 1  # of the chip\n") == plain
    assert digests("public a() { led: led(); }\n", "hz = 1\n")[0] != plain[0]
    assert digests("public a() { }\n", "hz = 2\n")[0] != plain[0]
