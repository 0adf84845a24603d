# SPDX-License-Identifier: BSD-3-Clause
"""What makes a design smaller: a message names only what helps, with the figures of the record."""

from __future__ import annotations

import json

import pytest

from unitylink.boards.fit import REMEDIES, remedies, settings_of
from unitylink.errors import BoardError
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.resources import resource_folder
from unitylink.spec import compile_text


def test_what_is_so_already_is_no_remedy() -> None:
    both = list(remedies(BoardConfiguration()))
    assert [text.partition(":")[0] for text in both][:3] == [
        "--protocol classic",
        "--protocol framed",
        "--set engine=small",
    ]
    small = "".join(remedies(BoardConfiguration(protocol="framed", publish_mode=0)))
    assert "engine=small" in small
    lamp = compile_text("public lamp() { @led = 0x10: WRITE(); }").spec
    assert lamp is not None
    smallest = "".join(remedies(BoardConfiguration.for_spec(lamp, engine="small")))
    assert "--" not in smallest, "it is as small as settings make it"
    assert "--protocol" not in small and "--set groups" not in small and "publish_mode" not in small
    assert "fewer words" in small


def test_figures_are_those_of_the_record() -> None:
    path = resource_folder("gateware") / "area.json"
    record = json.loads(path.read_text("utf-8"))["rows"]
    rows = {name: row["ice40"] for name, row in record.items() if "ice40" in row}

    def less(larger: str, smaller: str, kind: str) -> int:
        return int(rows[larger][kind] - rows[smaller][kind])

    def publishing(kind: str) -> int:
        return less("core", "no_publishing", kind)

    for kind, told in (("cells", lambda one: one.cells), ("memories", lambda one: one.memories)):
        expected = {
            "--protocol classic": rows["framed_minimal"][kind],
            "--protocol framed": rows["no_publishing"][kind],
            "--set engine=small": less("framed_minimal", "small_minimal", kind),
            "--set publish_mode=0": publishing(kind),
        }
        for option, figure in expected.items():
            (one,) = [one for one in REMEDIES if one.option.startswith(option)]
            assert told(one) == pytest.approx(figure, rel=0.4, abs=2), f"{option}: {figure} {kind}"
        measured = {
            "--set groups=2": "groups_2",
            "--set lists=false": "no_lists",
            "--set window=16": "window_16",
        }
        for option, row in measured.items():
            (one,) = [one for one in REMEDIES if one.option == option]
            figure = less("shipped", row, kind)
            assert told(one) == pytest.approx(figure, abs=20 if kind == "cells" else 0), f"{option}: {figure}"
    assert {one.option for one in REMEDIES} == expected.keys() | measured.keys(), "each is measured"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("group=2", "there is no setting 'group'; did you mean groups?"),
        ("fast", "there is no setting 'fast'; there are: address_bits"),
        ("groups=two", "'two' is not a whole number"),
        ("configuration_command=yes", "write true or false"),
    ],
)
def test_settings_that_are_not(text: str, message: str) -> None:
    with pytest.raises(BoardError, match=message):
        settings_of([text])


def test_settings_reach_the_design() -> None:
    found = settings_of(["groups=0x2", "checksum=xor", "configuration_command=false"])
    assert found == {"groups": 2, "checksum": "xor", "configuration_command": False}
