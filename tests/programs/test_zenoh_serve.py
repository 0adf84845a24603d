# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink serve --zenoh`: programs at the server and on the Zenoh network share one board."""

from __future__ import annotations

import subprocess
import sys
import time
from contextlib import ExitStack
from pathlib import Path

import click
import pytest
from unit.zenoh.rig import GOAL, HITS, TEXT, free_port

from unitylink import connect
from unitylink.commands.bridge_zenoh import read_zenoh
from unitylink.errors import AccessRefused, LeaseHeld, LinkNotFound
from unitylink.zenoh.session import Network


def test_the_server_and_the_network_share_the_board_and_its_leases(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    spec = tmp_path / "arm.ul"
    spec.write_text(TEXT, encoding="utf-8")
    monkeypatch.setenv("UNITYLINK_TOKEN", "a-token-of-thirty-two-characters-x")
    router = f"tcp/127.0.0.1:{free_port()}"
    options = [
        "--zenoh",
        f"lab/arm1?listen={router}",
        "--may",
        "zenoh",
        "read",
        "--may",
        "zenoh",
        "write j1.*",
    ]
    command = [
        sys.executable,
        "-m",
        "unitylink",
        "serve",
        f"sim:{spec}",
        str(spec),
        "--listen",
        "127.0.0.1:0",
    ]
    both = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen([*command, *options], text=True, **both) as running, ExitStack() as stack:
        stack.callback(running.kill)  # if something fails
        assert running.stdout is not None
        served = next(line.split()[-1] for line in running.stdout if line.startswith("serving "))
        assert next(running.stdout) == f"on Zenoh:  zenoh:lab/arm1, at {router}\n"
        with connect(f"zenoh:lab/arm1?connect={router}") as far, connect(served) as near:
            far.robot().j1.goal.write(0.5)
            assert near.read(GOAL) == 500
            with pytest.raises(LeaseHeld, match="another client has the write lease"):
                near.write(GOAL, 1)
            near.write(HITS, 7)
            assert far.robot().hits.read() == 7
            with pytest.raises(AccessRefused, match="needs the scope `write hits"):
                far.write(HITS, 8)
        second = subprocess.run(
            [*command, "--zenoh", f"lab/arm1?connect={router}"],
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )
        assert second.returncode == 1 and "another bridge serves lab/arm1 already" in second.stderr
        with Network(connect=router).opened() as stranger:
            token = stranger.liveliness().declare_token("lab/arm1/bridge/0")
            assert running.stderr is not None
            while "another bridge serves lab/arm1, too (0); this one ends" not in (
                line := next(running.stderr)
            ):
                assert "Traceback" not in line
            token.undeclare()
        limit_s = time.monotonic() + 20
        with pytest.raises(LinkNotFound):  # it leaves the network, and was its router
            while time.monotonic() < limit_s:
                Network(connect=router).opened().close()
                time.sleep(0.1)
        with connect(served) as near:
            assert near.read(HITS) == 7  # and goes on without it
        running.terminate()
        _, errors = running.communicate(timeout=20)
    assert running.returncode == 0 and "Traceback" not in errors


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("lab/*", "has a wildcard"),
        ("lab/arm1?port=7447", r"expected NAME, or NAME with one of \?connect=LOCATOR"),
        ("lab/arm1?connect=tcp/a:1&listen=tcp/b:1", "with one of"),
        ("lab/arm1?listen=tcp/0.0.0.0:7447", "other machines could reach the robot"),
        ("lab/arm1?listen=7447", "is no place of Zenoh"),
    ],
)
def test_what_is_no_place_is_refused(text: str, message: str) -> None:
    with pytest.raises(click.UsageError, match=message):
        read_zenoh(text, anyone=False, may=["read"])
