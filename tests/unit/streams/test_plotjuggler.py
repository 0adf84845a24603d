# SPDX-License-Identifier: BSD-3-Clause
"""What the UDP server of PlotJuggler would get."""

from __future__ import annotations

import json
import socket
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from unit.streams.streamed import EVERYTHING, Served, still, streaming, until

from unitylink import connect
from unitylink.cli import main
from unitylink.errors import LinkNotFound
from unitylink.layer4_data import load_spec_objects
from unitylink.server.scopes import Rights
from unitylink.simulate import Board, BoardConfiguration
from unitylink.spec import compile_text
from unitylink.streams.plotjuggler import PlotJuggler
from unitylink.streams.topic import Batch, Topic


@pytest.fixture(scope="module")
def one() -> Iterator[Served]:
    with still() as all_of_it:
        yield all_of_it


@pytest.fixture
def receiver() -> Iterator[socket.socket]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as there:
        there.bind(("127.0.0.1", 0))
        there.settimeout(10)
        yield there


def packet(receiver: socket.socket) -> dict[str, Any]:
    told = json.loads(receiver.recv(65536))
    assert isinstance(told, dict)
    return told


def test_samples_come_as_json_with_times(one: Served, receiver: socket.socket) -> None:
    one.board.registers[0x12] = 0xFFFFFFFF - 41
    stream = PlotJuggler("arm", "127.0.0.1", receiver.getsockname()[1], EVERYTHING)
    with streaming(one, stream):
        told = [packet(receiver) for _ in range(60)]
    positions = [each for each in told if each["arm"].get("position") == -42]
    assert len(positions) > 30
    times_s = [each["timestamp"] for each in positions]
    assert times_s == sorted(times_s) and abs(times_s[-1] - time.time()) < 60
    assert 0.005 < np.median(np.diff(times_s)) < 0.02, "PUBLISH(100 Hz)"
    assert any({"other", "power"} <= each["arm"].keys() for each in told), "the PC reads these"


def test_what_a_tool_may_not_read_does_not_leave(one: Served, receiver: socket.socket) -> None:
    stream = PlotJuggler("arm", "127.0.0.1", receiver.getsockname()[1], Rights.of(["read position"]))
    with streaming(one, stream):
        told = [packet(receiver) for _ in range(30)]
    assert {name for each in told for name in each["arm"]} == {"position"}


def test_nobody_listens(one: Served, receiver: socket.socket) -> None:
    port = receiver.getsockname()[1]
    receiver.close()
    stream = PlotJuggler("arm", "127.0.0.1", port, EVERYTHING)
    with streaming(one, stream), one.link() as program:
        until(lambda: stream.left_out >= 3)
        assert program.read(0x50) == 0


def test_a_host_that_does_not_exist() -> None:
    with pytest.raises(LinkNotFound, match=r"--plotjuggler no\.such\.host\.invalid:9870"):
        PlotJuggler("arm", "no.such.host.invalid", 9870, EVERYTHING)


def test_the_newest_sample_is_never_thinned_away() -> None:
    rng = np.random.default_rng(21)
    for _ in range(200):
        times_s = np.cumsum(rng.exponential(0.001, rng.integers(1, 200))) + 1.7e9
        kept = list(Batch(times_s, [[n] for n in range(len(times_s))]).thinned(100.0))
        assert kept[-1][1] == [len(times_s) - 1]
        slots = [int(time_s * 100) for time_s, _ in kept]
        assert slots == sorted(set(slots)), "one sample in each 10 ms"
        assert set(slots) == {int(time_s * 100) for time_s in times_s}


def test_numbers_for_plots_and_words_for_people() -> None:
    spec = compile_text(
        """
        enum Mode: u8 { off = 0; run = 3; }
        bits Flags: u16 { hot: bool @ 0; mode: Mode @ 8..1; }
        public arm() { @mode = 0x10: Mode READ(); @flags = 0x11: Flags READ();
           @angle = 0x12: i16 READ(UNIT="deg", SCALE=0.1); @speed = 0x13: f32 READ(UNIT="m/s"); }
        """,
        "arm.ul",
    ).spec
    assert spec is not None
    with Board(spec, configuration=BoardConfiguration.for_spec(spec)) as board, connect(board.url) as link:
        values = list(load_spec_objects(spec, link))
    view = Topic("/arm/100_hz", values, 100.0).view(EVERYTHING)
    assert view is not None
    row = [3, 0b111, 0xFF85, 0x7FC00000]
    assert json.loads(view.text(view.numbers(row)))["mode"] == 3
    told = json.loads(view.text(view.plain(row)))
    assert told == {"mode": "run", "flags": {"hot": True, "mode": "run"}, "angle": -12.3, "speed": "nan"}
    kinds = view.schema["properties"]
    assert kinds["angle"] == {"type": "number", "description": "in deg"}
    assert kinds["mode"] == {"type": "string"} and kinds["flags"]["properties"]["hot"] == {"type": "boolean"}
    part = Topic("/arm/100_hz", values, 100.0).view(Rights.of(["read speed", "read mode"]))
    assert part is not None and part.paths == ("mode", "speed") and part.plain(row) == ("run", "nan")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--plotjuggler", "far"], "expected [HOST:]PORT"),
        (["--plotjuggler", "0"], "expected the port of PlotJuggler: 9870"),
        (["--may", "plotjuggler", "read"], "add --plotjuggler, too"),
        (["--foxglove", "0.0.0.0:8765"], "add --anyone"),
        (["--foxglove", "far"], "--foxglove far: expected [HOST:]PORT"),
        (["--may", "excel", "read"], "there is no such tool"),
        (["--plotjuggler", "9870", "--may", "plotjuggler", "fly"], "'fly' is no scope"),
    ],
)
def test_the_command_says_what_is_wrong(
    tmp_path: Path, arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    spec = tmp_path / "arm.ul"
    spec.write_text("public arm() { @a = 0x10: u16 READ(); }")
    assert main(["serve", f"sim:{spec}", str(spec), *arguments, "--check-config"]) != 0
    assert said in capsys.readouterr().err
