# SPDX-License-Identifier: BSD-3-Clause
"""The process of a bridge: started again with longer pauses, killed when it hangs, ended in order."""

from __future__ import annotations

import contextlib
import math
import os
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from unitylink.fleet import turns
from unitylink.fleet.bridge_process import (
    FIRST_PAUSE_S,
    PATIENCE_S,
    PAUSE_MOST_S,
    SILENT_S,
    START_S,
    STARVED_S,
    WELL_S,
    BridgeProcess,
)

Make = Callable[[str], BridgeProcess]


class Shell:
    """A script as a process."""

    def __init__(self, script: str, folder: Path) -> None:
        self._popen = subprocess.Popen(
            ["/bin/sh", "-c", script], cwd=folder, stderr=subprocess.PIPE, text=True, stdin=subprocess.DEVNULL
        )
        assert self._popen.stderr is not None
        self.lines = self._popen.stderr
        self.pid, self.poll = self._popen.pid, self._popen.poll
        self.terminate, self.kill = self._popen.terminate, self._popen.kill
        self.close = self.lines.close

    def wait(self, timeout_s: float | None = None) -> bool:
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._popen.wait(timeout_s)
        return self._popen.returncode is not None


@pytest.fixture
def said() -> list[str]:
    return []


@pytest.fixture
def make(tmp_path: Path, said: list[str]) -> Make:
    return lambda script: BridgeProcess(lambda: Shell(script, tmp_path), said.append)


def wait_dead(one: BridgeProcess, now_s: float) -> None:
    """Look with the same time until the death has been noticed."""
    limit_s = time.monotonic() + 10
    while one.pid is not None:
        one.look(now_s, on_network=True)
        assert time.monotonic() < limit_s
        time.sleep(0.002)


def test_pauses_double_up_to_a_limit_and_begin_again_after_a_good_time(make: Make, said: list[str]) -> None:
    one, now_s, pauses = make("echo 'error: no such port' >&2; echo '{}' >&2; exit 3"), 100.0, []
    for count in range(1, 10):
        one.look(now_s, on_network=False)
        wait_dead(one, now_s)
        assert one.restarts == count
        pause_s = FIRST_PAUSE_S * 2 ** (count - 1)
        pauses.append(min(pause_s, PAUSE_MOST_S))
        one.look(now_s + pauses[-1] - 0.01, on_network=False)
        assert one.pid is None, "it waits"
        now_s += pauses[-1]
    assert pauses[-1] == PAUSE_MOST_S
    assert one.trouble == "ended with code 3: error: no such port"
    assert said[0] == f"{one.trouble}; it is started again in 0.25 s (restart 1)"
    one.look(now_s, on_network=True)
    wait_dead(one, now_s + WELL_S)
    assert "again in 0.25 s" in said[-1]


def test_who_has_left_the_network_and_lives_is_killed(
    make: Make, said: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("unitylink.fleet.bridge_process.STARVED_S", math.inf)  # whatever this machine does
    one = make("exec sleep 60")
    one.look(100.0, on_network=False)
    one.look(100.0 + START_S, on_network=False)
    assert not said, "it may take its time to come"
    one.look(101.0 + START_S, on_network=True)
    left_s = 101.1 + START_S
    one.look(left_s, on_network=False)
    one.look(left_s + SILENT_S, on_network=False)
    assert not said
    one.look(left_s + SILENT_S + 0.1, on_network=False, may_kill=False)
    assert not said, "another one is on its way back"
    one.look(left_s + SILENT_S + 0.1, on_network=False)
    assert "is killed" in said[0] and one.killed_s is not None
    one.look(left_s + SILENT_S + 0.2, on_network=False)
    assert len(said) == 1 or "is started again" in said[1]
    wait_dead(one, 200.0)
    assert one.trouble == "ended with signal 9" and one.restarts == 1


def test_who_waits_for_a_processor_is_not_killed_for_being_late(
    make: Make, said: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """To start a bridge takes more of what is missing than to let it go on."""
    monkeypatch.setattr(turns, "PROCESSES", tmp_path / "proc")
    one = make("exec sleep 60")
    one.look(0.0, on_network=False)

    def waits(mean_s: float, count: int) -> None:
        task = tmp_path / "proc" / str(one.pid) / "task" / "7"
        task.mkdir(parents=True, exist_ok=True)
        (task / "schedstat").write_text(f"5 {round(mean_s * 1e9) * count} {count}\n")

    waits(STARVED_S, 100)
    one.look(1.0, on_network=True)
    one.look(2.0, on_network=False)
    for number in range(1, 5):
        waits(1.5 * STARVED_S, 100 * (1 + number))
        one.look(2.1 + number * (SILENT_S + 0.1), on_network=False)
    assert not said
    one.look(30.0, on_network=True)
    one.look(40.0, on_network=False)
    waits(0.1 * STARVED_S, 10000)  # now it has its processor, and is silent
    one.look(40.1 + SILENT_S, on_network=False)
    assert "is killed" in said[0]
    wait_dead(one, 50.0)
    said.clear()
    one.look(60.0, on_network=True)
    one.look(61.0, on_network=True)
    waits(0.0, 1)
    one.look(62.0, on_network=False)
    waits(10 * STARVED_S, 1000)
    one.look(61.0 + PATIENCE_S, on_network=False)
    assert "is killed" in said[0], "and nobody waits for ever"
    wait_dead(one, 500.0)


def test_it_is_ended_in_order_and_what_ignores_that_is_killed(
    make: Make, said: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    good = make("trap 'echo bye > bye; exit 0' TERM; echo > there; while :; do sleep 0.01; done")
    good.look(0.0, on_network=True)
    while not (tmp_path / "there").exists():
        time.sleep(0.002)
    pid = good.pid
    assert pid is not None
    good.end()
    assert (tmp_path / "bye").read_text() == "bye\n"
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)
    monkeypatch.setattr("unitylink.fleet.bridge_process.END_S", 0.1)
    bad = make("trap '' TERM; echo > here; while :; do sleep 0.01; done")
    bad.look(0.0, on_network=True)
    while not (tmp_path / "here").exists():
        time.sleep(0.002)
    bad.end()
    assert "does not end: it is killed" in said[0] and bad.pid is None


def test_what_cannot_be_started_is_said(said: list[str]) -> None:
    def fail() -> Shell:
        raise FileNotFoundError(2, "No such file or directory")

    one = BridgeProcess(fail, said.append)
    one.look(0.0, on_network=False)
    assert one.restarts == 1 and "cannot be started: No such file" in said[0]


def test_what_a_bridge_leaves_behind_with_its_stderr_does_not_stop_the_watch(
    make: Make, said: list[str]
) -> None:
    one = make("sleep 6 & echo broken >&2; exit 3")
    one.look(0.0, on_network=False)
    began_s = time.monotonic()
    wait_dead(one, 0.1)
    assert time.monotonic() - began_s < 4 and "ended with code 3: broken" in said[0]
