# SPDX-License-Identifier: BSD-3-Clause
"""Spec names as Python attributes: the same rule for generated classes and for trees made at run time."""

from __future__ import annotations

import keyword
from collections.abc import Iterable

# The public names of Node; a test compares. A spec may use them: its attribute then ends in "_".
NODE_NAMES = frozenset(
    {
        "display",
        "name",
        "on_change",
        "on_publish",
        "path",
        "publisher",
        "publishes",
        "publishing",
        "record",
        "snapshot",
        "start_publishing",
        "stop_publishing",
    }
)

# What a generated module itself calls something: no class and no attribute of a spec can be called that.
MODULE_NAMES = frozenset({"Link", "Node", "ReadValue", "Tree", "ValueGroup", "WriteValue"})
ATTRIBUTE_NAMES = NODE_NAMES | MODULE_NAMES | {"str"}  # the types in annotations of generated classes


def python_names(names: Iterable[str], reserved: Iterable[str] = ATTRIBUTE_NAMES) -> dict[str, str]:
    """Map spec names to attribute names: unchanged where that works, else with "_" at the end.

    Leading underscores are dropped, for they mean private (and two of them are rewritten by Python).

    >>> python_names(["cpos", "class", "class_", "path", "__x"])
    {'cpos': 'cpos', 'class': 'class__', 'class_': 'class_', 'path': 'path_', '__x': 'x_'}
    """
    names, blocked = list(names), set(reserved)
    plain = {n for n in names if not (keyword.iskeyword(n) or n in blocked or n.startswith("_"))}
    taken = plain | blocked
    result = {}
    for name in names:
        attribute = name
        if name not in plain:
            attribute = name.lstrip("_")
            attribute = (attribute if attribute.isidentifier() else f"n{attribute}") + "_"
            while attribute in taken:
                attribute += "_"
            taken.add(attribute)
        result[name] = attribute
    return result
