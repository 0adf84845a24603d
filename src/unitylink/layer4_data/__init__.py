# SPDX-License-Identifier: BSD-3-Clause
"""Layer 4: typed values, groups of them, publishing, and the base of generated classes.

Names are loaded when they are first used. Generators need only the names that generated code has.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from unitylink.lazy import load_name

if TYPE_CHECKING:
    from . import binding
    from .binding import Tree
    from .cycle import Cycle
    from .dead_man import DeadMen
    from .group import ValueGroup
    from .node import Node
    from .publishing import Publisher
    from .read_value import ReadClearValue, ReadValue
    from .recording import Recording
    from .snapshot import Snapshot
    from .tree import load_spec_objects
    from .value import Value
    from .write_value import ClearValue, PulseValue, ReadWriteValue, WriteValue

__all__ = [
    "ClearValue",
    "Cycle",
    "DeadMen",
    "Node",
    "Publisher",
    "PulseValue",
    "ReadClearValue",
    "ReadValue",
    "ReadWriteValue",
    "Recording",
    "Snapshot",
    "Tree",
    "Value",
    "ValueGroup",
    "WriteValue",
    "binding",
    "load_spec_objects",
]

_HOMES = {
    "ClearValue": "write_value",
    "Cycle": "cycle",
    "DeadMen": "dead_man",
    "Node": "node",
    "Publisher": "publishing",
    "PulseValue": "write_value",
    "ReadClearValue": "read_value",
    "ReadValue": "read_value",
    "ReadWriteValue": "write_value",
    "Recording": "recording",
    "Snapshot": "snapshot",
    "Tree": "binding",
    "Value": "value",
    "ValueGroup": "group",
    "WriteValue": "write_value",
    "binding": "",
    "load_spec_objects": "tree",
}


def __getattr__(name: str) -> object:
    return load_name(__name__, _HOMES, name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
