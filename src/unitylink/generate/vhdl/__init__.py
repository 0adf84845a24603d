# SPDX-License-Identifier: BSD-3-Clause
"""A complete gateware design from a spec, in vendor-independent VHDL-2008."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Union

from unitylink.errors import BindingError
from unitylink.interface.board_configuration import BoardConfiguration
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
Chosen = Union[BoardConfiguration, Mapping[str, Any], None]  # of gateware: all of it, or what differs
_PARTS = ("config_pkg.vhd", "user_pkg.vhd", "design.vhd", "top.vhd", "build.sh")


def generate_vhdl(spec: Spec, configuration: Chosen = None) -> dict[str, str]:
    """Return {file name: text} of a spec's design: packages, design on byte streams, top level with a UART.

    Where the spec has several links there is a design for each of its boards (`Spec.boards`). `configuration`
    is the gateware of the design, or the fields that differ from those of the spec. Raises BindingError for
    one that only a virtual board can have.
    """
    boards = spec.boards
    if len(boards) > 1 and isinstance(configuration, BoardConfiguration):
        raise BindingError(f"vhdl: {spec.source} has {len(boards)} boards, and one configuration is given")
    files: dict[str, str] = {}
    for board in boards:
        if not isinstance(configuration, BoardConfiguration):
            chosen = BoardConfiguration.for_spec(board, **(configuration or {}))
        else:
            chosen = configuration
        design = plan(board, chosen)
        made = {f"{FOLDER}/{design.name}_{part}": _text(part, design) for part in _PARTS}
        if files.keys() & made.keys():
            raise BindingError(
                f"vhdl: two boards of {spec.source} are both {design.name} in VHDL; "
                "rename one, or generate them into folders of their own with --root"
            )
        files |= made
    return files


def _text(part: str, design: Plan) -> str:
    return environment(_HERE).get_template(f"{part}.jinja").render(plan=design)


def design_name(spec: Spec) -> str:
    """Return the beginning of the names of the generated entities: `scara` of `scara_design`, `scara_top`."""
    return identifier(spec.name)


def component_ports(spec: Spec) -> dict[str, str]:
    """Return the ports of `NAME_top` that are pins of components: {port: entity of the component}."""
    design = plan(spec)
    pins = {port.name for port in design.pins}
    return {port: part.entity for part in design.components for _, port in part.pins if port in pins}
