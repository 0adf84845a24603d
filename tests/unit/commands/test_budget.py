# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink budget`: what it prints, and how it ends."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from unitylink.cli import main

SCARA = Path(__file__).resolve().parents[3] / "examples" / "scara" / "scara.ul"


def test_a_table_for_people(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["budget", str(SCARA), "--baud", "3000000"]) == 0
    out = capsys.readouterr().out
    assert "45 at a tick" in out and "4,500 a second" in out and "1.5% of the line" in out
    assert "scara, framed, 32 data bits" in out and "at 50 MHz" in out and "2012" not in out
    assert "100 Hz" in out and "highest rate" in out


def test_the_classic_protocol_and_another_clock(capsys: pytest.CaptureFixture[str]) -> None:
    line = ["budget", str(SCARA), "--baud", "1000000", "--clock-hz", "12000000"]
    assert main([*line, "--protocol", "classic", "--crc"]) == 0
    out = capsys.readouterr().out
    assert "77 at a tick" in out and "at 12 MHz" in out and "2012 gateware" in out
    assert main([*line, "--crc"]) == 2
    assert "--crc: frames always have their check" in capsys.readouterr().err


def test_json_and_a_line_too_slow(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["budget", str(SCARA), "--baud", "9600", "--json"]) == 1
    captured = capsys.readouterr()
    (device,) = json.loads(captured.out)["devices"]
    assert device["groups"][0]["message_bytes"] == 45 and device["load"] > 4
    assert (device["protocol"], device["clock_hz"]) == ("framed", 50_000_000)
    assert device["groups"][0]["latency_s"] is None
    assert "the publishes need 45,000 baud, the line has 9,600" in captured.err


def test_a_spec_that_is_not_there(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["budget", "nowhere.ul"]) == 1
    assert "nowhere.ul" in capsys.readouterr().err


def test_a_ring(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main(["budget", str(SCARA), "--json"]) == 0
    ((ring,),) = (device["rings"] for device in json.loads(capsys.readouterr().out)["devices"])
    own, joints = ring["nodes"]
    assert (own["id"], own["registers"], ring["cycle_bytes"]) == (1, [], 114)
    assert (joints["id"], joints["registers"], joints["cycle_bytes"]) == (2, [0, 1, 2], 96)
    assert joints["gives"] == [f"j{n}.{what}" for n in range(1, 5) for what in ("cpos", "spd")]
    assert joints["obeys"] == [f"j{n}.{what}" for n in range(1, 5) for what in ("pos_sp", "spd_sp")]
    assert ring["publishes"][0]["sensor"] == {"typical_s": None, "bound_s": None}  # no baud rate
    slow = tmp_path / "slow.ul"
    slow.write_text("public net(u) { TOSNET(COMM=u, CYCLE_RATE=1 kHz); @a = 0x80: READ(); }")
    assert main(["budget", str(slow)]) == 0
    shown = capsys.readouterr().out
    assert "cycle                    1.00 ms, 1,000 Hz, 52 us at best: 50 bytes" in shown
    assert "when    values" not in shown  # it publishes nothing
    assert "beyond the published ring" not in shown
    slow.write_text("public net(u) { TOSNET(COMM=u, NODES=ring, RINGS=2, TIME=0x41); @a = 0x80: READ(); }")
    assert main(["budget", str(slow)]) == 0
    assert "two rings, a clock of all nodes in word 0x41" in capsys.readouterr().out


def test_the_ring_of_a_device(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["info", f"sim:{SCARA}"]) == 0
    assert "sensor to the PC's node  155 us as a rule, 206 us at most" in capsys.readouterr().out
    assert main(["info", f"sim:{SCARA}", "--json"]) == 0
    (network,) = json.loads(capsys.readouterr().out)["networks"].values()
    assert [node["node_id"] for node in network["nodes"]] == [1, 2]
    assert [node["id"] for node in network["budget"]["nodes"]] == [1, 2]


def test_the_pc_is_node_0_where_another_is_node_1(capsys: pytest.CaptureFixture[str]) -> None:
    walker = SCARA.parents[1] / "walker18" / "walker18.ul"
    assert main(["info", f"sim:{walker}", "--json"]) == 0
    (network,) = json.loads(capsys.readouterr().out)["networks"].values()
    assert [node["node_id"] for node in network["nodes"]] == [0, 1, 2, 3, 4, 5, 6]
    assert network["budget"]["nodes"][0]["id"] == 0
