# SPDX-License-Identifier: BSD-3-Clause
"""The netlist that GHDL makes of the core does the same as the source, byte for byte and clock for clock."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from gateware.simulators import Ghdl

from unitylink.gateware import every_source
from unitylink.settings import Settings
from unitylink_lab.conformance.bench import bench


def test_netlist_in_lockstep(ghdl: Any, rtl: Any, tmp_path: Path) -> None:
    ghdl._call(*ghdl.make, "core")
    netlist = ghdl._call("--synth", "--std=08", "core")
    assert "warning:" not in netlist
    folder = tmp_path / "netlist"
    folder.mkdir()
    # GHDL prints notes about memories on its other stream, which comes last.
    (folder / "core.vhd").write_text(
        netlist[: netlist.rindex("end rtl;") + len("end rtl;\n")], encoding="utf-8"
    )
    others = [source for source in every_source() if source.name != "core.vhd"]
    synthesised = type(rtl)(Ghdl(folder, [*others, folder / "core.vhd"]), folder)

    # The netlist has the default settings.
    plain = Settings()
    configuration = replace(
        bench({}), groups=plain.groups, group_size=plain.group_size, read_many=plain.read_many
    )
    framed = {"protocol": plain.protocol, "exchange_size": plain.exchange_size, "window": plain.window}
    messages = [
        "#RLC\n$RLC*9B\n#R:12\n$R:12*58\n$R:12*59\n#W:20DEADBEEF\n#R:20\n#RM:03101112\n",
        "#R:E3\n#RM:0311E312\n#R:zz\n#R:1\n%\n#X\n#WSA:0103\n#R:F5\n#R:00\n",
        "#WSA:0103202122\n#WSR:010001\n#RSI:01\n#WSA:000112\n#WIC:0001\n#RIC\n#EPC\n",
    ]
    exchanges: list[list[tuple[str, Any]]] = [[("send", text), ("quiet", 300)] for text in messages]
    exchanges.append([("events", 1), ("wait", 300), ("events", 0), ("rx_error", 5), ("quiet", 300)])
    expected, times = rtl(configuration, exchanges, stall_percent=20, **framed), list(rtl.times)
    assert b"&PUB:01" in expected[2]
    assert b"&PUB:00" in expected[3]
    assert synthesised(configuration, exchanges, stall_percent=20, **framed) == expected
    assert synthesised.times == times
