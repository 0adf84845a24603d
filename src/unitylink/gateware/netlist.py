# SPDX-License-Identifier: BSD-3-Clause
"""The Verilog netlist of an entity: GHDL's, mended."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from unitylink.errors import ToolError

from .ghdl import Generic, Ghdl
from .library import DesignGhdl, ModuleNames
from .repairs import repaired
from .sources import gateware_sources


def netlist(
    top: str,
    *,
    sources: Sequence[Path] = (),
    generics: Mapping[str, Generic] | None = None,
    assertions: bool = True,
) -> str:
    """Return the netlist of the entity `top`, as Verilog for Verilator and yosys.

    `top` is an entity of the gateware, or of `sources`. These are analysed into the library `work`, and the
    gateware into `unitylink`. Then its entity `fifo` is the module `unitylink_fifo`, because a netlist has no
    libraries. `generics` override those of `top`. A top level has ports of named types only: no
    unconstrained arrays, none of width 0. A record, as the
    generic of the core is, cannot be overridden: instantiate it in a source of your own. `assertions` of the
    VHDL become calls of $fatal, which simulators know and yosys does not. Raises ToolError.

        netlist("fifo_slave", generics={"depth": 64}, assertions=False)
    """
    with tempfile.TemporaryDirectory(prefix="unitylink-netlist-") as folder:
        work = Path(folder)
        if not sources:
            return _printed(Ghdl(work, gateware_sources()), top, generics, assertions)
        names = ModuleNames(work)
        try:
            own = names.of_user([path.resolve() for path in sources])
            return _printed(DesignGhdl(work, names.of_gateware(), own), top, generics, assertions)
        except ToolError as error:
            raise ToolError(names.original(str(error))) from None


def _printed(ghdl: Ghdl, top: str, generics: Mapping[str, Generic] | None, assertions: bool) -> str:
    verilog, vhdl = (
        ghdl.synthesise(top, language, generics, assertions=assertions) for language in ("verilog", "vhdl")
    )
    return repaired(verilog, vhdl)
