# SPDX-License-Identifier: BSD-3-Clause
"""Manifests: those of the package are complete, and every mistake in one is reported with its key."""

from __future__ import annotations

import re
from itertools import chain
from pathlib import Path

import pytest

from unitylink.boards import Board, board_names, load_board
from unitylink.boards.families import FAMILIES
from unitylink.boards.flash import PACKAGES
from unitylink.boards.flow import link_url
from unitylink.boards.manifest import ROLES
from unitylink.boards.pins import TRIPPED
from unitylink.errors import BoardError, ValueRangeError
from unitylink.resources import resource_folder
from unitylink.spec import load

GOOD = (resource_folder("boards") / "icebreaker" / "board.toml").read_text(encoding="utf-8")


def own(folder: Path, text: str) -> Board:
    (folder / "mine").mkdir()
    (folder / "mine" / "board.toml").write_text(text, encoding="utf-8")
    return load_board(str(folder / "mine"))


@pytest.mark.parametrize("name", board_names())
def test_boards_that_come_along_are_whole(name: str) -> None:
    board = load_board(name)
    assert board.family in FAMILIES
    assert board.pins_from and board.flash.keys() <= PACKAGES.keys() and board.flash
    assert board.baud_hz <= board.baud_hz_most and board.baud_hz * 8 <= board.design_hz
    given = [*(pin for pin, _ in board.fixed_pins), *chain(*board.link_pins.values()), *board.released]
    fixed = {board.pins[pin].site for pin in given}
    assert len(fixed) == len(given) >= 3
    for role in ROLES:
        sites = [board.pins[pin].site for pin in board.roles[role]]
        assert len(sites) >= (0 if role == TRIPPED else 2), role
        assert len(set(sites)) == len(sites) and not fixed & set(sites), role
    assert (board.family == "ecp5") == all(pin.io for pin in board.pins.values())


def test_a_folder_of_ones_own(tmp_path: Path) -> None:
    assert own(tmp_path, GOOD).device == "up5k"
    assert load_board(str(tmp_path / "mine" / "board.toml")).title.startswith("iCEBreaker")


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ('family = "ice40"', 'family = "ice4"', r"chip.family: is 'ice4'; did you mean ice40\?"),
        ('family = "ice40"', 'famliy = "ice40"', r"chip.famliy: there is no such key; did you mean family\?"),
        ("hz = 12_000_000\n", "hz = 0\n", "clock.hz: is 0; expected a number above 0"),
        ('rx = "RX"', 'rx = "RXD"', r"link.rx: is 'RXD'; did you mean RX\?"),
        ('tx = "TX"\n', "", "link.tx: is missing"),
        (
            '"P1A1", "P1A2"',
            '"P1A1", "P1A22"',
            r"roles.pwm: 'P1A22' is no pin of \[pins\]; did you mean P1A2",
        ),
        ('P1A1 = "4"', '_P1 = "4"', "pins._P1: a pin's name begins with a letter"),
        ('P1A1 = "4"', "P1A1 = 4", "pins.P1A1 is 4; expected a table"),
        ('active = "low"', 'active = "lwo"', r"pins.BTN_N.active: is 'lwo'; did you mean low\?"),
        ('physical = "uart"', 'physical = "ft245"', "link.physical: is 'ft245'; "),
        ('physical = "uart"', 'physical = "ft245_async"', "link.rx: there is no such key; "),
        ('physical = "uart"', 'physical = "ft245_sync"', "link.rx: there is no such key; "),
        ("[chip]", "[chip", "board.toml: .*line 9"),
        ("title =", "notes = 3\ntitle =", "board.toml"),
    ],
)
def test_mistakes_are_told_with_their_key(tmp_path: Path, before: str, after: str, message: str) -> None:
    assert before in GOOD
    with pytest.raises(BoardError, match=message):
        own(tmp_path, GOOD.replace(before, after, 1))


def test_a_synchronous_chip_gives_its_clock_on_a_pin(tmp_path: Path) -> None:
    text = (resource_folder("boards") / "ecp5-ft2232h" / "board.toml").read_text(encoding="utf-8")
    with pytest.raises(BoardError, match=r"link\.pins\.ft245_clkout: has no pin"):
        own(tmp_path, text.replace('ft245_clkout = ["FIFO_CLK"]', "ft245_clkout = []"))


def test_boards_that_are_not_there() -> None:
    with pytest.raises(BoardError, match=r"no board is called 'icebraker'; did you mean icebreaker\?"):
        load_board("icebraker")
    with pytest.raises(BoardError, match="ulx3s comes in variants: ulx3s:12f, "):
        load_board("ulx3s")
    with pytest.raises(BoardError, match=r"ulx3s:86f: did you mean ulx3s:85f\?"):
        load_board("ulx3s:86f")
    for name in ("", ".", "..", "../gateware"):
        with pytest.raises(BoardError, match="no board is called"):
            load_board(name)


def test_a_spec_whose_link_stands_on_something_else(tmp_path: Path) -> None:
    spec = tmp_path / "lamp.ul"
    text = "link lamp (PHYSICAL={}); public lamp() {{ @led = 0x10: WRITE(); }}"
    spec.write_text(text.format("uart"))
    assert load_board("icebreaker").configuration(load(spec)).physical == "uart"
    spec.write_text(text.format("spi"))
    with pytest.raises(BoardError, match="icebreaker: its link is uart, and the spec says PHYSICAL=spi"):
        load_board("icebreaker").configuration(load(spec))


def test_the_engine_follows_from_the_board_and_the_spec(tmp_path: Path) -> None:
    spec = tmp_path / "lamp.ul"
    text = "link lamp ({}); public lamp() {{ @led = 0x10: WRITE(); @buttons = 0x11: READ({}); }}"

    def engine(board: str, link: str = "DATA=32", publish: str = "", **settings: int) -> tuple[str, str]:
        spec.write_text(text.format(link, publish))
        made = load_board(board).configuration(load(spec), None, settings)
        return made.engine, made.protocol

    assert engine("icebreaker") == engine("ice40-hx8k") == ("small", "framed")
    assert engine("icebreaker", "ENGINE=fast") == ("fast", "framed")
    assert engine("icebreaker", publish="PUBLISH(10 Hz)") == ("small", "framed")
    assert engine("icebreaker", publish="PUBLISH(10 Hz)", base_hz=20_000) == ("fast", "framed")
    assert engine("ecp5-evn") == ("fast", "both"), "text needs the fast engine"
    assert engine("ecp5-evn", "ENGINE=small") == ("small", "framed")
    assert engine("icebreaker", clock_hz=12_000_000, baud_hz=3_000_000) == ("fast", "framed")
    with pytest.raises(BoardError, match=r"icebreaker: a byte takes 40 clocks on the line, .* needs 43"):
        engine("icebreaker", "ENGINE=small", clock_hz=12_000_000, baud_hz=3_000_000)
    with pytest.raises(ValueRangeError, match="protocol is 'both'; the small engine has 'framed'"):
        load_board("ecp5-evn").configuration(load(spec), "both")


def test_a_board_whose_link_is_spi(tmp_path: Path) -> None:
    pins = {"sck": 4, "cs_n": 1, "mosi": 2, "miso": 3, "waiting": 7, "miso_drive": 8}
    lines = "".join(f'spi_{name} = ["P1A{pin}"]\n' for name, pin in pins.items())
    link = f'[link]\nphysical = "spi"\n\n[link.pins]\n{lines}\n'
    board = own(tmp_path, re.sub(r"\[link\].*?(?=\[flash\])", link, GOOD, flags=re.DOTALL))
    assert board.link_pins["spi_sck"] == ("P1A4",) and board.baud_hz == 0
    spec = tmp_path / "lamp.ul"
    spec.write_text("public lamp() { @led = 0x10: WRITE(); }")
    assert board.configuration(load(spec)).physical == "spi"
    assert link_url(board, 0) == "spi:/dev/spidev0.0"
