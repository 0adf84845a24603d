# SPDX-License-Identifier: BSD-3-Clause
"""Layer 4: typed values, groups of them, publishing, and the base of generated classes."""

from __future__ import annotations

from . import binding
from .binding import Tree
from .group import ValueGroup
from .node import Node
from .publishing import Publisher
from .recording import Recording
from .snapshot import Snapshot
from .tree import load_spec_objects
from .value import ReadValue, Value, WriteValue

__all__ = [
    "Node",
    "Publisher",
    "ReadValue",
    "Recording",
    "Snapshot",
    "Tree",
    "Value",
    "ValueGroup",
    "WriteValue",
    "binding",
    "load_spec_objects",
]
