# SPDX-License-Identifier: BSD-3-Clause
"""What `unitylink fleet` prints when nobody reads, and the URL by which it records a robot."""

from __future__ import annotations

import threading
import time
from dataclasses import replace
from pathlib import Path

import click
import pytest

from unitylink.commands import fleet_record, fleet_table
from unitylink.commands.fleet_record import Heard, RobotTaker
from unitylink.commands.fleet_run import _check_router
from unitylink.commands.fleet_table import News
from unitylink.errors import FleetError
from unitylink.fleet.description import Fleet
from unitylink.fleet.reader import parse_fleet
from unitylink.recording import Sample
from unitylink.zenoh.far_options import read_far_url

PATIENCE_S = 20.0


def test_whoever_tells_goes_on_if_nobody_reads(monkeypatch: pytest.MonkeyPatch) -> None:
    def echo(_: str) -> None:
        raise BrokenPipeError

    monkeypatch.setattr(click, "echo", echo)
    news = News()
    news.check()
    news.say("arm1", "up")  # for example the thread that starts bridges again
    assert "arm1: up" in news.last[0]
    news.finish(PATIENCE_S)
    with pytest.raises(BrokenPipeError):
        news.check()


def test_whoever_tells_goes_on_if_a_reader_does_not_read(monkeypatch: pytest.MonkeyPatch) -> None:
    reads, printed = threading.Event(), list[str]()

    def echo(line: str) -> None:
        reads.wait()
        printed.append(line)

    monkeypatch.setattr(click, "echo", echo)
    monkeypatch.setattr(fleet_table, "_WAITING_MOST", 3)
    news = News()
    for number in range(10):
        news.say("arm1", str(number))
    assert not printed
    reads.set()
    news.finish(PATIENCE_S)
    assert any("older lines are left out" in line for line in printed) and printed[-1].endswith("arm1: 9")


def test_a_folder_with_letters_that_mean_something_in_a_url(tmp_path: Path) -> None:
    folder = tmp_path / "c++ & %41 #1"
    folder.mkdir()
    (folder / "arm.ul").write_text("public arm() { @x = 0x10: READ(); }\n")
    (folder / "z.json5").write_text("{}")
    text = '[fleet]\nzenoh_config = "z.json5"\n[[robot]]\nname = "a"\nlink = "sim:arm.ul"\n'
    fleet = parse_fleet(text, folder / "fleet.toml")
    taker = RobotTaker(fleet, fleet.robots[0], 10.0, Heard(threading.Event()), "")
    assert read_far_url(taker._url).network.config == str(folder / "z.json5")


@pytest.mark.parametrize(
    ("router", "why"),
    [
        ("tcp/0.0.0.0:7447", "add anyone = true below"),
        ("foo", "no place of Zenoh"),
        ("tcp/127.0.0.1:0", "port"),
    ],
)
def test_a_router_that_cannot_be_is_told_in_the_words_of_the_file(router: str, why: str) -> None:
    fleet = replace(Fleet(Path("lab.toml"), "lab", ()), router=router)
    with pytest.raises(FleetError, match=rf"lab.toml: \[fleet\]: router = '{router}'") as told:
        _check_router(fleet)
    assert why in str(told.value) and "--" not in str(told.value)
    _check_router(replace(fleet, router="tcp/0.0.0.0:7447", anyone=True))


def test_an_end_does_not_wait_for_robots_that_are_away(monkeypatch: pytest.MonkeyPatch) -> None:
    stop, waits = threading.Event(), []

    class Away:
        def wait_up(self, timeout_s: float) -> bool:
            waits.append(timeout_s)
            stop.set()
            return False

    monkeypatch.setattr(fleet_table, "terminal", lambda: False)
    fleet_table.show(Away(), News(), stop)  # type: ignore[arg-type]
    assert len(waits) == 1 and waits[0] <= 1.0


@pytest.mark.parametrize("jump_s", [-3600.0, 3600.0])
def test_a_clock_that_is_set_takes_no_sample_of_a_recording(
    monkeypatch: pytest.MonkeyPatch, jump_s: float
) -> None:
    written: list[float] = []

    class Out:
        def add(self, sample: Sample) -> None:
            written.append(sample.time_s)

        def flush(self) -> None: ...

    heard = Heard(threading.Event())
    old_s = heard.now_s() - 10.0  # they have been held for long enough
    now_s = time.time() + jump_s
    monkeypatch.setattr(time, "time", lambda: now_s)
    fresh_s = heard.now_s()
    for time_s in (old_s, fresh_s, fresh_s - 0.01):  # of two robots, the second one a little later
        heard.samples.put(Sample(time_s, {}))
    assert fleet_record._write(heard, Out(), 0.0, []) == 0  # type: ignore[arg-type]
    assert written == [old_s, fresh_s - 0.01, fresh_s]
