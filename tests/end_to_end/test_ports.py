# SPDX-License-Identifier: BSD-3-Clause
"""Ports and their problems, through the real command line."""

from __future__ import annotations

import json
import socket
from collections.abc import Callable
from pathlib import Path

from .conftest import Run

ARM = "public arm(c,u) { TOSNET(CTRL=c,COMM=u); @angle = 0x40: READ(PUBLISH(1,10)); }"


def test_a_board_that_answers_is_healthy(run: Run, serve: Callable[..., object], tmp_path: Path) -> None:
    (tmp_path / "arm.ul").write_text(ARM)
    url = serve("arm.ul", "--tcp", "0").url  # type: ignore[attr-defined]
    done = run("doctor", url, "--spec", "arm.ul", "--json")
    report = json.loads(done.stdout)
    assert done.returncode == 0 and report["healthy"], report


def test_gateware_of_another_spec_is_reported_with_exit_code_one(
    run: Run, serve: Callable[..., object], tmp_path: Path
) -> None:
    (tmp_path / "arm.ul").write_text(ARM)
    (tmp_path / "other.ul").write_text("public other() { @far = 0x480: READ(); }")
    url = serve("arm.ul", "--tcp", "0").url  # type: ignore[attr-defined]
    done = run("doctor", url, "--spec", "other.ul")
    assert done.returncode == 1
    assert "[other-gateware]" in done.stdout and "other.ul" in done.stdout and "mend: " in done.stdout
    # with the classic protocol, the device cannot tell its spec
    untold = run("doctor", f"{url}?protocol=classic", "--spec", "other.ul")
    assert untold.returncode == 1
    assert "[wrong-spec]" in untold.stdout and "far at 0x0480" in untold.stdout and "mend: " in untold.stdout


def test_nobody_there_is_a_finding_not_a_traceback(run: Run) -> None:
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        done = run("doctor", f"tcp://127.0.0.1:{unused.getsockname()[1]}")
    assert done.returncode == 1 and "[unreachable]" in done.stdout and "ping 127.0.0.1" in done.stdout
    absent = run("doctor", "serial:/dev/ttyUSB99")
    assert absent.returncode == 1 and "[no-port]" in absent.stdout


def test_a_virtual_board_needs_no_doctor(run: Run) -> None:
    done = run("doctor", "sim:arm.ul")
    assert done.returncode == 1 and "virtual board" in done.stderr


def test_discover_lists_ports_and_asks_the_network_only_when_told(
    run: Run, serve: Callable[..., object], tmp_path: Path
) -> None:
    (tmp_path / "arm.ul").write_text(ARM)
    port = serve("arm.ul", "--udp", "0", "--bind", "0.0.0.0", "--anyone").url.rpartition(":")[2]  # type: ignore[attr-defined]
    silent = run("discover", "--json")
    assert silent.returncode == 0, silent.stderr
    assert all(entry["answers"] is None for entry in json.loads(silent.stdout)["ports"])
    asked = run("discover", "--ask", "--port", port, "--broadcast", "127.255.255.255", "--json")
    (board,) = [entry for entry in json.loads(asked.stdout)["ports"] if entry["link"].startswith("udp://")]
    assert board["link"].endswith(f":{port}") and "CNF:" in board["answers"]
