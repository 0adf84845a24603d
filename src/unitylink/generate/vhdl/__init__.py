# SPDX-License-Identifier: BSD-3-Clause
"""A complete gateware design from a spec, in vendor-independent VHDL-2008."""

from __future__ import annotations

from pathlib import Path

from unitylink.board_configuration import BoardConfiguration
from unitylink.spec.model import Spec

from ..templates import environment
from .names import identifier
from .plan import Plan
from .planner import plan
from .records import Leaf
from .words import WordMap, word_map

__all__ = ["Leaf", "Plan", "WordMap", "component_ports", "design_name", "generate_vhdl", "plan", "word_map"]

FOLDER = "vhdl"
_HERE = Path(__file__).parent
_PARTS = ("config_pkg.vhd", "user_pkg.vhd", "design.vhd", "top.vhd", "build.sh")


def generate_vhdl(spec: Spec, configuration: BoardConfiguration | None = None) -> dict[str, str]:
    """Return {file name: text} of a spec's design: packages, design on byte streams, top level with a UART.

    `configuration` is the gateware it is made of, by default what the spec asks for. Raises BindingError for
    one that only a virtual board can have.
    """
    design = plan(spec, configuration)
    return {
        f"{FOLDER}/{design.name}_{part}": environment(_HERE).get_template(f"{part}.jinja").render(plan=design)
        for part in _PARTS
    }


def design_name(spec: Spec) -> str:
    """Return what the names of the generated entities begin with: `scara` of `scara_design`, `scara_top`."""
    return identifier(spec.name)


def component_ports(spec: Spec) -> dict[str, str]:
    """Return the ports of `NAME_top` that are pins of components: {port: entity of the component}."""
    design = plan(spec)
    pins = {port.name for port in design.pins}
    return {port: part.entity for part in design.components for _, port in part.pins if port in pins}
