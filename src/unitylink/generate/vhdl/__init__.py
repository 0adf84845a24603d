# SPDX-License-Identifier: BSD-3-Clause
"""A complete gateware design from a spec, in vendor-independent VHDL-2008."""

from __future__ import annotations

from pathlib import Path

from unitylink.errors import BindingError
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.spec.model import Spec

from ..spec_plan import SpecPlan
from ..templates import environment
from .names import identifier
from .own_sources import own_source_files, own_source_names
from .plan import Plan
from .planner import RING_CUT, plan_design
from .records import Leaf
from .words import WordMap, word_map

__all__ = [
    "RING_CUT",
    "Leaf",
    "Plan",
    "WordMap",
    "component_ports",
    "design_file_names",
    "design_name",
    "own_source_names",
    "plan_design",
    "plan_designs",
    "vhdl_files",
    "word_map",
]

FOLDER = "vhdl"
_HERE = Path(__file__).parent
_PARTS = ("config_pkg.vhd", "user_pkg.vhd", "design.vhd", "top.vhd", "build.sh")


def vhdl_files(plan: SpecPlan) -> dict[str, str]:
    """Return {file name: text} of a spec's design: packages, design on byte streams, top level with a UART.

    If the spec has several links, there is a design for each of its boards (`Spec.boards`). Raises
    BindingError for gateware that only a virtual board can have.
    """
    files: dict[str, str] = {}
    for board, design in zip(plan.spec.boards, plan.part(plan_designs), strict=True):
        made = dict(
            zip(design_file_names(design.name), (_text(part, design) for part in _PARTS), strict=True)
        )
        made |= _node_files(design)
        made |= {f"{FOLDER}/{name}": text for name, text in own_source_files(design.name, board).items()}
        if files.keys() & made.keys():
            raise BindingError(
                f"vhdl: two boards of {plan.spec.source} are both {design.name} in VHDL; "
                "rename one, or generate them into folders of their own with --root"
            )
        files |= made
    return files


def plan_designs(plan: SpecPlan) -> list[Plan]:
    """Plan the design of each board."""
    boards, chosen = plan.spec.boards, plan.configuration
    if len(boards) > 1 and isinstance(chosen, BoardConfiguration):
        several = f"{plan.spec.source} has {len(boards)} boards"
        raise BindingError(f"vhdl: {several}, but only one configuration is given")
    if isinstance(chosen, BoardConfiguration):
        return [plan_design(boards[0], chosen)]
    return [plan_design(board, BoardConfiguration.for_spec(board, **(chosen or {}))) for board in boards]


def design_file_names(name: str) -> list[str]:
    """Return the names of the generated files of a design. `name` is the beginning of its names.

    See `design_name`. The copies of a user's VHDL (`own_source_names`) are not among them.
    """
    return [f"{FOLDER}/{name}_{part}" for part in _PARTS]


def _text(part: str, design: Plan) -> str:
    return environment(_HERE).get_template(f"{part}.jinja").render(plan=design)


def _node_files(design: Plan) -> dict[str, str]:
    """Return the entities of the other nodes of a TosNet that has a ring."""
    template = environment(_HERE).get_template("node.vhd.jinja")
    nodes = design.tosnet.ring if design.tosnet else ()
    return {
        f"{FOLDER}/{design.name}_node_{node.id}.vhd": template.render(plan=design, node=node)
        for node in nodes
    }


def design_name(spec: Spec) -> str:
    """Return the beginning of the names of the generated entities: `scara` for `scara_design` and
    `scara_top`.
    """
    return identifier(spec.name)


def component_ports(design: Plan) -> dict[str, str]:
    """Return the ports of `NAME_top` that are pins of components: {port: entity of the component}."""
    pins = {port.name for port in design.pins}
    return {port: part.entity for part in design.components for _, port in part.pins if port in pins}
