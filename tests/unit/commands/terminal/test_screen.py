# SPDX-License-Identifier: BSD-3-Clause
"""The screen of `unitylink tui`: what it says, and what the board gets."""

from __future__ import annotations

import asyncio
import re
import threading
from pathlib import Path

import pytest
from unit.commands.terminal.shown import FAULTS, GRIP, RESET, TARGET, Shown, at_screen

from unitylink.cli import main
from unitylink.errors import LinkTimeout
from unitylink.layer2_message import Link

WIDTH, HEIGHT = 80, 24


def test_values_come_with_units_ages_and_remarks() -> None:
    async def body(one: Shown) -> None:
        one.registers[0x10], one.registers[0x11], one.registers[GRIP] = 7, 1001, 1
        await one.until(lambda: "100.1 deg" in one.line("angle") and "hold" in one.line("grip"))
        assert re.match(r"    angle +100\.1 deg +\d\.\d s  ABOVE 90 *$", one.line("angle"))
        assert (
            "write" in one.line("target") and "pulse" in one.line("reset") and "clear" in one.line("faults")
        )
        assert "- j1 shoulder" in one.text("table")
        assert one.text("head").startswith("arm  fd:") and "control: nobody" in one.text("head")
        await one.until(
            lambda: "of 120 publishes/s" in one.text("health") and "trip -" not in one.text("health")
        )
        assert re.search(r"trip \d+\.\d\d ms, \d+ of .*, lost \d+, retries \d+, timeouts", one.text("health"))

    at_screen(body)


def test_it_fits_into_80_by_24() -> None:
    async def body(one: Shown) -> None:
        await one.go_to("j1.angle")
        await one.press("c")
        await one.take("j1.angle")
        for part in ("head", "table", "charts", "log", "health", "keys"):
            lines = one.text(part).splitlines()
            assert all(len(line) <= WIDTH for line in lines), part
        regions = [one.screen.query_one(f"#{part}").region for part in ("head", "table", "charts", "keys")]
        assert regions[0].y == 0 and regions[-1].bottom == HEIGHT
        assert one.screen.query_one("#table").region.height >= 10
        await one.press("end")
        assert "> " in one.text("table").splitlines()[-1]

    at_screen(body, (WIDTH, HEIGHT))


def test_a_part_is_folded_and_a_long_robot_scrolls() -> None:
    async def body(one: Shown) -> None:
        await one.go_to("j1")
        await one.press("enter")
        assert "+ j1" in one.text("table") and "speed" not in one.text("table")
        await one.press("enter", "down", "down")
        assert "- j1" in one.text("table") and "speed" in one.text("table")
        await one.press("end")
        assert one.screen.table.chosen.path == "j2.target" and "> " in one.text("table")
        assert "grip" not in one.text("table"), "twelve rows do not fit"

    at_screen(body, (60, 13))


def test_a_write_needs_control_a_value_in_range_and_enter() -> None:
    async def body(one: Shown) -> None:
        await one.go_to("j1.target")
        await one.press("enter")
        assert not one.box and "take control of j1 first" in one.notes
        await one.take("j1.target")
        await one.until(lambda: "j1: " in one.text("head"))
        await one.press("enter", *"91", "enter")
        assert "-90 to 90 deg" in one.box and "91" in one.box and one.registers[TARGET] == 0
        await one.press("backspace", "backspace", *"0.5rad", "enter")
        await one.until(lambda: one.registers[TARGET] == 286)
        await one.until(lambda: "28.6 deg" in one.line("target"))
        assert not one.box and "j1.target = 0.5rad" in one.notes
        await one.press("enter", *"17", "escape")
        await one.until(lambda: not one.box)
        assert one.registers[TARGET] == 286
        await one.press("b")
        await one.until(lambda: "control: nobody" in one.text("head"))
        assert one.registers[TARGET] == 286, "given back in order, so the outputs keep their values"

    at_screen(body)


def test_an_item_with_confirm_asks_first() -> None:
    async def body(one: Shown) -> None:
        await one.take("grip")
        for no in ("n", "escape", "enter"):
            await one.press("enter", *"hold", "enter")
            await one.until(lambda: "Open it?" in one.box)
            await one.press(no)
            await one.until(lambda: not one.box)
            assert one.registers[GRIP] == 0
        await one.press("enter", *"hold", "enter")
        await one.until(lambda: "Open it?" in one.box)
        await one.press("y")
        await one.until(lambda: one.registers[GRIP] == 1)

    at_screen(body)


def test_a_pulse_and_flags_ask_first() -> None:
    async def body(one: Shown) -> None:
        one.registers[FAULTS] = 1
        await one.take("reset")
        await one.press("enter", "n", "enter", "y")
        await one.until(lambda: "reset: pulse" in one.notes)
        assert one.registers[RESET] == 1
        await one.take("faults")
        await one.until(lambda: "ready=true" in one.line("faults"))
        await one.press("enter", "y")
        await one.until(lambda: "faults: cleared" in one.notes)

    at_screen(body)


@pytest.mark.parametrize("keys", [(), ("enter",), ("enter", *"30"), ("question_mark",), ("l",)])
def test_the_space_bar_stops_in_every_box(keys: tuple[str, ...]) -> None:
    async def body(one: Shown) -> None:
        await one.take("j1.target")
        await one.press("enter", *"-30", "enter")
        await one.until(lambda: one.registers[TARGET] == 0x10000 - 300)
        await one.press(*keys, "space")
        await one.until(lambda: one.registers[TARGET] == 0 and one.registers[GRIP] == 1)
        await one.until(lambda: "STOPPED by" in one.text("banner"))
        assert "control: nobody" in one.text("head")
        if keys:
            await one.press("escape")
        await one.press("t")
        await one.until(lambda: "nobody writes before somebody arms it" in one.notes)
        await one.press("g")
        await one.until(lambda: not one.text("banner"))
        await one.take("j1.target")

    at_screen(body)


def test_a_stop_waits_for_no_write_that_hangs(monkeypatch: pytest.MonkeyPatch) -> None:
    """All threads hang. The SAFE values are written beside them, and again after them."""
    held, entered = threading.Event(), threading.Event()
    write, write_many = Link.write, Link.write_many

    def hang(self: Link, *given: object, **options: object) -> None:
        if threading.current_thread().name.startswith("unitylink-desk"):
            entered.set()
            held.wait(10)
        write_many(self, *given, **options)  # type: ignore[arg-type]

    def hang_one(self: Link, *given: object, **options: object) -> None:
        if threading.current_thread().name.startswith("unitylink-desk"):
            entered.set()
            held.wait(10)
        write(self, *given, **options)  # type: ignore[arg-type]

    async def body(one: Shown) -> None:
        one.registers[TARGET] = 5
        await one.take("j1.target")
        monkeypatch.setattr(Link, "write_many", hang)
        monkeypatch.setattr(Link, "write", hang_one)
        for _ in range(6):
            await one.press("enter", *"60", "enter")
        assert entered.wait(5)
        await one.press("space")
        await one.until(lambda: one.registers[TARGET] == 0)
        assert "STOP" in one.text("banner") and not held.is_set()
        held.set()
        await one.until(lambda: "STOPPED" in one.notes and not one.controls.stopping)
        assert one.registers[TARGET] == 0, "the write that hung came after the stop"

    try:
        at_screen(body)
    finally:
        held.set()


def test_a_stop_is_tried_until_the_board_answers(monkeypatch: pytest.MonkeyPatch) -> None:
    def silent(*_: object, **__: object) -> None:
        raise LinkTimeout("no answer")

    monkeypatch.setattr("unitylink.commands.terminal.controls._AGAIN_S", 0.02)

    async def body(one: Shown) -> None:
        one.registers[TARGET] = 5
        with monkeypatch.context() as patched:
            patched.setattr(Link, "write_many", silent)
            patched.setattr(Link, "trip", silent)
            await one.press("space")
            await one.until(lambda: one.notes.count("THE STOP DOES NOT WORK YET") > 1)
            assert "not answered yet" in one.text("banner") and one.registers[TARGET] == 5
        await one.until(lambda: one.registers[TARGET] == 0 and "STOPPED by" in one.text("banner"))

    at_screen(body)


def test_a_screen_that_hangs_loses_control(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("unitylink.commands.terminal.controls.LEASE_S", 0.6)

    async def body(one: Shown) -> None:
        await one.take("j1.target")
        await one.press("enter", *"30", "enter")
        await one.until(lambda: one.registers[TARGET] == 300)
        one.controls.alive = lambda: None  # type: ignore[method-assign]  # the screen makes no rounds any more
        await one.until(lambda: one.registers[TARGET] == 0)
        assert "control is lost, because its time was over" in one.notes

    at_screen(body)


def test_charts_are_drawn_and_ended() -> None:
    async def body(one: Shown) -> None:
        await one.go_to("j1.angle")
        await one.press("c", "minus", "minus")
        for raw in (0, 500, 100):
            one.registers[0x11] = raw
            await asyncio.sleep(0.1)
        await one.until(lambda: "0 to 50 deg" in one.text("charts"))
        assert "last 5 s" in one.text("charts") and "chart 1" in one.line("angle")
        assert any(0x2800 < ord(sign) <= 0x28FF for sign in one.text("charts"))
        for path in ("j1.speed", "j2.angle", "j2.speed", "j2.target"):
            await one.go_to(path)
            await one.press("c")
        assert "up to 4" in one.notes and len(one.text("charts").splitlines()) <= 6
        await one.go_to("j1.angle")
        await one.press("c")
        assert "chart 1" not in one.line("angle")

    at_screen(body)


def test_without_a_terminal_it_says_what_does_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("arm.ul").write_text("public arm() { @x = 0x1: READ(); }")
    assert main(["tui", "sim:arm.ul"]) == 1
    assert "`unitylink watch` prints values as lines" in capsys.readouterr().err
