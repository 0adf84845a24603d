# SPDX-License-Identifier: BSD-3-Clause
"""A node on a board in steps: it lets the time pass, publishes it on /clock, and stamps with it."""

from __future__ import annotations

import time
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import pytest
from unit.ros.rig import TEXT, running

from unitylink.errors import UrlError
from unitylink.ros.parameters import Parameters
from unitylink.ros.stamps import Stamps
from unitylink.spec.model import Spec

PLANT = """
class Plant:
    period_s = 0.001
    def attach(self, spec, registers): ...
    def step(self, time_s): ...
"""


@pytest.fixture
def url(tmp_path: Path) -> str:
    (tmp_path / "rig.ul").write_text(TEXT)
    (tmp_path / "still.py").write_text(PLANT)
    return f"sim:{tmp_path / 'rig.ul'}?plant={tmp_path / 'still.py'}&time=lockstep"


def test_the_clock_is_that_of_the_board(spec: Spec, url: str) -> None:
    with running(spec, url, speed=20.0) as (node, plane):
        plane.wait(lambda: len(plane.sent.get("/clock", ())) > 200)
        times = [message.clock[0] + message.clock[1] / 1e9 for message in plane.sent["/clock"]]
        steps = [later - earlier for earlier, later in pairwise(times)]
        assert times[0] == pytest.approx(1.0, abs=0.5), "robot time begins at 1 s"
        assert min(steps) > 0 and times[-1] - times[0] == pytest.approx(0.01 * len(steps), rel=0.01)
        stamps = [message.clock for message in plane.sent["/clock"]]
        plane.wait(lambda: len(plane.sent["joint_states"]) > 100)
        stamped = [message.header[0] for message in plane.sent["joint_states"]]
        assert all(0.9 < stamp < 1000 for stamp in stamped), "stamped with robot time"
        assert stamps == sorted(stamps) and plane.stamps.now_s() < 1000
        board = node.session.link.board if node.session is not None else None
        assert board is not None
        plane.takers["j_0/command"](SimpleNamespace(pos_sp=-0.5))
        plane.wait(lambda: board.registers[0x12] == 0xFE0C)
    assert plane.stamps.now_s() == pytest.approx(time.monotonic(), abs=1.0), "nothing is simulated any more"
    ended = len(plane.sent["/clock"])
    time.sleep(0.05)
    assert len(plane.sent["/clock"]) == ended


def test_a_board_with_real_time_has_no_clock(spec: Spec, url: str) -> None:
    with running(spec, url.replace("&time=lockstep", "")) as (node, plane):
        plane.wait(lambda: len(plane.sent.get("joint_states", ())) > 3)
        assert "/clock" not in plane.sent
        assert plane.sent["joint_states"][-1].header[0] == pytest.approx(node.session.link.now_s(), abs=5)  # type: ignore[union-attr]


def test_time_passes_with_the_speed_that_was_asked(spec: Spec, url: str) -> None:
    with running(spec, url, speed=0.5) as (_, plane):
        plane.wait(lambda: len(plane.sent.get("/clock", ())) > 2)
        first, begun_s = len(plane.sent["/clock"]), time.monotonic()
        plane.wait(lambda: len(plane.sent["/clock"]) >= first + 15)
        assert time.monotonic() - begun_s > 0.2, "15 steps of 10 ms at half the speed take 0.3 s"


@pytest.mark.parametrize("speed", [-1.0, 0.01, 1e9, float("nan")])
def test_a_speed_that_cannot_be(speed: float) -> None:
    with pytest.raises(UrlError, match="times real time"):
        Parameters("sim:rig.ul", speed=speed).options()


def test_stamps_of_this_computer_are_seconds_since_1970() -> None:
    seconds, ns = Stamps().parts(time.monotonic())
    assert seconds + ns / 1e9 == pytest.approx(time.time(), abs=1.0)
