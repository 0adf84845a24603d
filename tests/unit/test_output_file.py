# SPDX-License-Identifier: BSD-3-Clause
"""No command overwrites an existing file without a request, and none writes through a symbolic link."""

from __future__ import annotations

import os
import resource
import signal
from collections.abc import Callable
from pathlib import Path

import pytest

from unitylink import connect
from unitylink.cli import main
from unitylink.errors import LinkError, UnityLinkError
from unitylink.output_file import check_output, create_output, replace_file, write_output

MINE = b"an hour of measurements"
LAMP = "public lamp() { @led = 0x10: WRITE(); @light = 0x11: READ(); }"


def in_the_way(kind: str, path: Path) -> Path:
    """Put somebody's file at `path`, or a link to one. Return where the content is."""
    other = path.with_name(f"of-somebody{path.suffix}") if kind == "link" else path
    other.write_bytes(MINE)
    if kind == "link":
        path.symlink_to(other)
    return other


pytestmark = pytest.mark.xdist_group("matplotlib")  # one worker, because importing matplotlib takes a second


@pytest.fixture
def commands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Callable[[Path], list[str]]]:
    """Return all commands that make a file whose name the user gives."""
    monkeypatch.chdir(tmp_path)
    Path("lamp.ul").write_text(LAMP)
    Path("light.csv").write_text("time_s,light\n0.0,1\n1.0,2\n")
    with connect("sim:lamp.ul?trace=wire.pcapng") as link:
        link.read(0x11)
    return {
        "record.csv": lambda path: ["record", "sim:lamp.ul", "light", "--count", "2", "--out", str(path)],
        "record.mcap": lambda path: ["record", "sim:lamp.ul", "light", "--count", "2", "--out", str(path)],
        "plot.svg": lambda path: ["plot", "light.csv", "--out", str(path)],
        "decode.pcapng": lambda path: ["decode", "wire.pcapng", "--pcapng", str(path)],
    }


@pytest.mark.parametrize("name", ["record.csv", "record.mcap", "plot.svg", "decode.pcapng"])
def test_commands_overwrite_what_is_there_only_when_told(
    name: str, commands: dict[str, Callable[[Path], list[str]]], capsys: pytest.CaptureFixture[str]
) -> None:
    path = Path(name)
    command = commands[name](path)
    in_the_way("file", path)
    assert main(command) == 1 and path.read_bytes() == MINE
    assert "this file exists already" in capsys.readouterr().err
    assert main([*command, "--force"]) == 0 and path.read_bytes() != MINE
    path.unlink()
    other = in_the_way("link", path)
    for words in (command, [*command, "--force"]):
        assert main(words) == 1 and other.read_bytes() == MINE
        assert "a symbolic link" in capsys.readouterr().err
    path.unlink()
    assert main(command) == 0 and path.stat().st_size > 0


@pytest.mark.parametrize("kind", ["file", "link"])
def test_a_trace_overwrites_nothing(kind: str, tmp_path: Path) -> None:
    (tmp_path / "lamp.ul").write_text(LAMP)
    path = tmp_path / "wire.pcapng"
    other = in_the_way(kind, path)
    with pytest.raises(LinkError, match="this file exists already; name another one, or remove it"):
        connect(f"sim:{tmp_path}/lamp.ul?trace={path}")
    assert other.read_bytes() == MINE


def test_a_port_that_cannot_be_opened_leaves_no_trace_in_the_way_of_the_next_try(tmp_path: Path) -> None:
    path = tmp_path / "wire.pcapng"
    for _ in range(2):
        with pytest.raises(LinkError, match="absent"):
            connect(f"serial:{tmp_path}/absent?trace={path}")
        assert not path.exists()


def test_a_pipe_is_written_to_and_left(tmp_path: Path) -> None:
    (tmp_path / "lamp.ul").write_text(LAMP)
    path = tmp_path / "pipe"
    os.mkfifo(path)
    reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    try:
        write_output(path, MINE)
        assert os.read(reader, 1000) == MINE
        with connect(f"sim:{tmp_path}/lamp.ul?trace={path}") as link:
            link.read(0x11)
        assert os.read(reader, 4) == b"\n\r\r\n"
    finally:
        os.close(reader)
    assert path.is_fifo()


def test_a_path_that_cannot_be_a_file_gives_an_error_that_names_it(tmp_path: Path) -> None:
    for path, reason in (
        (tmp_path, "a folder"),
        (tmp_path / "absent" / "a", "No such file"),
        ("a\0b", "null"),
        (tmp_path / ("n" * 300), "too long"),
    ):
        with pytest.raises(UnityLinkError, match=reason):
            os.close(create_output(path))
    check_output(tmp_path / "new", force=True)
    assert not (tmp_path / "new").exists(), "checking makes nothing"


def test_a_write_that_fails_leaves_no_half_file(tmp_path: Path) -> None:
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (10, before[1]))
    try:
        with pytest.raises(UnityLinkError, match="File too large"):
            write_output(tmp_path / "half", MINE)
        with pytest.raises(UnityLinkError, match="No space left"):
            write_output("/dev/full", MINE)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, ignored)
    assert not (tmp_path / "half").exists() and Path("/dev/full").exists()


def test_a_file_is_replaced_whole_with_its_permissions_and_links(tmp_path: Path) -> None:
    path, link = tmp_path / "arm.ul", tmp_path / "link.ul"
    path.write_text("old")
    path.chmod(0o640)
    link.symlink_to(path)
    replace_file(link, "new")
    assert link.is_symlink() and path.read_text() == "new"
    assert path.stat().st_mode & 0o777 == 0o640
    replace_file(tmp_path / "made", b"\0\n")
    assert (tmp_path / "made").read_bytes() == b"\0\n"
    (tmp_path / "plain").touch()
    assert (tmp_path / "made").stat().st_mode == (tmp_path / "plain").stat().st_mode


def test_a_replacement_that_fails_leaves_the_old_file_alone(tmp_path: Path) -> None:
    path = tmp_path / "arm.ul"
    path.write_text("old")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (10, before[1]))
    try:
        with pytest.raises(OSError, match="File too large"):
            replace_file(path, MINE)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, ignored)
    assert path.read_text() == "old" and [file.name for file in tmp_path.iterdir()] == ["arm.ul"]
