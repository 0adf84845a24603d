# SPDX-License-Identifier: BSD-3-Clause
"""The gateware as a folder of its own: the VHDL library, and its list of files for each tool."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from .dependencies import in_order
from .library import LIBRARY
from .sources import gateware_folder, gateware_sources, simulation_sources

CORE = f"{LIBRARY}::gateware"  # how FuseSoC calls the library: vendor, library and name, without the version
_LICENCE = "SPDX-License-Identifier: BSD-3-Clause"
_MADE = "Made by `unitylink gateware --export`"
_VUNIT = '''# {licence}
# {made}.
"""The library `unitylink` for VUnit: `add_unitylink(vu)`, where `vu` is what VUnit.from_argv returns."""

from pathlib import Path

HERE = Path(__file__).resolve().parent
FILES = [
{files}
]


def add_unitylink(vunit):
    """Add the library with all its files. VUnit finds their order. Return the library."""
    library = vunit.add_library("{library}")
    for name in FILES:
        library.add_source_file(HERE / name, vhdl_standard="2008")
    return library
'''


def export_gateware(version: str) -> dict[str, bytes]:
    """Return {file name: contents} of the exported library.

    It has the VHDL that can become logic, the PC's side for benches, the constraints of all crossings, and
    the lists. `version` is that of the package.
    """
    base = gateware_folder().parent
    logic = in_order(gateware_sources())
    benches = [path for path in in_order([*gateware_sources(), *simulation_sources()]) if path not in logic]
    constraints = sorted((gateware_folder() / "constraints").glob("crossings.*"))
    names = {path: f"hdl/{path.relative_to(base)}" for path in (*logic, *benches)}
    files = {name: path.read_bytes() for path, name in names.items()}
    files |= {f"constraints/{path.name}": path.read_bytes() for path in constraints}
    of_logic, of_benches = ([names[path] for path in paths] for paths in (logic, benches))
    lists = {
        "unitylink.core": _fusesoc(version, of_logic, of_benches),
        "library.txt": "".join(f"{LIBRARY} {name}\n" for name in (*of_logic, *of_benches)),
        "vunit_unitylink.py": _VUNIT.format(
            licence=_LICENCE,
            made=_MADE,
            library=LIBRARY,
            files="\n".join(f'    "{name}",' for name in (*of_logic, *of_benches)),
        ),
        **{name: make(of_logic) for name, make in _SCRIPTS.items()},
    }
    return files | {name: text.encode() for name, text in lists.items()}


def design_core(name: str, version: str, sources: Sequence[str], spec: str) -> str:
    """Return the core file of FuseSoC for the design `name`, whose VHDL files are `sources`.

    `spec` is the name of the spec's file, in quotes as YAML has them.
    """
    return f"""CAPI=2:
# {_LICENCE}
# {_MADE}. What is changed here is lost.
name: ::{name}:0
description: {spec}
filesets:
  rtl:
    depend: ["{CORE}:{version}"]
    file_type: vhdlSource-2008
    files:
{_items(sources)}
targets:
  default: &default
    filesets: [rtl]
    toplevel: {name}_top
  ghdl:
    <<: *default
    description: GHDL analyses and elaborates the design
    flow: sim
    flow_options:
      tool: ghdl
      sim_options: [--no-run]
"""


def _fusesoc(version: str, logic: Sequence[str], benches: Sequence[str]) -> str:
    def fileset(name: str, files: Sequence[str]) -> str:
        head = f"  {name}:\n    logical_name: {LIBRARY}\n    file_type: vhdlSource-2008\n    files:\n"
        return head + _items(files)

    return f"""CAPI=2:
# {_LICENCE}
# {_MADE}. What is changed here is lost.
name: {CORE}:{version}
description: The gateware of Unity-Link, as the VHDL library {LIBRARY}
filesets:
{fileset("rtl", logic)}
{fileset("simulation", benches)}
targets:
  default:
    filesets: [rtl]
  sim:
    filesets: [rtl, simulation]
"""


def _items(names: Sequence[str]) -> str:
    return "\n".join(f"      - {name}" for name in names)


def _script(head: str, line: str, end: str = "") -> Callable[[Sequence[str]], str]:
    """Return what makes a Tcl script with a `line` for each file."""

    def text(names: Sequence[str]) -> str:
        lines = "".join(f"{line.format(name=name, library=LIBRARY)}\n" for name in names)
        return f"# {_LICENCE}\n# {_MADE}. {head}\n{lines}{end}"

    return text


_HERE = "set unitylink_here [file dirname [file normalize [info script]]]"
_SCRIPTS: Mapping[str, Callable[[Sequence[str]], str]] = {
    "vivado.tcl": _script(
        f"Source it in a project of Vivado.\n{_HERE}",
        "read_vhdl -vhdl2008 -library {library} [file join $unitylink_here {name}]",
        "# After synth_design: read_xdc -unmanaged [file join $unitylink_here constraints/crossings.xdc]\n",
    ),
    "quartus.qip": _script(
        "Add it to a project of Quartus, whose VHDL_INPUT_VERSION is VHDL_2008.",
        "set_global_assignment -library {library} -name VHDL_FILE [file join $::quartus(qip_path) {name}]",
        "set_global_assignment -name SDC_FILE [file join $::quartus(qip_path) constraints/crossings.sdc]\n",
    ),
    "diamond.tcl": _script(
        f"Source it in a project of Diamond.\n{_HERE}",
        "prj_src add -work {library} [file join $unitylink_here {name}]",
    ),
    "radiant.tcl": _script(
        f"Source it in a project of Radiant.\n{_HERE}",
        "prj_add_source -work {library} [file join $unitylink_here {name}]",
    ),
    "libero.tcl": _script(
        f"Source it in a project of Libero SoC.\n{_HERE}",
        "create_links -library {library} -hdl_source [file join $unitylink_here {name}]",
    ),
    "gowin.tcl": _script(
        f"Source it in a project of Gowin EDA, with: set_option -vhdl_std vhd2008\n{_HERE}",
        "set unitylink_file [file join $unitylink_here {name}]; add_file -type vhdl $unitylink_file; "
        "set_file_prop -lib {library} $unitylink_file",
    ),
}
