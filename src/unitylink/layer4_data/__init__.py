# SPDX-License-Identifier: BSD-3-Clause
"""Layer 4: typed values, groups of them, publishing, and the base of generated classes."""

from __future__ import annotations

from . import binding
from .binding import Tree
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
