# SPDX-License-Identifier: BSD-3-Clause
"""Where the VHDL is: that of the gateware, and that of the components.

A component has all its files in one folder. The end of a name says what is no logic: a bench (`_tb`), a
model of what is outside (`_model`) or properties (`_formal`).
"""

from __future__ import annotations

from pathlib import Path

from unitylink.resources import resource_folder

_BENCHES = ("_tb", "_model")
_PROPERTIES = "_formal"


def gateware_folder() -> Path:
    """Return the folder that holds core.vhd. Raise ToolError when this installation came without it."""
    return resource_folder("gateware")


def gateware_sources() -> tuple[Path, ...]:
    """Return every VHDL file that can become logic, by folder and name. GHDL finds the order itself.

    These are the files of the gateware and those of the components.
    """
    folder = gateware_folder()
    own = (
        path
        for path in sorted(folder.rglob("*.vhd"))
        if path.relative_to(folder).parts[0] not in ("simulation", "test", "formal")
    )
    return (*own, *(path for path in _of_components() if not path.stem.endswith((*_BENCHES, _PROPERTIES))))


def simulation_sources() -> tuple[Path, ...]:
    """Return the VHDL files that benches of users stand on: the PC's side in a simulation."""
    return tuple(sorted((gateware_folder() / "simulation").glob("*.vhd")))


def bench_sources() -> tuple[Path, ...]:
    """Return the benches of gateware and components, and what they stand on. Only a checkout has them."""
    own = sorted((gateware_folder() / "test").glob("*.vhd"))
    return (*own, *(path for path in _of_components() if path.stem.endswith(_BENCHES)))


def property_sources() -> tuple[Path, ...]:
    """Return the VHDL files of the properties to prove. Only a checkout has them."""
    own = sorted((gateware_folder() / "formal").glob("*.vhd"))
    return (*own, *(path for path in _of_components() if path.stem.endswith(_PROPERTIES)))


def every_source() -> tuple[Path, ...]:
    """Return all VHDL files of this installation: logic, benches and properties."""
    return (*gateware_sources(), *simulation_sources(), *bench_sources(), *property_sources())


def _of_components() -> list[Path]:
    return sorted(resource_folder("components").glob("*/*.vhd"))
