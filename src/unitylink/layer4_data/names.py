# SPDX-License-Identifier: BSD-3-Clause
"""Names of attributes, and the version, for generated code and for trees that are made at run time."""

from __future__ import annotations

from collections.abc import Iterable

from unitylink import values
from unitylink.spec.model import Element, Group, Instance, Spec

BINDING_VERSION = 3  # the version of what generated code expects of this layer; raise it when that changes

# The public names of Node. A test compares them. A spec may use them. Its attribute then ends in "_".
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

# Names that a generated module uses itself. No class and no attribute of a spec can have them.
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
# Nor can attributes have the names of types in the annotations of generated classes.
ATTRIBUTE_NAMES = NODE_NAMES | MODULE_NAMES | {"bool", "float", "int", "str", "tuple"}


def python_names(names: Iterable[str], reserved: Iterable[str] = ATTRIBUTE_NAMES) -> dict[str, str]:
    """Map names of a spec to attributes of a Node, as `values.python_names` does."""
    return values.python_names(names, reserved)


def attribute_of(member: Instance | Element | Group) -> str:
    """Return the name under which a node has a member.

    For a member of an array, it is the name of the array.
    """
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
