# SPDX-License-Identifier: BSD-3-Clause
"""The names of attributes, and the version, of generated code and of trees that are made at run time."""

from __future__ import annotations

from collections.abc import Iterable

from unitylink import values
from unitylink.spec.model import Element, Group, Instance, Spec

BINDING_VERSION = 3  # what generated code expects of this layer; raised when that changes

# The public names of Node; a test compares. A spec may use them: its attribute then ends in "_".
NODE_NAMES = frozenset(
    {
        "apply_initial",
        "apply_safe",
        "cycle",
        "dead_man",
        "display",
        "links",
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

# Names that a generated module uses itself: no class and no attribute of a spec can have them.
MODULE_NAMES = frozenset(
    {
        "ClearValue",
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


def attribute_of(member: Instance | Element | Group) -> str:
    """Return the name under which a node has a member. For a member of an array it is the array's name."""
    return member.name if isinstance(member, Group) else member.array or member.name


def event_lines(spec: Spec, root: Instance) -> dict[str, int]:
    """Return the event line of each value that an event publishes, by path."""
    return {
        element.path: group.number
        for device in spec.devices
        if device.root == root.name
        for group in device.groups
        if group.trigger != "rate"
        for element in group.elements
    }
