# SPDX-License-Identifier: BSD-3-Clause
"""Covers that lie too deep for a search with free inputs: each has a guide of its own.

A guide gives values to inputs, and to signals that may have any value. That leaves fewer ways, so a cover
that is reached with a guide is also reached without it. No property is proven with a guide.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

import model as models
from block import Block
from model import Model

from unitylink.errors import ToolError


@dataclass(frozen=True)
class Guide:
    """The way to one cover. Values are expressions of Verilog over signals of the property file."""

    cover: str  # its label
    reach: int  # within so many clocks
    inputs: Mapping[str, str]
    loose: Mapping[str, str]  # a signal of the flat design: another one of it, or a constant


# What all ways of the framed application have in common: nothing stalls, no answer comes from the bus, no
# event comes between the frames, every id is new, a session is open at power-up, and each loop of the
# program ends at once. The reset is short.
_INPUTS = {
    "reset": "!begun",
    "arrives": "1",
    "chained_in": "0",
    "barrier_in": "0",
    "may_begin": "1",
    "receive_overrun": "0",
    "reply_ready": "1",
    "reply_idle": "1",
    "response_done": "0",
    "response_status": "0",
    "response_data": "0",
    "dead_man_running": "0",
    "dead_man_tripped": "0",
    "dead_man_tripped_now": "0",
    "dead_man_uncounted": "0",
}
_LOOSE = {
    "dut.pointer": "dut.number_now",
    "dut.epoch_now": "16'd0",
    "dut.new_id": "1'd1",
    "dut.repeated": "1'd0",
    "dut.turned": "1'd0",
}

_APPLICATION = (
    # A WRITE_CONTROL that arms the dead-man: the last byte of its value is 1.
    Guide(
        "command_is_remembered_case",
        80,
        _INPUTS | {"entry_in": "9", "length_in": "8", "data": "taken == 7"},
        _LOOSE,
    ),
    # A HELLO, and an OPEN after its answer.
    Guide("trips_with_open_case", 90, _INPUTS | {"entry_in": "(kind == 208) ? 17 : 16", "data": "0"}, _LOOSE),
    # A CLOSE.
    Guide(
        "renewed_with_session_case",
        90,
        _INPUTS | {"entry_in": "13", "length_in": "2", "data": "0"},
        _LOOSE,
    ),
)

# The bus answers at once. A LIST that reads two words, and a POST_LIST that writes one.
_LIST = _INPUTS | {
    "response_done": "bii[0]",
    "entry_in": "5",
    "length_in": "7",
    "data": "(taken == 3) ? 1 : (taken == 4) ? 2 : 0",
}
_POST_LIST = _LIST | {"entry_in": "6", "length_in": "6", "data": "(taken == 2) ? 17 : (taken == 3) ? 1 : 0"}

_AGAIN = _LOOSE | {"dut.new_id": "1'd0", "dut.repeated": "1'd1"}

# A READ behind a barrier: its id is judged with its form, and again before the access.
_BARRIER = _INPUTS | {"barrier_in": "1", "entry_in": "2", "length_in": "5", "data": "0"}

GUIDES: Mapping[str, tuple[Guide, ...]] = {
    "frame_application": _APPLICATION,
    "frame_application_lists": (
        *_APPLICATION,
        Guide("judged_twice_most_case", 120, _BARRIER, _LOOSE),
        Guide("opens_what_is_next_case", 240, _LIST, _LOOSE),
        Guide("list_ends_case", 240, _LIST, _LOOSE),
        Guide("several_seen", 240, _LIST, _LOOSE),
        Guide("again_seen", 240, _LIST, _AGAIN),
        Guide("post_list_ends_case", 240, _POST_LIST, _LOOSE),
    ),
}


def left(block: Block, model: Model) -> Model:
    """Return the model without the covers that have a guide of their own. It is for `unreachable`."""
    guides = GUIDES.get(block.name, ())
    if not guides:
        return model
    labels = "|".join(guide.cover for guide in guides)
    source = model.smt2.with_name("left.v")
    source.write_text(re.sub(rf"(?m)^.*\b({labels}): cover\(.*$", "", _verilog(model)), encoding="utf-8")
    return replace(model, smt2=source.with_suffix(".smt2"))


def guided(block: Block, model: Model, guide: Guide) -> Model:
    """Return a model that asserts only that the cover of `guide` is never reached, on its way."""
    verilog = re.sub(r"(?m)^.*\bassert\(.*$", "", _verilog(model))
    verilog = re.sub(rf"(?m)^(.*\b{guide.cover}: )cover\(", r"\1assert(!", verilog)
    verilog = re.sub(r"(?m)^.*\bcover\(.*$", "", verilog)
    before, top, after = verilog.partition(f"module {block.top}\n")
    wires, given = [], dict(block.given)
    for port, value in guide.inputs.items():
        found = re.search(rf"input +(\[\d+:0\] +)?{port}\b,\s*", after)
        if found is None:
            raise ToolError(f"{block.name}: there is no input {port} to be guided")
        after = after.replace(found.group(), "", 1)
        wires.append(f"  wire {found.group(1) or ''}{port} = {value};\n")
    for number, (signal, value) in enumerate(guide.loose.items()):
        width, is_constant, _ = value.partition("'")
        given[signal] = f"guided_{number}" if is_constant else value
        if is_constant:
            wires.append(f"  wire [{int(width) - 1}:0] guided_{number} = {value};\n")
    after = after.replace(");\n", ");\n" + "".join(wires), 1)
    loose = tuple(signal for signal in block.loose if signal not in guide.loose)
    source = model.smt2.with_name(f"{guide.cover}.v")
    return models._made(replace(block, given=given, loose=loose), before + top + after, source)


def _verilog(model: Model) -> str:
    return model.smt2.with_suffix(".v").read_text(encoding="utf-8")
