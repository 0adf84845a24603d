# SPDX-License-Identifier: BSD-3-Clause
"""Which URLs may name a line that comes back, and what such a line leaves behind."""

from __future__ import annotations

import gc
import os
from pathlib import Path

import pytest
from unit.link.reconnect_rig import CONFIGURATION, PATIENCE_S, SCRATCH, Rig, opened, until

from unitylink import connect
from unitylink.capture import read_packets
from unitylink.errors import LinkClosed, LinkDown, LinkError, UrlError
from unitylink.simulate import Board


def test_a_serial_port_that_is_plugged_in_again(tmp_path: Path) -> None:
    place = tmp_path / "board.tty"
    board = Board(configuration=CONFIGURATION, endpoint=f"pty:{place}")
    with connect(f"serial:{place}?timeout=5&reconnect=1") as link:
        publishes = link.subscribe([SCRATCH], divisor=10)
        for life in range(2):
            board.close()
            until(lambda: link.trouble)
            with pytest.raises(LinkDown):
                link.write(SCRATCH, 1)
            board = Board(configuration=CONFIGURATION, endpoint=f"pty:{place}")
            board.registers[SCRATCH] = 40 + life
            assert link.wait_up(PATIENCE_S)
            assert link.read(SCRATCH) == 40 + life
            publishes.drain()
            assert publishes.wait(PATIENCE_S)
    board.close()


def test_datagrams_find_the_board_again() -> None:
    board = Board(configuration=CONFIGURATION, endpoint="udp")
    port = board.url.rsplit(":", 1)[1]
    with connect(f"{board.url}?timeout=0.3&reconnect=1") as link:
        board.close()
        until(lambda: link.trouble)
        board = Board(configuration=CONFIGURATION, endpoint=f"udp:{port}")
        assert link.wait_up(PATIENCE_S)
        link.write(SCRATCH, 3)
        assert board.registers[SCRATCH] == 3
    board.close()


def test_what_cannot_be_opened_again_says_so(rig: Rig) -> None:
    with Board() as board, pytest.raises(UrlError, match="cannot be opened again"):
        connect(board.url, reconnect=True)
    with pytest.raises(UrlError):
        connect("mmap:/dev/zero?size=4096", reconnect=True)
    with pytest.raises(UrlError, match="add reconnect=1"):
        connect(f"{rig.url}?wait=1")
    with pytest.raises(UrlError, match="in the URL and as an argument"):
        connect(f"{rig.url}?reconnect=1", reconnect=True)
    with pytest.raises(UrlError, match="reconnect=2"):
        connect(f"{rig.url}?reconnect=2")
    with connect(f"{rig.url}?reconnect=0", reconnect="auto") as link, Board() as board:
        with connect(board.url, reconnect="auto") as once:
            assert once.read(SCRATCH) == 0
        rig.wire.cut_after("to the host", 0)
        with pytest.raises(LinkError):
            link.read(SCRATCH)
        assert link.closed
    with connect(rig.url, reconnect="auto") as link:
        rig.wire.cut_after("to the host", 0)
        until(lambda link=link: link.statistics().reconnections)
    with connect(rig.url, reconnect=False) as link:
        rig.wire.cut_after("to the host", 0)
        with pytest.raises(LinkError):  # without reconnecting, only a request notices the loss
            link.read(SCRATCH)
        with pytest.raises(LinkClosed):
            link.wait_up(1)


def test_a_virtual_board_whose_line_breaks(tmp_path: Path) -> None:
    spec = tmp_path / "one.ul"
    spec.write_text("public one() {\n   @a = 0x10: i16 READWRITE();\n}\n")
    with connect(f"sim:{spec}?reconnect=1") as link:
        link.write(0x10, 3)
        link.board.hang_up()
        until(lambda: link.statistics().reconnections)
        assert link.read(0x10) == 3


def test_one_capture_holds_all_lines(rig: Rig, tmp_path: Path) -> None:
    path = tmp_path / "wire.pcapng"
    with opened(rig.url, "framed", f"&trace={path}") as link:
        link.write(SCRATCH, 0x11223344)
        rig.wire.cut_after("to the host", 0)
        until(lambda: link.statistics().reconnections)
        link.write(SCRATCH, 0x55667788)
        assert link._native.warning == ""
    sent = b"".join(packet.data for packet in read_packets(path))
    assert b"\x11\x22\x33\x44" in sent
    assert b"\x55\x66\x77\x88" in sent


def test_nothing_is_left_behind(rig: Rig) -> None:
    def count() -> tuple[int, int]:
        return len(os.listdir("/proc/self/fd")), len(os.listdir("/proc/self/task"))

    def live(protocol: str) -> None:
        with opened(rig.url, protocol) as link:
            link.subscribe([SCRATCH], divisor=10)
            link.on_event(lambda _: None)
            for turn in range(1, 8):
                rig.wire.cut_after("to the host", 0)
                until(lambda turn=turn: link.statistics().reconnections == turn)

    gc.collect()
    before = count()
    for protocol in ("framed", "classic"):
        live(protocol)
    gc.collect()
    until(lambda: all(now <= then for now, then in zip(count(), before, strict=True)))
