# SPDX-License-Identifier: BSD-3-Clause
"""Objects of a spec are refused on gateware of another spec, if the gateware can tell."""

from __future__ import annotations

import importlib.util
import logging
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from unitylink.cli import main
from unitylink.errors import DeviceMismatch
from unitylink.generate import generate_python
from unitylink.layer2_message import Link
from unitylink.layer4_data import Node, load_spec_objects
from unitylink.simulate import Board, BoardConfiguration
from unitylink.spec import Spec, compile_text

TEXT = "public arm() { x: axis() @ (0x10); y: axis() @ (0x11); } axis(): @ (target) { @target: i16 WRITE(); }"
SWAPPED = TEXT.replace("x: axis() @ (0x10); y: axis() @ (0x11)", "x: axis() @ (0x11); y: axis() @ (0x10)")
PAIR = "public left() { @x = 0x10: i16 WRITE(); } public right() { @x = 0x11: i16 WRITE(); }"

Build = Callable[[Spec, Link], Any]


def spec_of(text: str) -> Spec:
    spec = compile_text(text, "arm.ul").spec
    assert spec is not None
    return spec


def generated(spec: Spec, folder: Path) -> ModuleType:
    """Import the module that is generated from a spec."""
    ((name, text),) = generate_python(spec).items()
    (folder / name).write_text(text)
    loader = importlib.util.spec_from_file_location(f"generated_{folder.name}", folder / name)
    assert loader is not None and loader.loader is not None
    module = importlib.util.module_from_spec(loader)
    loader.loader.exec_module(module)
    return module


@pytest.fixture(params=["generated", "loaded"])
def build(request: pytest.FixtureRequest, tmp_path: Path) -> Build:
    """Return a function that makes the objects of a spec on a link, with generated code or without."""
    if request.param == "loaded":
        return load_spec_objects
    return lambda spec, link: generated(spec, tmp_path).Arm(link)


def url(board: Board, more: str = "") -> str:
    return f"{board.url}?timeout=2{more}"


def test_two_joints_that_changed_places_are_refused(build: Build) -> None:
    with Board(spec_of(SWAPPED)) as board, Link(url(board)) as link:
        with pytest.raises(
            DeviceMismatch, match=r"built from another spec than arm\.ul: its wire hash is"
        ) as e:
            build(spec_of(TEXT), link)
        assert all(remedy in str(e.value) for remedy in (board.url, "build the gateware", "spec_hash=any"))
        assert board.registers[0x10] == board.registers[0x11] == 0


def test_the_right_gateware_is_verified(build: Build) -> None:
    with Board(spec_of(TEXT)) as board, Link(url(board)) as link:
        assert "no spec was compared" in link.unverified
        build(spec_of(TEXT), link).x.target.write(5)
        assert link.unverified == ""
        assert board.registers[0x10] == 5


def test_who_knows_better_is_heard_and_logged(build: Build, caplog: pytest.LogCaptureFixture) -> None:
    with Board(spec_of(SWAPPED)) as board, Link(url(board, "&spec_hash=any")) as link:
        with caplog.at_level(logging.WARNING, "unitylink"):
            build(spec_of(TEXT), link).x.target.write(5)
        assert "another spec than arm.ul" in link.unverified and "spec_hash=any goes on" in link.unverified
        assert [record.message for record in caplog.records] == [f"{link.url}: {link.unverified}"]
        assert board.registers[0x10] == 5


def test_gateware_that_cannot_tell_is_not_refused(build: Build, caplog: pytest.LogCaptureFixture) -> None:
    spec = spec_of(TEXT)
    classic = BoardConfiguration(protocol="classic")
    for board, more, why in (
        (Board(), "", "built without the hash of its spec"),
        (Board(spec, configuration=classic), "&protocol=classic", "classic gateware cannot report"),
    ):
        with board, Link(url(board, more)) as link:
            build(spec_of(SWAPPED), link)
            assert why in link.unverified
    assert not caplog.records


@pytest.mark.parametrize(
    ("asks", "why"), [("target: i16 WRITE(SAFE=0)", "has a SAFE value"), ("target: PULSE()", "is a PULSE")]
)
def test_what_needs_frames_is_refused_on_a_link_that_fell_back(build: Build, asks: str, why: str) -> None:
    """It is not refused if the URL asks for the classic protocol."""
    spec = spec_of(TEXT.replace("target: i16 WRITE()", asks))
    classic = BoardConfiguration(protocol="classic")
    with (
        Board(spec, configuration=classic) as board,
        Link(url(board)) as link,
        pytest.raises(DeviceMismatch, match=f"x.target {why}.*protocol=classic"),
    ):
        build(spec, link)
    with Board(spec, configuration=classic) as board, Link(url(board, "&protocol=classic")) as link:
        build(spec, link)


def test_a_board_that_is_one_arm_of_two() -> None:
    """The link leads to one arm only. Objects of the other arm are refused there, or are not made."""
    spec = spec_of(PAIR)
    with Board(spec.only("left")) as board, Link(url(board)) as link:
        assert isinstance(load_spec_objects(spec, link, root="left"), Node)
        assert [value.path for value in load_spec_objects(spec, link)] == ["left.x"]
        assert link.unverified == ""
        with pytest.raises(DeviceMismatch, match="another spec"):
            load_spec_objects(spec, link, root="right")
    with Board(spec) as board, Link(url(board)) as link:
        assert [value.path for value in load_spec_objects(spec, link)] == ["left.x", "right.x"]


@pytest.mark.parametrize(
    "words",
    [
        ["read", "x.target"],
        ["write", "x.target=5"],
        ["watch", "x.target", "--count", "1"],
        ["record", "x.target", "--count", "1", "--out", "arm.csv"],
        pytest.param(
            ["plot", "x.target", "--duration", "0.1", "--out", "arm.svg"],
            marks=pytest.mark.xdist_group("matplotlib"),
        ),
        ["list"],
    ],
    ids=lambda words: words[0],
)
def test_commands_refuse(
    words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "arm.ul").write_text(TEXT)
    name, *rest = words
    with Board(spec_of(SWAPPED), endpoint="tcp") as board:
        assert main([name, url(board), *rest, "--spec", "arm.ul"]) == 1
        assert "was built from another spec than arm.ul" in capsys.readouterr().err
        assert main([name, url(board, "&spec_hash=any"), *rest, "--spec", "arm.ul"]) == 0
        assert "spec_hash=any goes on" in capsys.readouterr().err
        assert main(["info", url(board), "--spec", "arm.ul"]) == 0
        assert "not verified: " in capsys.readouterr().out


def test_commands_know_which_arm_the_board_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "pair.ul").write_text(PAIR)
    spec = compile_text(PAIR, "pair.ul").spec
    assert spec is not None
    with Board(spec.only("right"), endpoint="tcp") as board:
        given = ["--spec", str(tmp_path / "pair.ul")]
        assert main(["write", url(board), "right.x=5", *given]) == 0
        assert board.registers[0x11] == 5
        assert main(["write", url(board), "left.x=5", *given]) == 1
        assert "there is no item 'left.x'" in capsys.readouterr().err
        assert main(["info", url(board), *given]) == 0
        assert "verified" in capsys.readouterr().out.split("binding")[1].split("\n")[0]
