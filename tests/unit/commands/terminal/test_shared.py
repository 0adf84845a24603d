# SPDX-License-Identifier: BSD-3-Clause
"""A screen and programs at one server. A stop at the screen holds them all."""

from __future__ import annotations

from contextlib import AbstractContextManager

import pytest
from unit.commands.terminal.shown import Shown, show
from unit.server.served import Served, served, token_of

from unitylink import Link, connect
from unitylink.errors import DeadManTripped, LeaseHeld, LinkTimeout

TARGET, POWER = 0x1A, 0x1B


def at_server(one: Served, body: object, token: str = "all") -> None:
    with token_of(token), connect(one.url()) as link:
        show(link, one.robot.spec, body)  # type: ignore[arg-type]


def test_a_stop_holds_all_programs_until_somebody_goes_on() -> None:
    async def body(screen: Shown) -> None:
        ana.write(POWER, 9)
        ana.write(TARGET, 50)
        await screen.until(lambda: "50" in screen.line("target"))
        await screen.press("space")
        await screen.until(lambda: "STOPPED: 2 outputs are safe" in screen.notes)
        assert (one.board.registers[TARGET], one.board.registers[POWER]) == (0, 0)
        with pytest.raises(DeadManTripped):
            ana.write(TARGET, 60)
        await screen.press("g")
        await screen.until(lambda: "writes are allowed again" in screen.notes)
        ana.write(TARGET, 70)
        assert one.board.registers[TARGET] == 70, "the stop has taken no lease away from the program"

    with served() as one, one.link() as ana:
        at_server(one, body)


def test_control_is_the_lease_of_the_server_and_is_given_back() -> None:
    async def body(screen: Shown) -> None:
        ana.write(POWER, 9)
        await screen.take("power")
        await screen.press("enter", *"3", "enter")
        await screen.until(lambda: "NOT DONE" in screen.notes and "write lease" in screen.notes)
        await screen.take("target")
        await screen.press("enter", *"7", "enter")
        await screen.until(lambda: one.board.registers[TARGET] == 7)
        with pytest.raises(LeaseHeld):
            ana.write(TARGET, 8)
        await screen.press("b")
        await screen.until(lambda: "control is given back" in screen.notes)
        assert one.board.registers[TARGET] == 7
        ana.write(TARGET, 8)
        assert (one.board.registers[TARGET], one.board.registers[POWER]) == (8, 9)

    with served() as one, one.link() as ana:
        at_server(one, body)


def test_control_is_kept_if_it_cannot_be_given_back(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse() -> AbstractContextManager[Link]:
        raise LinkTimeout("the server does not answer")

    async def body(screen: Shown) -> None:
        await screen.take("target")
        await screen.press("enter", *"7", "enter")
        await screen.until(lambda: one.board.registers[TARGET] == 7)
        monkeypatch.setattr(screen.controls, "_open_link", refuse)
        await screen.press("b")
        await screen.until(lambda: "NOT DONE: the server does not answer" in screen.notes)
        assert screen.controls.has("target")
        await screen.press("space")
        await screen.until(lambda: one.board.registers[TARGET] == 0)

    with served() as one:
        at_server(one, body)


def test_a_user_who_may_write_nothing_is_told_so() -> None:
    async def body(screen: Shown) -> None:
        one.board.registers[TARGET] = 5
        await screen.press("space")
        await screen.until(lambda: "THE STOP DOES NOT WORK YET" in screen.notes)
        assert one.board.registers[TARGET] == 5

    with served() as one:
        at_server(one, body, "looks")
