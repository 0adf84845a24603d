# SPDX-License-Identifier: BSD-3-Clause
"""The LiteX module connects each port, as stand-ins for LiteX show. In LiteX itself the slaves answer."""

from __future__ import annotations

import csv
import importlib.util
import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from unitylink.gateware import ports_of
from unitylink_lab.bench.figure import Run
from unitylink_lab.bench.litex import environment

ROOT = Path(__file__).resolve().parents[2]
MODULE = ROOT / "examples" / "litex" / "unitylink_module.py"
BENCH = Path(__file__).with_name("litex_bench.sv")
# GHDL's Verilog has names that are words of newer Verilog.
VERILATOR = ["verilator", "--binary", "--timing", "-Wno-fatal", "-Wno-lint", "-Wno-style", "+1364-2005ext+v"]


class Signal:
    def __init__(self, bits: int = 1) -> None:
        self.bits = bits


class Cat(Signal):
    def __init__(self, *parts: Signal) -> None:
        super().__init__(sum(part.bits for part in parts))


class Pad(SimpleNamespace):
    def __init__(self) -> None:
        super().__init__(i=Signal(), o=Signal(), oe=Signal())

    def get_tristate(self, pin: str) -> tuple[str, Pad]:
        return (pin, self)


class Interface:
    """LiteX's Wishbone, with the widths of its signals."""

    def __init__(self, *, data_width: int, adr_width: int) -> None:
        self.adr, self.sel = Signal(adr_width), Signal(data_width // 8)
        self.dat_w, self.dat_r = Signal(data_width), Signal(data_width)
        self.cyc, self.stb, self.we, self.ack, self.err = (Signal() for _ in range(5))


class Module:
    """Collects what is added to it, as Migen's does."""

    def __init__(self) -> None:
        raise AssertionError("a module of Migen has no __init__ of its own to call")

    def __new__(cls, *_: Any) -> Module:
        made = super().__new__(cls)
        made.__dict__.update(submodules=SimpleNamespace(), specials=Specials())
        return made

    def __getattr__(self, name: str) -> Any:
        return getattr(self.__dict__["submodules"], name)


class Specials(list[Any]):
    def __iadd__(self, more: Any) -> Specials:  # one, or a list of them
        self.extend(more if isinstance(more, list) else [more])
        return self


class EventManager(SimpleNamespace):
    def finalize(self) -> None:
        assert self.unitylink.trigger.bits == 1


def stand_ins(monkeypatch: pytest.MonkeyPatch) -> None:
    def module(name: str, **members: Any) -> None:
        made = ModuleType(name)
        made.__dict__.update(members)
        monkeypatch.setitem(sys.modules, name, made)

    module(
        "migen",
        Module=Module,
        Cat=Cat,
        ClockSignal=Signal,
        ResetSignal=Signal,
        TSTriple=Pad,
        Instance=lambda top, **ports: SimpleNamespace(top=top, ports=ports),
    )
    module("litex")
    module("litex.soc")
    module("litex.soc.interconnect", wishbone=SimpleNamespace(Interface=Interface))
    module("litex.soc.interconnect.csr", AutoCSR=object)
    module(
        "litex.soc.interconnect.csr_eventmanager",
        EventManager=EventManager,
        EventSourceLevel=lambda: SimpleNamespace(trigger=Signal()),
    )


def test_every_port_of_the_design_is_connected(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    stand_ins(monkeypatch)
    spec = importlib.util.spec_from_file_location("unitylink_module", MODULE)
    assert spec is not None and spec.loader is not None
    code = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(code)
    added: list[str] = []
    platform = SimpleNamespace(output_dir=str(tmp_path), add_source=added.append)
    made = code.UnityLinkSlaves(platform, [f"pin{number}" for number in range(8)])
    (verilog,) = added
    ports = ports_of(Path(verilog).read_text(encoding="utf-8"), "litex_registers")
    *pads, instance = made.specials
    assert [pin for pin, _ in pads] == [f"pin{number}" for number in range(8)]
    assert instance.top == "litex_registers"
    wanted = {f"{'i' if port.is_input else 'o'}_{port.name}": port.bits for port in ports}
    assert {name: signal.bits for name, signal in instance.ports.items()} == wanted
    assert instance.ports["i_adr"] is made.bus.adr and instance.ports["o_dat_r"] is made.bus.dat_r
    assert instance.ports["o_interrupt"] is made.ev.unitylink.trigger


@pytest.mark.long
def test_the_slaves_answer_in_litex(tmp_path: Path) -> None:
    """LiteX's released package makes a SoC with our slaves, and Verilator runs it. It needs a network."""
    python = environment(Run(quick=True, checkout=ROOT, say=print))
    soc = [str(python), str(MODULE.with_name("simulated_soc.py")), str(tmp_path / "soc")]
    files = [str(BENCH), "gateware/soc.v", "litex_registers.v"]
    for command, folder in (
        (soc, tmp_path),
        ([*VERILATOR, "--top-module", BENCH.stem, "-Mdir", "made", "-o", "bench", *files], tmp_path / "soc"),
        (["../made/bench"], tmp_path / "soc" / "gateware"),
    ):
        path = {**os.environ, "PYTHONPATH": str(ROOT / "src")}
        done = subprocess.run(command, cwd=folder, env=path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, (done.stdout + done.stderr)[-3000:]
    assert "litex_bench: passed" in done.stdout
    rows = csv.reader((tmp_path / "soc" / "csr.csv").read_text("utf-8").splitlines())
    places = {row[1]: int(row[2], 16) for row in rows if row and row[0] == "csr_register"}
    text = BENCH.read_text("utf-8").replace("_", "").upper()
    for name in ("unitylink_ev_pending", "unitylink_ev_enable"):
        assert f"{places[name]:08X}" in text, f"the bench looks for {name} elsewhere"
