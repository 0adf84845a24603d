# SPDX-License-Identifier: BSD-3-Clause
"""Programs at `serve://` and a person at the page share one board, one gate and one stop."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
from unit.dashboard.robot import TEXT, Log
from unit.dashboard.robot import Robot as Page
from unit.server.served import Served, served

from unitylink.cli import main
from unitylink.dashboard.opening import page_of
from unitylink.errors import DeadManTripped, LeaseHeld
from unitylink.layer4_data import load_spec_objects
from unitylink.server.rate_limit import RateLimit

TARGET, POWER = 0x1A, 0x1B


@pytest.fixture
def both() -> Iterator[tuple[Served, Page]]:
    with ExitStack() as stack:
        one = stack.enter_context(served())
        link = one.robot.board_link()
        reader = stack.enter_context(one.link("looks", "&reconnect=1"))
        page = stack.enter_context(
            page_of(link, one.robot.spec, one.robot.gate, one.robot.switch, reader=reader)
        )
        page.app.logins = RateLimit(1000, 1000)
        yield one, Page(one.board, link, page, Log())


def test_two_programs_and_a_page_share_a_board(both: tuple[Served, Page]) -> None:
    one, page = both
    with one.link() as ana, one.link("looks") as ben, page.viewer("all") as person:
        robot = load_spec_objects(one.robot.spec, ana)
        robot["target"].write(7)  # type: ignore[union-attr]
        assert ben.read(TARGET) == 7
        person.until(lambda: person.values.get("target") == 7 and "position" in person.values)
        assert "all holds the write lease of target" in person.ask("write", values={"target": 1})
        assert person.ask("write", values={"power": 3}) == ""
        with pytest.raises(LeaseHeld):
            ana.write(POWER, 9)
        assert (one.board.registers[TARGET], one.board.registers[POWER]) == (7, 3)
    until(lambda: one.board.registers[POWER] == 0)  # the page has gone without a word


def test_a_stop_at_the_page_holds_the_programs_until_a_person_goes_on(both: tuple[Served, Page]) -> None:
    one, page = both
    with one.link() as ana, page.viewer("all") as person:
        ana.write(TARGET, 50)
        status, _, body = page.request("POST", "/stop", cookie=page.log_in("looks"))
        assert status == 200 and json.loads(body)["wrote"] == 2
        refused = 0
        for _ in range(100):  # a program that goes on as if nothing had happened
            try:
                ana.write(TARGET, 60)
            except DeadManTripped:
                refused += 1
            time.sleep(0.005)
        assert refused == 100  # from the first one on
        with pytest.raises(DeadManTripped, match=r"arm\(\) lets them be written again"):
            ana.write(TARGET, 60)
        assert one.board.registers[TARGET] == 0
        person.until(lambda: person.state("stopped_by") == "looks")
        assert person.ask("arm", stops=person.state("stops")) == ""
        ana.write(TARGET, 61)
        assert one.board.registers[TARGET] == 61


def until(check: object) -> None:
    for _ in range(2000):
        if check():  # type: ignore[operator]
            return
        time.sleep(0.005)
    raise AssertionError("it does not happen")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--listen", "0.0.0.0:0"], "add --anyone"),
        (["--listen", "far"], "expected [HOST:]PORT"),
        (["--token-file", "/absent"], "/absent: No such file"),
        (["--audit", "/absent/log"], "there is no folder /absent"),
        (["--listen", "127.0.0.1:0", "--tls-cert", "/absent"], "/absent: No such file"),
    ],
)
def test_the_command_says_what_is_wrong(
    tmp_path: Path, arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    spec = tmp_path / "arm.ul"
    spec.write_text(TEXT)
    assert main(["dashboard", f"sim:{spec}", *arguments]) != 0
    assert said in capsys.readouterr().err
