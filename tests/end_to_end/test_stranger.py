# SPDX-License-Identifier: BSD-3-Clause
"""What a stranger does wrong, or what goes wrong for him.

Each time the end is clear, and nothing that had come is lost.
"""

from __future__ import annotations

import itertools
import json
import re
import shlex
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import jsonschema
import pandas
import pytest
from mcap.reader import make_reader

from unitylink.ports import FINDINGS
from unitylink.recording import samples

from .conftest import PATIENCE_S, UNITYLINK, Run, Server

WALKER = """
public walker() { leg[6]: leg("leg {i+1}") @ (0x40+i*4, 0x41+i*4, 0x42+i*4); }
leg(n: string): @ (hip,knee,foot) {
   @hip: i32 READ(ID=n+" hip", PUBLISH(1000 Hz));
   @knee: i32 READ(ID=n+" knee", PUBLISH(1000 Hz));
   @foot: i32 READ(ID=n+" foot", UNIT="rad", SCALE=0.001, PUBLISH(1000 Hz));
}
"""
COUNTER = """
class Plant:
    period_s = 0.001

    def attach(self, spec, registers):
        self.registers, self.addresses = registers, [element.address for _, element in spec.walk()]

    def step(self, time_s):
        for address in self.addresses:
            self.registers[address] = round(time_s * 1000)
"""
SAMPLES = 2000


@pytest.mark.parametrize("ending", ["mcap", "csv"])
def test_every_millisecond_of_18_joints_is_in_the_recording(run: Run, tmp_path: Path, ending: str) -> None:
    """The short form of the ten minutes in docs/recording.md.

    The joints show the millisecond in which they are sampled. The recording is read back with the libraries
    that people use.
    """
    (tmp_path / "walker.ul").write_text(WALKER)
    (tmp_path / "counter.py").write_text(COUNTER)
    file = tmp_path / f"walker.{ending}"
    done = run("record", "sim:walker.ul?plant=counter.py", "--out", file, "--count", SAMPLES, "--json")
    report = json.loads(done.stdout)
    assert done.returncode == 0 and report["lost"] == 0, done.stderr
    hips, feet = (_from_mcap if ending == "mcap" else _from_csv)(file)
    assert len(hips) == SAMPLES == report["samples"]
    assert [later - earlier for earlier, later in itertools.pairwise(hips)] == [1] * (SAMPLES - 1)
    assert feet == pytest.approx([hip / 1000 for hip in hips])


def _from_mcap(file: Path) -> tuple[list[int], list[float]]:
    hips, feet = [], []
    times_ns = [0]
    with open(file, "rb") as stream:
        for schema, channel, message in make_reader(stream).iter_messages():
            assert schema is not None and schema.encoding == "jsonschema"
            assert channel.message_encoding == "json"
            values = json.loads(message.data)
            if len(hips) % 100 == 0:
                jsonschema.validate(values, json.loads(schema.data))
            legs = values["leg"]
            assert {leg["hip"] for leg in legs.values()} == {leg["knee"] for leg in legs.values()}
            assert len(legs) == 6 and message.log_time >= times_ns[-1]
            times_ns.append(message.log_time)
            hips.append(legs["0"]["hip"])
            feet.append(legs["5"]["foot"])
    return hips, feet


def _from_csv(file: Path) -> tuple[list[int], list[float]]:
    table = pandas.read_csv(file)
    assert (
        len(table.columns) == 19
        and table["time_s"].is_monotonic_increasing
        and not table.isna().any(axis=None)
    )
    return table["leg[0].hip"].tolist(), table["leg[5].foot"].tolist()


@pytest.mark.parametrize("endpoint", [("--tcp", "0"), ("--pty", "./board.tty")])
def test_what_a_board_sent_is_kept_when_it_goes_away(
    serve: Callable[..., Server], tmp_path: Path, endpoint: tuple[str, str]
) -> None:
    """The board's plug is pulled while `record` and `plot` run."""
    (tmp_path / "walker.ul").write_text(WALKER)
    for command, file in (("record", "walker.mcap"), ("record", "walker.csv"), ("plot", "walker.png")):
        server = serve("walker.ul", *endpoint)
        trace = tmp_path / f"{file}.pcapng"
        url = f"{server.url}?trace={trace}"
        with subprocess.Popen(
            [UNITYLINK, command, url, "--spec", "walker.ul", "--out", file, "--duration", "60"],
            cwd=tmp_path,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        ) as running:
            while not trace.exists() or trace.stat().st_size < 50_000:  # wait until samples flow
                assert running.poll() is None, running.communicate()
                time.sleep(0.02)
            server.stop()
            said, complaints = running.communicate(timeout=PATIENCE_S)
        assert running.returncode == 1
        (complaint,) = complaints.splitlines()
        assert complaint.startswith(f"error: {url}: the device went away (")
        assert file in said and (tmp_path / file).stat().st_size > 1000
        if command == "record":
            found = re.search(r"([\d,]+) samples", said)
            assert found and len(list(samples(tmp_path / file))) == int(found[1].replace(",", "")) > 0


def test_a_device_that_falls_silent_is_asked_whether_it_is_gone(
    serve: Callable[..., Server], tmp_path: Path
) -> None:
    (tmp_path / "walker.ul").write_text(WALKER)
    server = serve("walker.ul", "--udp", "0")
    with subprocess.Popen(
        [UNITYLINK, "watch", server.url, "--spec", "walker.ul", "--json"],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as watching:
        assert watching.stdout is not None
        json.loads(watching.stdout.readline())
        server.stop()  # UDP reports nothing, and "port unreachable" may come from anybody
        _, complaints = watching.communicate(timeout=PATIENCE_S)
    assert watching.returncode == 1
    (complaint,) = complaints.splitlines()
    assert complaint.endswith("and a read is not answered either; is the device still there?")


def test_the_dissector_comes_along(run: Run) -> None:
    done = run("decode", "--dissector")
    assert done.returncode == 0 and 'Proto("unitylink"' in done.stdout


def test_the_remedy_of_a_finding_can_be_pasted_into_a_shell() -> None:
    commands = [
        kind.remedy
        for kind in FINDINGS.values()
        if re.match(r"(sudo|kill|ping|echo|unitylink) ", kind.remedy)
    ]
    assert len(commands) > 8
    for command in commands:
        checked = subprocess.run(["bash", "-n", "-c", command], capture_output=True, text=True, check=False)
        assert checked.returncode == 0, (command, checked.stderr)
        assert shlex.split(command, comments=True)
