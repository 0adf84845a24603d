# SPDX-License-Identifier: BSD-3-Clause
"""In every design, each signal that enters a clock domain passes a register that is made for this."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from functools import cache
from pathlib import Path

import pytest

from tests.gateware.crossings import Netlist, Register
from tests.gateware.random_robots import component_folders, robot_of
from unitylink import generate
from unitylink.boards.logic import Wanted, design_sources, logic_of
from unitylink.gateware import gateware_folder, gateware_sources, netlist
from unitylink.generate import SpecPlan, generate_vhdl, planned_files, write_files
from unitylink.generate.vhdl import design_name
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.spec import compile_text, load

pytestmark = pytest.mark.xdist_group("crossings")  # they share the designs

SPEC = "public small() { @x = 0x7: READ(); @y = 0x8: WRITE(); }"
FT245 = ("rxf_n", "txe_n", "data_in")


@dataclass(frozen=True)
class Bounds:
    """Which signals from outside are synchronous to which clock, by the beginnings of their names."""

    synchronous: Mapping[str, tuple[str, ...]] = field(default_factory=dict)  # clock -> beginnings
    cleared: tuple[str, ...] = ("reset_over",)  # registers

    def foreign(self, register: Register) -> set[tuple[str, str]]:
        own = {("clock", register.clock)}
        with_it = self.synchronous.get(register.clock, ())
        return {
            (kind, name)
            for kind, name in (register.data | register.choice | register.clears) - own
            if not (kind == "pin" and name.startswith(with_it))
        }

    def wrong(self, register: Register) -> str:
        """Return what is wrong with the way in which `register` takes signals of another domain, or ""."""
        foreign = self.foreign(register)
        leaves = {name.rpartition(".")[2] for name in register.names}
        if not foreign:
            return ""
        if foreign & register.clears:
            return "" if leaves & set(self.cleared) else f"is cleared by {sorted(foreign & register.clears)}"
        if foreign & register.choice:
            return f"takes its data when {sorted(foreign & register.choice)} says so"
        if any(name.endswith("synchroniser.first") for name in register.names):
            return "" if register.direct and len(foreign) == 1 else f"is behind logic of {sorted(foreign)}"
        return "" if any(leaf.endswith("_crossed") for leaf in leaves) else f"takes {sorted(foreign)}"


TOP = {"clock": ("to_pc", "events")}  # for a generated top level: the signals of the user's logic
LAYERS = {
    "uart": Bounds(TOP),
    "rs485": Bounds(TOP),
    "spi": Bounds({**TOP, "spi_sck": ("spi_mosi",)}, ("reset_over", "place")),
    "ft245_async": Bounds(TOP),
    "ft245_sync": Bounds({**TOP, "ft245_clkout": tuple(f"ft245_{name}" for name in FT245)}),
}


def complaints(registers: Netlist, bounds: Bounds) -> list[str]:
    told = {
        f"{min(register.names, key=len)} at {register.clock} {wrong}"
        for register in registers.registers
        if (wrong := bounds.wrong(register))
    }
    return sorted(told)


@cache
def design(physical: str) -> Netlist:
    """The smallest design with this physical layer."""
    with tempfile.TemporaryDirectory() as folder:
        return make_design(Path(folder), physical)


def make_design(folder: Path, physical: str) -> Netlist:
    spec = compile_text(SPEC, "small.ul").spec
    assert spec is not None
    protocol = "framed" if physical == "rs485" else "classic"  # the smallest
    configuration = BoardConfiguration.for_spec(spec, physical=physical, protocol=protocol, publish_mode=0)
    top, sources = f"{design_name(spec)}_top", []
    for name, text in generate_vhdl(spec, configuration).items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
        sources += [folder / name] if name.endswith(".vhd") else []
    return Netlist(netlist(top, sources=sources, assertions=False), top, folder)


def test_every_synchroniser_has_the_name_that_constraints_look_for() -> None:
    texts = [*gateware_sources(), *Path(generate.__file__).parent.glob("vhdl/*.jinja")]
    labels = {
        label
        for path in texts
        for label in re.findall(r"(\w+) *: *entity \w+\.synchroniser\b", path.read_text(encoding="utf-8"))
    }
    assert len(labels) > 10
    assert not {label for label in labels if not label.endswith("synchroniser")}


def test_a_bus_between_two_clocks_takes_nothing_unsynchronised(tmp_path: Path) -> None:
    verilog = netlist("wishbone_crossing", assertions=False)
    sides = {f"{side}_clock": (f"{side}_m2s", f"{side}_s2m", f"{side}_reset") for side in ("master", "slave")}
    found = Netlist(verilog, "wishbone_crossing", tmp_path)
    assert not complaints(found, Bounds(sides))
    assert any(Bounds(sides).foreign(register) for register in found.registers)


@pytest.mark.parametrize("physical", LAYERS)
def test_a_design_takes_nothing_unsynchronised(physical: str) -> None:
    found = design(physical)
    assert not complaints(found, LAYERS[physical])
    kinds = {name.rpartition(".")[2] for register in found.registers for name in register.names}
    assert {"first", "reset_over"} <= kinds


def board_of(text: str, folder: Path) -> Netlist:
    """The design that `unitylink build` makes of a spec: its words and components are on pins."""
    (folder / "robot.ul").write_text(text, encoding="utf-8")
    order = Wanted(spec_file=str(folder / "robot.ul"), folder=folder)
    plan = SpecPlan(load(order.spec_file), {"protocol": "classic", "publish_mode": 0})
    write_files(planned_files(plan, ["vhdl"]), folder)
    made = logic_of(plan, order)
    sources = [*design_sources(plan.spec, folder), *made.sources]
    return Netlist(netlist(made.top, sources=sources, assertions=False), made.top, folder)


def test_words_on_pins_pass_a_synchroniser(tmp_path: Path) -> None:
    found = board_of(
        "public panel() { @keys = 0x0: u4 READ(); @button = 0x1: bool READ(); @led = 0x2: WRITE();"
        " pad: gpio(pins=2); wheel: quadrature_encoder(with_index=1); }",
        tmp_path,
    )
    assert not complaints(found, Bounds())
    pins = {name for register in found.registers for _, name in Bounds().foreign(register)}
    assert {"keys", "button", "pad_pin_in", "wheel_a", "wheel_b", "wheel_index", "rx_line", "reset"} <= pins


@pytest.mark.long
def test_pins_of_every_component_pass_a_synchroniser(tmp_path: Path) -> None:
    found = board_of(f"link robot (ADDRESS=16);\n{robot_of(component_folders(), ())}", tmp_path)
    assert not complaints(found, Bounds())
    pins = {name for register in found.registers for _, name in Bounds().foreign(register)}
    passed_over = found.inputs - pins - {"clock"}
    assert all(name.endswith(("_index", "_gate")) for name in passed_over)  # the examples leave them out


CONSTRAINTS = gateware_folder() / "constraints"
VIVADO = re.compile(r"NAME =~ (\*[^\s/]*/?\w+)_reg\*(/CLR)?")
QUARTUS = re.compile(r"(\*[\w|*]*?\w+)\[\*\](\|clrn)?(?=[\s}])")


def crossings() -> set[tuple[str, bool]]:
    """Return the path of each register that takes a signal of another domain, and whether it is cleared."""
    return {
        (name.replace(".", "/"), bool(bounds.foreign(register) & register.clears))
        for physical, bounds in LAYERS.items()
        for register in design(physical).registers
        if bounds.foreign(register)
        for name in register.names
        if name.rpartition(".")[2] in ("first", "place", "reset_over") or name.endswith("_crossed")
    }


def test_each_crossing_has_its_constraint_and_each_constraint_its_crossing() -> None:
    crossing = crossings()
    for file, form in (("crossings.xdc", VIVADO), ("crossings.sdc", QUARTUS)):
        found = form.findall((CONSTRAINTS / file).read_text(encoding="utf-8"))
        patterns = [(pattern.replace("|", "/"), bool(clear)) for pattern, clear in found]
        assert len(patterns) == 4
        bound = {
            pattern: {
                name for name, clears in crossing if clears == clear and fnmatchcase("/" + name, pattern)
            }
            for pattern, clear in patterns
        }
        assert all(bound.values()), [pattern for pattern, names in bound.items() if not names]
        assert set().union(*bound.values()) == {name for name, _ in crossing}


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("if rising_edge(clock) then taken <= pin; end if;", "taken at clock takes [('pin', 'pin')]"),
        (
            "if rising_edge(clock) then if pin = '1' then own <= not own; end if; end if;",
            "own at clock takes",
        ),
        ("if rising_edge(other) then taken <= kept; end if;", "taken at other takes [('clock', 'clock')]"),
        (
            "if rising_edge(clock) then first <= pin and kept; end if;",
            "first at clock takes [('pin', 'pin')]",
        ),
        (
            "if pin = '1' then taken <= '0'; elsif rising_edge(clock) then taken <= kept; end if;",
            "taken at clock is cleared by [('pin', 'pin')]",
        ),
    ],
)
def test_what_is_not_synchronised_is_found(tmp_path: Path, text: str, what: str) -> None:
    source = tmp_path / "careless.vhd"
    source.write_text(CARELESS.format(text), encoding="ascii")
    found = Netlist(netlist("careless", sources=[source], assertions=False), "careless", tmp_path)
    assert any(what in each for each in complaints(found, Bounds({"clock": ("data",)})))


CARELESS = """
library ieee; use ieee.std_logic_1164.all;
entity careless is
  port (clock, other, pin, data : in std_ulogic; kept, own, taken, first : buffer std_ulogic := '0');
end entity;
architecture rtl of careless is
begin
  keep : process (clock) is begin
    if rising_edge(clock) then kept <= data; end if;
  end process;
  wrong : process (clock, other, pin) is begin
    {}
  end process;
end architecture;
"""
