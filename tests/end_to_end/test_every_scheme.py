# SPDX-License-Identifier: BSD-3-Clause
"""Every command that takes a LINK takes one of every scheme. `rtl:` is in tests/end_to_end/test_rtl.py."""

from __future__ import annotations

import json
import os
import shutil
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from unittest import mock

import pytest
from end_to_end.every_command import SPEC, converse

from tests.reference.rs485 import ModelNode, Pair
from unitylink.commands.link_option import is_link
from unitylink.connection.schemes import SCHEMES
from unitylink.simulate import Board
from unitylink.spec import load

ROOT = Path(__file__).parents[2]


@pytest.fixture
def spec(tmp_path: Path) -> Path:
    file = tmp_path / "plain.ul"
    file.write_text(SPEC)
    return file


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


def test_every_form_is_a_link() -> None:
    for scheme in SCHEMES.values():
        assert is_link(scheme.form), scheme.form
    assert not any(map(is_link, ["arm.mcap", "x.position", "j*.cpos", "0x88", "/dev/ttyUSB0", "a.ul"]))


def check(said: dict[str, str], *, one_board: bool = True) -> None:
    """Check that each command did its work. A written value can only be read back on the same board."""
    assert "target" in said["list"] and "0x001A" in said["list"]
    assert said["write"].splitlines()[-1] == "target = -7 mm"
    assert "0x0013" in said["read"] and ("-7" in said["read"]) == one_board
    assert said["watch"].count("position=") == 2
    assert "samples in" in said["record"]
    assert "the robot has 3 values" in said["bridge"]


@pytest.mark.parametrize(("scheme", "endpoint"), [("tcp", "tcp"), ("udp", "udp"), ("serial", "pty")])
def test_boards_at_a_port(stack: ExitStack, spec: Path, tmp_path: Path, scheme: str, endpoint: str) -> None:
    board = stack.enter_context(Board(load(spec), endpoint=endpoint))
    assert board.url.startswith(f"{scheme}:")
    check(converse(lambda: f"{board.url}?timeout=2", spec, tmp_path))


def test_a_board_behind_a_server(stack: ExitStack, spec: Path, tmp_path: Path) -> None:
    program = [
        sys.executable,
        "-m",
        "unitylink",
        "serve",
        f"sim:{spec}",
        str(spec),
        "--listen",
        "0",
        "--json",
    ]
    server = stack.enter_context(
        subprocess.Popen(program, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    )
    stack.callback(server.terminate)
    assert server.stdout is not None
    told = json.loads(server.stdout.readline())
    assert told["urls"]["plain"].startswith("serve://127.0.0.1:")
    stack.enter_context(mock.patch.dict(os.environ, {"UNITYLINK_TOKEN": told["token"]}))
    check(converse(lambda: f"{told['urls']['plain']}?timeout=2", spec, tmp_path))
    server.send_signal(signal.SIGTERM)
    assert server.wait(20) == 0


def test_a_robot_on_a_zenoh_network(stack: ExitStack, spec: Path, tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as free:
        router = f"tcp/127.0.0.1:{free.getsockname()[1]}"
    program = [sys.executable, "-m", "unitylink", "bridge", "zenoh", f"sim:{spec}", "--key", "lab/arm1"]
    bridge = stack.enter_context(
        subprocess.Popen(
            [*program, "--listen", router], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
    )
    stack.callback(bridge.terminate)
    assert bridge.stdout is not None
    assert bridge.stdout.readline().endswith(f" is lab/arm1 on Zenoh, at {router}\n")
    refused = {"doctor": "not a port", "term": "has no bytes, only registers"}
    url = f"zenoh:lab/arm1?connect={router}&timeout=2"
    check(converse(lambda: url, spec, tmp_path, own_spec=True, refused=refused))
    bridge.send_signal(signal.SIGTERM)
    assert bridge.wait(20) == 0


def test_a_descriptor(stack: ExitStack, spec: Path, tmp_path: Path) -> None:
    def url() -> str:
        board = stack.enter_context(Board(load(spec)))
        assert board.url.startswith("fd:")
        return f"{board.url}?timeout=2"

    check(converse(url, spec, tmp_path, refused={"doctor": "can be opened only once"}), one_board=False)


def test_a_virtual_board(spec: Path, tmp_path: Path) -> None:
    doctor = {"doctor": "is a virtual board"}
    check(converse(lambda: f"sim:{spec}", spec, tmp_path, own_spec=True, refused=doctor), one_board=False)


@pytest.mark.long  # tests/gateware/boards/test_bit.py reads and writes in `make test`
def test_a_bitstream(spec: Path, tmp_path: Path) -> None:
    url = f"bit:{spec}?board=icebreaker&protocol=classic"
    doctor = {"doctor": "is a virtual board"}
    check(converse(lambda: url, spec, tmp_path, own_spec=True, refused=doctor), one_board=False)


def test_mapped_memory(spec: Path, tmp_path: Path) -> None:
    (tmp_path / "registers").write_bytes(bytes(4096))
    no_port = {"doctor": "memory of this machine", "term": "has no bytes, only registers"}
    check(converse(lambda: f"mmap:{tmp_path / 'registers'}", spec, tmp_path, refused=no_port))


def test_a_node_on_a_pair(stack: ExitStack, spec: Path, tmp_path: Path) -> None:
    board = stack.enter_context(Board(load(spec), endpoint="tcp"))
    host, _, port = board.url.removeprefix("tcp://").rpartition(":")
    pair = Pair({3: ModelNode(3, (host, int(port)))}, tmp_path / "tty", echo=False)
    stack.callback(pair.close)
    url = f"rs485:{pair.path}?node=3&timeout=2&silence=0.2"
    check(converse(lambda: url, spec, tmp_path, refused={"term": "carries only frames"}))


def test_an_ftdi_chip(
    stack: ExitStack, spec: Path, tmp_path: Path, fake_library: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    board = stack.enter_context(Board(load(spec), endpoint="tcp"))
    # a copy of its own, because the library keeps the chip's state
    shutil.copy(fake_library, tmp_path / "fake_libusb.so")
    monkeypatch.setenv("UNITYLINK_LIBUSB", str(tmp_path / "fake_libusb.so"))
    monkeypatch.setenv("FAKE_USB", f"serial=FT1 port={board.url.rpartition(':')[2]} log={tmp_path / 'log'}")
    # the doctor looks for the chip among the machine's real devices, where it is not
    no_chip = {"doctor": "The FTDI chip is not plugged in"}
    check(converse(lambda: "ftdi:FT1?timeout=2", spec, tmp_path, refused=no_chip))


def test_an_spi_port(stack: ExitStack, spec: Path, tmp_path: Path, spi_client: Callable[..., str]) -> None:
    board = stack.enter_context(Board(load(spec), endpoint="tcp"))
    code = f"""
        import sys
        sys.path[:0] = [{str(ROOT / "tests")!r}, {str(ROOT)!r}]
        from pathlib import Path
        from end_to_end.every_command import converse
        url = "spi:/dev/spidev0.0?speed_hz=20000000&fifo=256&timeout=2"
        no_port = {{"doctor": "The SPI port does not exist"}}  # it looks where the fake is not
        print(converse(lambda: url, Path({str(spec)!r}), Path({str(tmp_path)!r}), refused=no_port))
    """
    check(eval(spi_client(code, port=board.url.rpartition(":")[2])))
