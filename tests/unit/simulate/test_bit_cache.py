# SPDX-License-Identifier: BSD-3-Clause
"""A bare chip is placed once: the netlist of the same design is found in the cache."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

from unitylink.simulate.bit import bare

NETLIST = "module lamp (input clock);\n/* {place}:22:5  */\nassign n1 = {value};\nendmodule\n"


@pytest.fixture
def placed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[str]:
    """Return the netlists that were placed. No tool runs."""
    found: list[str] = []

    def place(verilog: str, *rest: object) -> dict[str, object]:
        found.append(verilog)
        return {"bitstream": "", "sites": {"clock": "A1"}}

    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(bare, "find_program", lambda *names: "nextpnr")
    monkeypatch.setattr(bare, "run_tool", lambda *command, **options: SimpleNamespace(out="1.0"))
    monkeypatch.setattr(bare, "place", place)
    monkeypatch.setattr(bare.BareChip, "unpack", lambda *bitstream: None)
    monkeypatch.setattr(bare, "with_ports", lambda *chip: "")
    return found


def on_chip(place: str, value: str = "1'b0", chip: bare.BareChip = bare.HX8K) -> None:
    bare.on_chip(NETLIST.format(place=place, value=value), "lamp", lambda text: None, chip)


def test_a_netlist_made_in_another_folder_is_the_same(placed: list[str]) -> None:
    on_chip("/tmp/unitylink-netlist-ab12/4_lamp.vhd")
    on_chip("/tmp/with a blank/4_lamp.vhd")
    assert len(placed) == 1


def test_another_design_or_chip_is_placed_anew(placed: list[str]) -> None:
    on_chip("lamp.vhd")
    on_chip("lamp.vhd", value="1'b1")
    on_chip("lamp.vhd", chip=bare.ECP5)
    assert len(placed) == 3
