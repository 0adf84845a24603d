# SPDX-License-Identifier: BSD-3-Clause
"""Projects for the tools of vendors: a script that makes the project, and its constraints."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from unitylink.errors import BoardError
from unitylink.gateware import LIBRARY, Port, gateware_sources, netlist, ports_of
from unitylink.generate import SpecPlan, planned_files, write_files
from unitylink.generate.quoting import Tcl
from unitylink.interface.board_configuration import BoardConfiguration, told_physical
from unitylink.interface.engine import too_fast
from unitylink.spec.model import LINES

from .folder import make_folder
from .lattice import diamond, icestorm, radiant, trellis
from .line import check_line, told_baud_hz
from .logic import Wanted, design_sources, logic_of, spec_of
from .pin_timing import pin_constraints
from .pins import CLOCKS
from .project import Project, crossings, tcl_text
from .two_way import pin_ports, with_pins

BAUD_HZ = 1_000_000  # used if neither the spec nor the user gives one


@dataclass(frozen=True, kw_only=True)
class VendorOrder(Wanted):
    """A project to write for the tool `vendor`, one of VENDORS.

    `pins` has the form PORT=SITE or PORT[3]=SITE, with sites of the chip. The user fills in all others.
    `clock_hz` is the frequency at the clock's pin.
    """

    vendor: str
    part: str
    clock_hz: int
    baud_hz: int | None = None


def write_project(order: VendorOrder) -> list[Path]:
    """Write the generated VHDL, the project script and the constraints.

    Return the paths of the script and the constraints.

    Raises BoardError for an unknown vendor or port.
    """
    if order.vendor not in VENDORS:
        raise BoardError(f"vendor:{order.vendor} is not known; there are: vendor:{', vendor:'.join(VENDORS)}")
    spec = spec_of(order)
    make_folder(order.folder)
    clock_hz, baud_hz = order.clock_hz, order.baud_hz or told_baud_hz(spec) or BAUD_HZ
    check_line(clock_hz, baud_hz)
    given: dict[str, Any] = {"clock_hz": clock_hz}
    given |= {"protocol": order.protocol} if order.protocol else {}
    physical = order.settings.get("physical") or told_physical(spec) or LINES[0]
    given |= {"baud_hz": baud_hz} if physical in LINES else {}
    configuration = BoardConfiguration.for_spec(spec, **{**given, **order.settings})
    if wrong := too_fast(configuration):
        raise BoardError(f"vendor:{order.vendor}: {wrong}")
    plan = SpecPlan(spec, configuration)
    write_files(planned_files(plan, ["vhdl"]), order.folder)
    logic = logic_of(plan, order)
    generics = {
        name: value
        for name, value in (("baud_hz", baud_hz), ("clock_hz", clock_hz))
        if name in logic.generics
    }
    own = [*design_sources(spec, order.folder), *logic.sources]
    printed = netlist(logic.top, sources=own, generics=generics, assertions=False)
    ports = ports_of(printed, logic.top)
    clock = next((port.name for port in ports if port.name in CLOCKS), None)
    if clock is None:
        raise BoardError(f"{logic.top} needs a port for the clock, called {' or '.join(CLOCKS)}")
    pins = pin_ports(ports)
    top, verilog = logic.top, []
    if order.vendor in OPEN_TOOLS:
        generics = {}
        verilog.append(_written(order.folder / f"{spec.name}_netlist.v", printed))
    if text := with_pins(top, ports, generics):
        top, generics = f"{logic.top}_pins", {}
        verilog.append(_written(order.folder / f"{top}.v", text))
    project = Project(
        spec.name,
        top,
        order.part,
        clock_hz,
        baud_hz,
        generics,
        (
            *((LIBRARY, path.resolve()) for path in gateware_sources()),
            *(("work", path.resolve()) for path in own),
        ),
        tuple(verilog),
        _sites(pins, order.pins),
        pins,
        clock,
        configuration.physical,
    )
    made = []
    for ending, text in VENDORS[order.vendor](project).items():
        path = order.folder / f"{spec.name}{ending}"
        path.write_text(text, encoding="utf-8")
        made.append(path)
    return made


def _written(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path.resolve()


def _sites(ports: Sequence[Port], wishes: Sequence[str]) -> dict[str, str]:
    bits = {f"{p.name}[{n}]" if p.bits > 1 else p.name: "" for p in ports for n in range(p.bits)}
    for wish in wishes:
        name, _, site = wish.partition("=")
        if name not in bits or not re.fullmatch(r"[A-Za-z0-9_]+", site):
            raise BoardError(f"--pin {wish}: write PORT=SITE with one of {', '.join(bits)}")
        bits[name] = site
    return bits


def _vivado(project: Project) -> dict[str, str]:
    part, top = Tcl.text(project.part), project.top
    given = Tcl(" ").join(Tcl.of("{}={}", name, value) for name, value in project.generics.items())
    generics = Tcl.of(" -generic {{{}}}", given) if given else Tcl("")
    script = [
        Tcl.of(
            "# vivado -mode batch -source {}.tcl: makes the project and builds {}.bit.", project.name, top
        ),
        Tcl.of("create_project -force {} vivado -part {}", project.name, part),
        *(
            Tcl.of("read_vhdl -vhdl2008 -library {} {}", library, Tcl.text(str(path)))
            for library, path in project.sources
        ),
        *(Tcl.of("read_verilog {}", Tcl.text(str(path))) for path in project.verilog),
        Tcl.of("read_xdc {}.xdc", project.name),
        Tcl.of("set_property top {} [current_fileset]", top),
        *([Tcl.of("set_property generic {{{}}} [current_fileset]", given)] if given else []),
        Tcl.of("synth_design -top {} -part {}{}", top, part, generics),
        Tcl.of("read_xdc -unmanaged {}", Tcl.text(str(crossings("xdc")))),
        Tcl("opt_design"),
        Tcl("place_design"),
        Tcl("route_design"),
        Tcl("report_utilization -file utilization.txt"),
        Tcl("report_timing_summary -file timing.txt"),
        Tcl(
            "if {[get_property SLACK [get_timing_paths]] < 0} { error {too slow for its clock: timing.txt} }"
        ),
        Tcl.of("write_bitstream -force {}.bit", top),
    ]
    constraints = [
        *_timing(project, datapath_only=True),
        Tcl("# Fill in PACKAGE_PIN from the board's documents, and the voltage; then take the # away."),
    ]
    for bit, site in project.pins.items():
        line = Tcl.of(
            "set_property -dict {{PACKAGE_PIN {} IOSTANDARD LVCMOS33}} [get_ports {}]",
            site or "SITE",
            Tcl.text(bit),
        )
        constraints.append(line if site else Tcl.of("# {}", line))
    return {".tcl": tcl_text(script), ".xdc": tcl_text(constraints)}


def _quartus(project: Project) -> dict[str, str]:
    script = [
        Tcl.of("# quartus_sh -t {}.tcl: makes the project and builds it.", project.name),
        Tcl("load_package flow"),
        Tcl.of("project_new -overwrite {}", project.name),
        Tcl.of("set_global_assignment -name DEVICE {}", Tcl.text(project.part)),
        Tcl.of("set_global_assignment -name TOP_LEVEL_ENTITY {}", project.top),
        Tcl("set_global_assignment -name VHDL_INPUT_VERSION VHDL_2008"),
        *(
            Tcl.of("set_global_assignment -name VHDL_FILE {} -library {}", Tcl.text(str(path)), library)
            for library, path in project.sources
        ),
        *(
            Tcl.of("set_global_assignment -name VERILOG_FILE {}", Tcl.text(str(path)))
            for path in project.verilog
        ),
        Tcl.of("set_global_assignment -name SDC_FILE {}.sdc", project.name),
        Tcl.of("set_global_assignment -name SDC_FILE {}", Tcl.text(str(crossings("sdc")))),
        *(Tcl.of("set_parameter -name {} {}", name, value) for name, value in project.generics.items()),
        Tcl("# Fill in the pins from the board's documents, then take the # away."),
    ]
    for bit, site in project.pins.items():
        line = Tcl.of("set_location_assignment PIN_{} -to {}", site or "SITE", Tcl.text(bit))
        script.append(line if site else Tcl.of("# {}", line))
    script += [Tcl("execute_flow -compile"), Tcl("project_close")]
    timing = [*_timing(project, datapath_only=False), Tcl("derive_clock_uncertainty")]
    return {".tcl": tcl_text(script), ".sdc": tcl_text(timing)}


def _timing(project: Project, *, datapath_only: bool) -> list[Tcl]:
    return pin_constraints(
        project.ports, project.clock, project.clock_hz, project.physical, datapath_only=datapath_only
    )


VENDORS: Mapping[str, Callable[[Project], dict[str, str]]] = {
    "vivado": _vivado,
    "quartus": _quartus,
    "diamond": diamond,
    "radiant": radiant,
    "icestorm": icestorm,
    "trellis": trellis,
}
OPEN_TOOLS = ("icestorm", "trellis")  # they take a netlist, in which the generics have their values
