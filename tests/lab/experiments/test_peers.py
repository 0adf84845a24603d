# SPDX-License-Identifier: BSD-3-Clause
"""The wire before a device counts bytes and makes faults.

Our side is tried on it here. `make experiments` tries LiteX.
"""

from __future__ import annotations

import json
import os
import pty
import tty
from pathlib import Path

import pytest

from unitylink_lab.bench.figure import Run
from unitylink_lab.experiments import peer_faults, peers
from unitylink_lab.experiments.wire import Pty, Wire

DOCS = Path(__file__).resolve().parents[3] / "docs"
HERE = Run(True, Path(), lambda text: None)


def test_a_wire_carries_counts_flips_and_freezes() -> None:
    (host, program), (device, board) = pty.openpty(), pty.openpty()
    for end in (program, board):
        tty.setraw(end)
    wire = Wire(Pty(host), Pty(device))
    os.write(program, b"#R:12\n")
    wire.turn([])
    assert os.read(board, 99) == b"#R:12\n"
    assert wire.obey("settle 0") == "ok"
    for command, came in (("thaw", b"abc"), ("flip", b"`bc"), ("cut", b"bc"), ("late 0.01", b"abc")):
        assert wire.obey(command) == "ok"
        os.write(board, b"abc")
        wire.turn([])
        assert wire.obey("settle 10") == "ok"
        assert os.read(program, 99) == came
    assert wire.obey("lose device") == "ok" and wire.obey("settle 0") == "busy"
    os.write(program, b"#R:12\n")
    assert wire.obey("settle 10") == "ok"
    os.write(program, b"#")
    wire.turn([])
    assert os.read(board, 99) == b"#"
    assert wire.obey("bytes") == "13 12" and wire.obey("bytes") == "0 0"
    wire.obey("freeze")
    os.write(board, b"abc")
    wire.turn([])
    assert wire.obey("bytes") == "0 0"
    assert wire.obey("melt") == "no command 'melt'"
    for end in (host, program, device, board):
        os.close(end)


def test_a_checksum_makes_the_difference() -> None:
    outcomes = {
        "Unity-Link, framed": ("right", [10, 14]),
        "Unity-Link, classic": ("wrong, unnoticed", [8, 14]),
        "Unity-Link, framed, UDP": ("right", [12, 16]),
    }
    for name, row in peers.spoiled(HERE, list(outcomes)).items():
        assert (row["flipped"]["outcome"], row["bytes"]["read"]) == outcomes[name]
        assert row["after"]["outcome"] == "right"
        assert row["frozen"]["outcome"] == "error" and "LinkTimeout" in row["frozen"]["detail"]


def test_each_kind_of_wire_has_a_link_of_ours_as_the_reference() -> None:
    assert {peers.wire_of(first): first for first in peers.FIRST.values()} == peers.FIRST
    assert set(peers.FIRST.values()) <= peers.OURS.keys()
    assert peers.OURS.keys() | peers.THEIRS.keys() > peers.DATAGRAMS
    figures = peers._figures([[20, 40], [30, 30]], [[10, 10], [20, 20]])
    assert figures["ratio"] == pytest.approx(2.25)  # the ratios within each round are 3 and 1.5


def test_what_is_not_here_is_told(tmp_path: Path) -> None:
    from unitylink_lab.bench.programs import native
    from unitylink_lab.experiments.results import _measured
    from unitylink_lab.experiments.tables import peers as table

    told = _measured(lambda: [{"path": str(native(tmp_path, "bench_uartbone"))}])
    assert told["rows"] == [] and "make bench" in told["failure"]
    assert "Not measured: " in str(table(told)[0])


MET = (
    "a bit of a write flips",
    "a byte of an answer is lost",
    "a write is lost",
    "the device is frozen",
    "an answer's datagram is lost",
    "everything is lost for a while (#1436 #1458)",
)


@pytest.mark.parametrize("fault", [fault for fault in peer_faults.FAULTS if fault.name in MET], ids=str)
def test_what_the_page_says_of_our_link_is_still_true(fault: peer_faults.Fault) -> None:
    rows = json.loads((DOCS / "faults-beside-litex.json").read_text(encoding="utf-8"))["rows"]
    assert [row["fault"] for row in rows] == [fault.name for fault in peer_faults.FAULTS]
    row = next(row for row in rows if row["fault"] == fault.name)
    told = peer_faults.met(HERE, fault.ours, fault)
    assert not told.bad and not row["ours"]["bad"], told.text
    assert told.text.split(" (")[0] == row["ours"]["text"].split(" (")[0]


def test_a_wrong_value_and_an_endless_wait_are_bad() -> None:
    for outcome, bad in (("right", False), ("error", False), ("wrong, unnoticed", True), ("hangs", True)):
        told = {"outcome": outcome, "detail": "LinkTimeout", "time_s": 0.1}
        assert peer_faults._judged(("", told)).bad is bad
