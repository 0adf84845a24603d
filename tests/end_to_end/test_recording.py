# SPDX-License-Identifier: BSD-3-Clause
"""Record, plot and replay through the real command line."""

from __future__ import annotations

import csv
import json
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from unitylink.recording import RecordingTruncated, Sample, samples

from .conftest import PATIENCE_S, SCARA, UNITYLINK, Run


@pytest.fixture
def replay(tmp_path: Path) -> Iterator[Callable[..., str]]:
    """Start `unitylink replay ARGUMENTS` and return its URL. It must end with exit code 0."""
    running = []

    def start(*arguments: object) -> str:
        command = [UNITYLINK, "replay", *map(str, arguments), "--tcp", "0", "--json"]
        running.append(subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True))
        assert running[-1].stdout is not None
        return str(json.loads(running[-1].stdout.readline())["url"])

    yield start
    for process in running:
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=60)
        assert process.returncode == 0


@pytest.mark.parametrize("ending", ["mcap", "csv"])
def test_yesterday_s_robot_moves_today(
    run: Run, tmp_path: Path, ending: str, replay: Callable[..., str]
) -> None:
    recording = tmp_path / f"scara.{ending}"
    done = run("record", f"sim:{SCARA}?plant=ramp", "j*.cpos", "--out", recording, "--count", 100, "--json")
    report = json.loads(done.stdout)
    assert done.returncode == 0 and (report["samples"], report["lost"]) == (100, 0), done.stderr
    recorded = {sample.values["j1.cpos"] for sample in samples(recording)}
    # an MCAP file contains its spec
    url = replay(recording, "--loop", *(["--spec", SCARA] if ending == "csv" else []))
    watched = run("watch", url, "j1.cpos", "--spec", SCARA, "--count", 150, "--json")
    assert watched.returncode == 0, watched.stderr
    values = {json.loads(line)["values"]["j1.cpos"] for line in watched.stdout.splitlines()}
    assert len(values & recorded) > 10 and values <= recorded | {0}


def test_a_cut_off_recording_is_played_as_far_as_it_goes(
    run: Run, tmp_path: Path, replay: Callable[..., str]
) -> None:
    assert run("record", f"sim:{SCARA}?plant=ramp", "--out", "s.csv", "--count", 20).returncode == 0
    whole = (tmp_path / "s.csv").read_bytes()
    (tmp_path / "s.csv").write_bytes(whole[: len(whole) // 2])
    url = replay("s.csv", "--spec", SCARA, "--speed", 100)
    assert run("read", url, "j1.cpos", "--spec", SCARA).returncode == 0


def test_replay_says_what_is_missing(run: Run, tmp_path: Path) -> None:
    assert run("record", f"sim:{SCARA}", "--out", "s.csv", "--count", 5).returncode == 0
    no_spec = run("replay", "s.csv")
    assert no_spec.returncode == 1 and "--spec" in no_spec.stderr
    (tmp_path / "lamp.ul").write_text("public lamp() { @led = 0x10: READ(); }")
    other = run("replay", "s.csv", "--spec", "lamp.ul", "--tcp", "0")
    assert other.returncode == 1 and "no item that the spec reads" in other.stderr


def test_a_recording_becomes_a_picture(run: Run, tmp_path: Path) -> None:
    assert run("record", f"sim:{SCARA}", "--out", "s.csv", "--count", 30).returncode == 0
    with open(tmp_path / "s.csv", newline="") as stream:
        assert len(list(csv.reader(stream))) == 31
    for picture in ("s.png", "s.svg"):
        done = run("plot", "s.csv", "j*.cpos", "--out", picture)
        assert done.returncode == 0, done.stderr
    assert (tmp_path / "s.png").read_bytes().startswith(b"\x89PNG")
    drawn = (tmp_path / "s.svg").read_text()
    assert "<svg" in drawn and all(f"<!-- j{joint}.cpos -->" in drawn for joint in range(1, 5)), "a legend"
    live = run("plot", f"sim:{SCARA}", "j1.cpos", "--duration", "0.5", "--out", "live.png")
    assert live.returncode == 0 and (tmp_path / "live.png").stat().st_size > 1000
    nothing = run("plot", "s.csv", "j9.*", "--out", "n.png")
    assert nothing.returncode == 1 and "j9.*" in nothing.stderr


def test_a_live_plot_is_drawn_in_a_terminal(on_terminal: Callable[..., str]) -> None:
    shown = on_terminal("plot", f"sim:{SCARA}", "j1.cpos", "--duration", "1")
    assert "j1.cpos" in shown


def test_a_full_disk_ends_the_recording_and_keeps_what_was_written(tmp_path: Path) -> None:
    limited = f"ulimit -f 8; exec {UNITYLINK} record sim:{SCARA} --out s.csv --rate 1000 --duration 20"
    done = subprocess.run(
        ["bash", "-c", limited], cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 1 and "it holds the first" in done.stderr and "Traceback" not in done.stderr
    assert len(list(samples(tmp_path / "s.csv"))) > 0


def test_a_killed_recording_keeps_all_but_the_last_moment(tmp_path: Path) -> None:
    """There are ten samples a second, so 64 kB of them would take minutes."""
    files = [tmp_path / "s.mcap", tmp_path / "s.csv"]
    words = [UNITYLINK, "record", f"sim:{SCARA}?plant=ramp", "j*.cpos", "--rate", "10", "--out"]
    running = [subprocess.Popen([*words, file], stdout=subprocess.DEVNULL) for file in files]
    try:
        end_s = time.monotonic() + PATIENCE_S
        for file in files:
            while not file.exists() or len(found(file)) < 3:
                assert time.monotonic() < end_s, f"nothing is in {file}"
                time.sleep(0.05)
    finally:
        for process in running:
            process.kill()
            process.wait()
    for file in files:
        assert [sample.time_s for sample in found(file)] == sorted(sample.time_s for sample in found(file))


def found(path: Path) -> list[Sample]:
    """Return the samples that can be read from a recording that is still running, or was killed."""
    seen: list[Sample] = []
    with suppress(RecordingTruncated):
        for sample in samples(path):
            seen.append(sample)
    return seen
