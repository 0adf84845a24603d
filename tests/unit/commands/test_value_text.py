# SPDX-License-Identifier: BSD-3-Clause
"""Engineering values on the command line: units, names, fields, and words that are never read without a
request.
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import click
import pytest
from hypothesis import given
from hypothesis import strategies as st

from unitylink.cli import main
from unitylink.commands.names import Item, Names
from unitylink.commands.value_text import parse_value, shown
from unitylink.simulate import Board, LoopbackPlant
from unitylink.spec import load
from unitylink.values import Codec, plain

SPEC_FILE = Path(__file__).parents[1] / "generate" / "typed.ul"
SPEC = load(SPEC_FILE)
ITEMS: dict[str, Item] = {item.name: item for item in Names(SPEC).all()}


@pytest.mark.parametrize(
    ("name", "text", "value"),
    [
        ("j[0].target", "30deg", math.pi / 6),
        ("j[0].target", "-500 mrad", -0.5),
        ("j[0].target", "0.25", 0.25),
        ("j[0].torque", "1.5 N m", 1.5),
        ("j[0].torque", "1500 mNm", 1.5),
        ("j[0].mode", "run", "run"),
        ("j[0].mode", "3", 3),
        ("reset", "on", True),
        ("uptime", "2 ms", 2000),
        ("flags", "{ready=true, mode=run, heat=3}", {"ready": True, "mode": "run", "heat": 3}),
        ("flags", "0x33", 0x33),
        ("gain", "-1e-3", -0.001),
    ],
)
def test_what_people_type(name: str, text: str, value: Any) -> None:
    parsed = parse_value(text, ITEMS[name])
    assert parsed == pytest.approx(value) if isinstance(value, float) else parsed == value
    codec = Codec(name, ITEMS[name].quantity, 32)
    assert codec.decode(codec.encode(parsed)) is not None


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("j[0].target", "3 kg", "'3 kg' cannot be converted; it is in rad"),
        ("j[0].target", "fast", "'fast' is not a number"),
        ("gain", "2 rad", "it has no unit"),
        ("uptime", "1.5", "is not an integer"),
        ("uptime", "1.5 us", "counts whole steps"),
        ("reset", "maybe", "is not a truth value"),
        ("flags", "{ready=1, cold=2}", "'cold=2' is not one of its fields, or is given twice"),
        ("flags", "ready", "is not an integer"),
    ],
)
def test_what_cannot_be_meant(name: str, text: str, words: str) -> None:
    with pytest.raises(click.UsageError) as caught:
        parse_value(text, ITEMS[name])
    assert name in caught.value.message and words in caught.value.message


@given(st.text(max_size=20), st.sampled_from(sorted(ITEMS)))
def test_any_text_is_a_value_or_a_polite_error(text: str, name: str) -> None:
    try:
        parse_value(text, ITEMS[name])
    except click.UsageError as error:
        assert name in error.message


@pytest.mark.parametrize("name", sorted(ITEMS))
def test_everything_can_be_shown(name: str) -> None:
    item = ITEMS[name]
    value = Codec(name, item.quantity, 32).decode(0)
    assert shown(value, item.quantity)
    json.dumps(plain(value, item.quantity), allow_nan=False)


def test_read_write_list(capsys: pytest.CaptureFixture[str]) -> None:
    with Board(SPEC, plant=LoopbackPlant(), endpoint="tcp") as board:

        def run(*arguments: str) -> str:
            assert main([arguments[0], board.url, *arguments[1:], "--spec", str(SPEC_FILE)]) == 0
            return capsys.readouterr().out

        assert run("read", "gain") == "gain = 1.5\n", "the board begins with the initial value"
        assert run("write", "j[0].target=30deg", "j[1].mode=run", "reset=1") == (
            "j[0].target = 0.524 rad\nj[1].mode = run\nreset = true\n"
        )
        assert run("read", "j[1].mode", "--value") == "run\n"
        (entry,) = json.loads(run("read", "j[1].mode", "--json"))
        assert (entry["value"], entry["word"]) == ("run", 1)
        board.registers[0x32] = 9
        assert "lost" not in run("read", "*")
        assert run("read", "lost") == "lost = 9\n"
        assert run("read", "j[1]", "--value") == "0.5\n0.5\nrun\n0\n", "WRITEs too"
        listed = run("list")
        assert "-3.14159265 to 3.14159265" in listed and "on change" in listed and "fixed(8,8)" in listed


def test_a_value_beyond_its_limit_is_not_sent(capsys: pytest.CaptureFixture[str]) -> None:
    with Board(SPEC, endpoint="tcp") as board:
        assert (
            main(["write", board.url, "j[0].target=200deg", "j[0].mode=run", "--spec", str(SPEC_FILE)]) == 1
        )
        assert "j[0].target: 3.49" in capsys.readouterr().err
        assert board.registers[0x11] == 500 and board.registers[0x12] == 0
