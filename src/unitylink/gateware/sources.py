# SPDX-License-Identifier: BSD-3-Clause
"""Where the VHDL of the gateware is."""

from __future__ import annotations

from pathlib import Path

from unitylink.resources import resource_folder


def gateware_folder() -> Path:
    """Return the folder that holds core.vhd. Raise ToolError when this installation came without it."""
    return resource_folder("gateware")


def gateware_sources() -> tuple[Path, ...]:
    """Return every VHDL file of the gateware that can become logic, by name. GHDL finds the order itself."""
    folder = gateware_folder()
    return tuple(
        path
        for path in sorted(folder.rglob("*.vhd"))
        if path.relative_to(folder).parts[0] not in ("simulation", "test", "formal")
    )


def simulation_sources() -> tuple[Path, ...]:
    """Return the VHDL files that benches of users stand on: the PC's side in a simulation."""
    return tuple(sorted((gateware_folder() / "simulation").glob("*.vhd")))
