# SPDX-License-Identifier: BSD-3-Clause
"""The VHDL itself behind the command line, and the SCARA moves on it: `make demo RTL=1` in short."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import pytest
from end_to_end.every_command import converse

from tests.reference.rs485 import ModelNode, Pair, PairNode, WireNode
from unitylink import connect
from unitylink.errors import DeviceMismatch, UnityLinkError
from unitylink.layer2_message import Link
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board
from unitylink.simulate.plant import load_plant
from unitylink.simulate.rtl import RtlBoard, rtl_configuration
from unitylink.spec import load
from unitylink_lab.bench import run as bench

Run = Callable[..., "subprocess.CompletedProcess[str]"]

ROOT = Path(__file__).resolve().parents[2]
SCARA = ROOT / "examples" / "scara" / "scara.ul"
PAIR = ROOT / "examples" / "pa10" / "pa10_pair.ul"
RECORDINGS = ROOT / "tests" / "conformance" / "classic-transcripts.json"
UNITYLINK = Path(sys.executable).with_name("unitylink")

# One design is compiled once, and the tests that need it run one after another.
pytestmark = pytest.mark.xdist_group("rtl")


def test_scara_moves_on_the_gateware() -> None:
    with connect(f"rtl:{SCARA}?plant=scara") as link:
        move(link)
        assert link.board.time_s > 0.15, "200 counts take 0.05 s of device time"


def test_time_of_the_gateware_goes_in_steps_and_each_run_is_the_same() -> None:
    def run(link: Link) -> list[tuple[float, int]]:
        seen, begun_s = [], link.now_s() - link.board.time_s
        for turn in range(40):
            link.write(0x97, 20_000)
            link.write(0x8F, turn)
            link.step(0.005)
            seen.append((round(link.now_s() - begun_s, 6), link.read(0x8B)))
        assert link.board.time_s == pytest.approx(link.now_s() - begun_s, abs=1e-3)
        return seen

    with connect(f"rtl:{SCARA}?plant=scara", time="lockstep") as link:
        first = run(link)
        link.reset()
        assert run(link) == first
    with connect(f"rtl:{SCARA}?plant=scara", time="lockstep") as link:
        assert run(link) == first


def test_the_line_of_the_gateware_comes_back() -> None:
    with connect(f"rtl:{SCARA}?plant=scara&timeout=20&reconnect=1") as link:
        publishes = link.subscribe([0x88], divisor=10)
        link.board.hang_up()
        while not link.statistics().reconnections:
            link.wait_up(60)
        publishes.drain()
        assert publishes.wait(60)
        move(link)


def test_both_arms_of_one_spec_move_on_gateware_of_their_own() -> None:
    """The board of each arm is compiled from a design of its own: `make demo-pa10 RTL=1` in short."""
    spec, plant = load(PAIR), PAIR.with_name("plant.py")
    targets = {"left": [0.02 * (joint + 1) for joint in range(7)], "right": [-0.03] * 7}
    with ExitStack() as stack:
        arms = {}
        for side in targets:
            link = stack.enter_context(connect(f"rtl:{PAIR}?plant={plant}&root={side}_arm&timeout=5"))
            arms[side] = load_spec_objects(spec, link, root=f"{side}_arm")
        for side, arm in arms.items():
            for joint in range(7):
                arm[f"arm.j[{joint}].limit"].write(3.0)
            arm["arm.target"].write(targets[side])
        deadline = time.monotonic() + 60
        while {
            side: [round(at, 2) for at in arm["arm.pos"].snapshot().values()] for side, arm in arms.items()
        } != targets:
            assert time.monotonic() < deadline, "an arm does not get there: is an input missing?"


def move(link: Link) -> None:
    """Send joint 1 of the SCARA to 800 and watch it move."""
    robot = load_spec_objects(load(SCARA), link)
    seen: list[int] = []
    robot["j1.cpos"].on_publish(lambda _time_s, counts: seen.append(counts))
    with robot["j1"].publishing():
        robot["j1.spd_sp"].write(4000)
        robot["j1.pos_sp"].write(800)
        deadline = time.monotonic() + 60
        while robot["j1.cpos"].read() != 800:
            assert time.monotonic() < deadline, "the joint does not get there"
    assert seen[0] < 100
    assert max(seen) >= 700
    assert len(set(seen)) > 5, "positions are published on the way"


def test_every_command_takes_the_gateware(tmp_path: Path) -> None:
    said = converse(
        lambda: f"rtl:{SCARA}?plant=scara",
        SCARA,
        tmp_path,
        own_spec=True,
        refused={"doctor": "is a virtual board"},
        items=("j1.cpos", "j1.pos_sp", "0x80"),
    )
    assert said["watch"].count("j1.cpos=") == 2 and "samples in" in said["record"]
    assert "the robot has 16 values" in said["bridge"]


def test_scara_moves_behind_an_ft245_and_the_driver_of_its_chip(
    fake_library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    spec = load(SCARA)
    configuration = rtl_configuration(spec, physical="ft245_async")
    plant = load_plant("scara", spec)
    with RtlBoard(spec, configuration=configuration, plant=plant, endpoint="tcp") as board:
        chip = {"serial": "FT1", "port": board.url.rpartition(":")[2], "log": tmp_path / "log"}
        monkeypatch.setenv("UNITYLINK_LIBUSB", str(fake_library))
        monkeypatch.setenv("UNITYLINK_ROOT", str(tmp_path))
        monkeypatch.setenv("FAKE_USB", " ".join(f"{key}={value}" for key, value in chip.items()))
        with connect("ftdi:FT1?mode=fifo&fifo=256&timeout=1") as link:
            move(link)
        assert board.error is None, "the chip saw its rules kept"


def test_scara_moves_behind_the_spi_slave(spi_client: Callable[..., str]) -> None:
    """The driver clocks the VHDL of the slave itself, byte by byte."""
    spec = load(SCARA)
    configuration = rtl_configuration(spec, physical="spi")
    with RtlBoard(
        spec, configuration=configuration, plant=load_plant("scara", spec), endpoint="tcp"
    ) as board:
        code = f"""
            import threading
            from unitylink import connect
            from unitylink.layer4_data import load_spec_objects
            from unitylink.spec import load
            with connect("spi:/dev/spidev0.0?fifo=256&timeout=2") as link:
                arm = load_spec_objects(load({str(SCARA)!r}), link)
                there = threading.Event()
                arm["j1.cpos"].on_change(lambda counts: counts == 300 and there.set())
                arm["j1.spd_sp"].write(2000)
                arm["j1.pos_sp"].write(300)
                print(there.wait(60), link.protocol)
                arm.stop_publishing()
        """
        assert spi_client(code, port=board.url.rpartition(":")[2], exchange=1) == "True framed\n"
        assert board.error is None


def test_the_vhdl_and_two_models_on_one_pair(tmp_path: Path) -> None:
    """Nodes 1 and 3 are twins behind the reference. Node 2 is the VHDL: physical layer, core and words."""
    file = tmp_path / "elbow.ul"
    file.write_text(
        "link elbow (PHYSICAL=rs485, NODE=2, ENGINE=fast); "
        "public elbow() { @set = 0x12: WRITE(); @is = 0x13: READ(); }"
    )
    spec = load(file)
    with ExitStack() as stack:
        vhdl = stack.enter_context(RtlBoard(spec, endpoint="tcp"))
        twins = {number: stack.enter_context(Board(endpoint="tcp")) for number in (1, 3)}
        nodes: dict[int, PairNode] = {n: ModelNode(n, address_of(twin.url)) for n, twin in twins.items()}
        nodes[2] = WireNode(address_of(vhdl.url))
        pair = Pair(nodes, tmp_path / "tty", echo=True)
        stack.callback(pair.close)
        url = f"rs485:{pair.path}?baud=125000&timeout=5&silence=2&node="
        links = {number: stack.enter_context(connect(f"{url}{number}")) for number in (1, 2, 3)}
        for value in range(5):
            for number, link in links.items():
                link.write(0x12, 10 * value + number)
            assert [link.read(0x12) for link in links.values() if link is not links[2]] == [
                10 * value + 1,
                10 * value + 3,
            ]
        assert vhdl.registers[0x12] == 42
        with links[2].subscribe([0x12, 0x13], divisor=10) as subscription:
            assert subscription.wait(60)
            assert subscription.drain()[1][0].tolist()[0] == 42
        assert (pair.collisions, vhdl.error) == (0, None)
        assert links[2].statistics().checksum_errors == 0


def test_the_twin_tells_what_the_small_engine_tells(tmp_path: Path) -> None:
    """A host that works with `sim:` works with the bitstream: sizes and replies are the same."""
    file = tmp_path / "lamp.ul"
    file.write_text(
        "link lamp (ENGINE=small); public lamp() "
        "{ @led = 0x0: u8 WRITE(INITIAL=5, SAFE=1); @buttons = 0x1: READ(); @uptime = 0x2: READ(); }"
    )
    told = {}
    for kind in ("sim", "rtl"):
        with connect(f"{kind}:{file}?clock_hz=1000000&plant=loopback") as link:
            answers = [link.read(0)]
            link.write(0, 7)
            link.post_many([0] * 20, range(20))
            link.sync()
            answers += [link.read(0), *link.read_many([0, 0, 0]).tolist()]
            with pytest.raises(DeviceMismatch, match="reads at most 1 words at once"):
                link.read_many([1, 2], atomic=True)
            with pytest.raises(UnityLinkError):
                link.subscribe([1], divisor=10)
            link.dead_man = 0.5
            told[kind] = (link.description, link.configuration, answers, link.statistics().sessions)
            assert link.board.configuration.engine == "small"
    assert told["sim"] == told["rtl"]
    description = told["rtl"][0]
    assert (description.request_max, description.window, description.features) == (32, 8, 16)
    assert told["rtl"][2] == [5, 19, 19, 19, 19]


def test_the_small_engine_publishes_as_its_twin(tmp_path: Path) -> None:
    """The sizes are those of the twin, and no publish is missing."""
    file = tmp_path / "lamp.ul"
    file.write_text(
        "link lamp (ENGINE=small); public lamp() "
        "{ @led = 0x0: u8 WRITE(INITIAL=5, SAFE=1); @uptime = 0x2: READ(PUBLISH(100 Hz)); }"
    )
    told = {}
    for kind in ("sim", "rtl"):
        with connect(f"{kind}:{file}?clock_hz=4000000&plant=loopback&timeout=20") as link:
            assert link.board.configuration.engine == "small"
            link.write(0, 9)
            with link.subscribe([0, 2], divisor=10) as published:
                found: list[list[int]] = []
                while len(found) < 3:
                    assert published.wait(60)
                    found += published.drain()[1].tolist()
                assert published.missing == 0
            with pytest.raises(DeviceMismatch, match="17"):
                link.subscribe(range(18), divisor=10)
            told[kind] = (link.description, link.configuration, [row[0] for row in found[:3]])
    assert told["sim"] == told["rtl"]
    _, configuration, values = told["rtl"]
    assert (configuration.groups, configuration.usable_group_size, values) == (4, 17, [9, 9, 9])


def address_of(url: str) -> tuple[str, int]:
    host, _, port = url.removeprefix("tcp://").rpartition(":")
    return host, int(port)


@pytest.mark.parametrize(
    ("example", "arguments", "said"),
    [
        ("walker18", ["--cycles", "1"], "The walker is there."),
        pytest.param(  # here both arms are behind one design; above, each arm has its own
            *("pa10", ["--pace", "2", "--spec", "pa10.ul"], "Both arms are home again."),
            marks=pytest.mark.long,
        ),
        ("profile", [], "a step: 32 points in one commit, 32 samples"),
    ],
)
def test_examples_move_on_the_gateware(example: str, arguments: list[str], said: str) -> None:
    command = [sys.executable, ROOT / "examples" / example / "run.py", "--rtl", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=240)
    assert (done.returncode, done.stderr) == (0, ""), done.stdout
    assert said in done.stdout


def test_simulate_serves_it(run: Run, tmp_path: Path) -> None:
    command = [UNITYLINK, "simulate", SCARA, "--rtl", "--plant", "scara", "--pty", tmp_path / "tty"]
    with subprocess.Popen(list(map(str, command)), stdout=subprocess.PIPE, text=True) as server:
        try:
            assert server.stdout is not None
            link = re.search(r"at (serial:\S+)", server.stdout.readline())
            assert link is not None
            done = run("read", link.group(1), "j1.cpos", "--spec", SCARA)
            assert done.returncode == 0, done.stderr
            assert done.stdout.startswith("j1.cpos = ")
        finally:
            server.send_signal(signal.SIGTERM)
        assert server.wait(30) == 0


@pytest.mark.parametrize("runs", [6, pytest.param(40, marks=pytest.mark.long)])
def test_recordings_on_the_vhdl(run: Run, tmp_path: Path, runs: int) -> None:
    """This is the core with classic only. tests/gateware plays all recordings to the core with both
    protocols.
    """
    recorded = json.loads(RECORDINGS.read_text("utf-8"))
    recorded["runs"] = recorded["runs"][:runs]
    some = tmp_path / "some.json"
    some.write_text(json.dumps(recorded), "utf-8")
    done = run("conformance", some, "--rtl")
    assert done.returncode == 0, done.stdout + done.stderr
    passed = re.fullmatch(r"(\d+) passed, 0 failed", done.stdout.splitlines()[-1])
    assert passed is not None and int(passed[1]) == {6: 305, 40: 366}[runs]


def test_missing_tools_are_named(run: Run, tmp_path: Path) -> None:
    done = run("info", f"rtl:{SCARA}", PATH=str(tmp_path))
    assert done.returncode == 1
    assert "missing: ghdl, verilator, g++" in done.stderr
    assert "apt-get install ghdl verilator g++" in done.stderr
    done = run("conformance", RECORDINGS, "--rtl", PATH=str(tmp_path))
    assert done.returncode == 1
    assert "ghdl is missing" in done.stderr


def test_the_pace_is_a_figure() -> None:
    report = bench(only=["rtl"], quick=True, say=lambda message: None)
    assert not report.failures
    assert report.figures[0].measured > 0
    assert not report.figures[0].complaint
