# SPDX-License-Identifier: BSD-3-Clause
"""The page about loops: its program runs, and its table has the rows that the bench measures."""

from __future__ import annotations

import re
import subprocess
import sys
import threading
import time
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import pytest
from unit.house.files import ROOT, text
from unit.modules import module_of

from unitylink import cli, connect

PAGE = text("docs/where-loops-live.md")
LOOPS = ROOT / "bench" / "loops"
WAIT = """end = time.monotonic() + 30
    while joint.motor.duty.read() == 0.0 and time.monotonic() < end:
        time.sleep(0.01)
    print(round(joint.motor.duty.read(), 3))
    with busy:
        over.append(True)"""
# The end of the program may cut a write of its callback, which is then told. Here it waits for the callback.
LISTEN = "joint.shaft.position.on_publish(control)"
GUARDED = """import threading
    busy, over = threading.Lock(), []
    def guarded(time_s, angle):
        with busy:
            over or control(time_s, angle)
    joint.shaft.position.on_publish(guarded)"""


@pytest.fixture(scope="module")
def loops() -> Any:
    sys.path.insert(0, str(LOOPS))
    try:
        yield module_of(LOOPS / "loops.py")
    finally:
        sys.path.remove(str(LOOPS))


def test_its_program_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (spec,) = re.findall(r"```ul\n(link joint.*?)```", PAGE, re.S)
    (program,) = re.findall(r"```python\n(.*?)```", PAGE, re.S)
    Path("joint.ul").write_text(spec, "utf-8")
    assert cli.main(["generate", "joint.ul"]) == 0
    # a busy machine may need longer than the page's 0.1 s and 1 s, and for an answer longer than 0.3 s
    patient = program.replace("deadman=0.1", "deadman=30&timeout=10").replace("time.sleep(1)", WAIT)
    assert patient.count(WAIT) == patient.count(LISTEN) == 1 and "deadman=30&timeout=10" in patient
    patient = patient.replace(LISTEN, GUARDED)
    Path("move.py").write_text(patient, "utf-8")
    done = subprocess.run(
        [sys.executable, "move.py"], capture_output=True, text=True, timeout=60, check=False
    )
    assert (done.stdout, done.stderr) == ("0.8\n", ""), (
        "nothing turns, so the duty is the gain times the target"
    )


def test_its_table_has_the_rows_of_the_bench(loops: Any) -> None:
    shown = re.findall(r"^\| (.+?) \| (?:no limit|UART, 3 MBd) \| \d+ µs \| \d+ µs \| \d+ µs \|$", PAGE, re.M)
    assert shown == [what for what, _ in loops.WAYS.values() for _ in loops.BAUDS]
    clocks = loops.fault_clocks()
    assert clocks and {f"{one / loops.CLOCK_HZ * 1e9:.0f} ns" for one in clocks} == {"40 ns"}
    assert "h_bridge at 50 MHz | none | 40 ns | 40 ns | 40 ns |" in PAGE
    shown = " | ".join(f"{1e6 * one:.0f} µs" for one in loops.ranks(loops.pid_s(200)))
    assert f"pid at 20 kHz, from an encoder to h_bridge at 20 kHz | none | {shown} |" in PAGE


def test_the_bench_measures_a_loop(loops: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(loops, "PATIENCE_S", 20.0)
    monkeypatch.setattr(
        loops, "processors_awake", nullcontext
    )  # which takes a processor, and no time is judged
    found = loops.measure("python-event", 3_000_000, 6, Path())
    assert len(found) == 6
    # a publish and a write of at least 9 bytes each are on the line meanwhile
    assert found[0] > 2 * 9 * 10 / 3


def test_a_delay_of_the_program_is_measured_at_both_edges(
    loops: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its answer comes 30 ms after it has seen the input, so no time may be shorter."""
    monkeypatch.setattr(loops, "PATIENCE_S", 20.0)
    ended = threading.Event()

    def answer(url: str) -> None:
        with connect(f"{url}?timeout=10") as link:  # the default of 0.3 s is short on a busy machine
            link.write(2, 2)  # pin 1 is an output
            before = 0
            while not ended.is_set():
                if (level := link.read(0) & 1) != before:
                    before = level
                    time.sleep(0.03)
                    link.write(1, level << 1)

    with loops.Board(loops.load(str(LOOPS / "board.ul")), endpoint="pty") as board:
        program = threading.Thread(target=answer, args=(board.url,))
        program.start()
        try:
            found = loops.answers_us(board, 4)
        finally:
            ended.set()
            program.join()
    assert len(found) == 4 and min(found) >= 30_000


def test_a_program_that_does_not_answer_is_noticed(loops: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(loops, "PATIENCE_S", 0.05)
    spec = loops.load(str(LOOPS / "board.ul"))
    with loops.Board(spec) as board, pytest.raises(loops.LoopError, match="edge 0: no answer"):
        loops.answers_us(board, 1)
