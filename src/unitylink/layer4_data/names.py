# SPDX-License-Identifier: BSD-3-Clause
"""Spec names as Python attributes: the same rule for generated classes and for trees made at run time."""

from __future__ import annotations

from collections.abc import Iterable

from unitylink import values

# The public names of Node; a test compares. A spec may use them: its attribute then ends in "_".
NODE_NAMES = frozenset(
    {
        "apply_initial",
        "apply_safe",
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
MODULE_NAMES = frozenset(
    {
        "ClearValue",
        "IntEnum",
        "Link",
        "Node",
        "PulseValue",
        "ReadClearValue",
        "ReadValue",
        "ReadWriteValue",
        "Tree",
        "ValueGroup",
        "WriteValue",
        "binding",
        "dataclass",
        "facts",
    }
)
# Attributes cannot be called like the types in the annotations of generated classes either.
ATTRIBUTE_NAMES = NODE_NAMES | MODULE_NAMES | {"bool", "float", "int", "str", "tuple"}


def python_names(names: Iterable[str], reserved: Iterable[str] = ATTRIBUTE_NAMES) -> dict[str, str]:
    """Map spec names to attributes of a Node, as `values.python_names` does."""
    return values.python_names(names, reserved)
