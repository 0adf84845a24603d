# SPDX-License-Identifier: BSD-3-Clause
"""Messages and services as text, the same for ROS 1 and ROS 2."""

from __future__ import annotations

from .interface import Message

READ_SERVICE = """\
# Reads values by their paths in the spec, such as j1.cpos.
string[] names
---
bool success
string message     # what went wrong, and what to do
float64[] values   # of packed bits the raw number
string[] texts     # with unit; enumerations by name
"""
WRITE_SERVICE = """\
# Writes values by their paths in the spec: all of them are checked before the first is sent.
string[] names
float64[] values   # in the units of the spec; of packed bits the raw number
---
bool success
string message
"""
SERVICES = {"Read": READ_SERVICE, "Write": WRITE_SERVICE}


def definition(message: Message) -> str:
    """Return the text of a .msg file, without the line about its origin.

    >>> from .interface import Field
    >>> print(definition(Message("Lamp", (Field("led", "bool", comment="bright"),), stamped=True)), end="")
    std_msgs/Header header   # stamp: when the gateware sampled it
    uint32 sequence          # counts the publishes since the node has started; a gap is a loss
    bool led                 # bright
    """
    rows = [(f"{constant.type} {constant.name}={constant.value}", "") for constant in message.constants]
    if message.stamped:
        rows.append(("std_msgs/Header header", "stamp: when the gateware sampled it"))
        rows.append(("uint32 sequence", "counts the publishes since the node has started; a gap is a loss"))
    for field in message.fields:
        array = f"[{field.count}]" if field.count else ""
        rows.append((f"{field.type}{array} {field.name}", field.comment))
    width = max(len(text) for text, _ in rows)
    said = f"# {message.documentation}\n" if message.documentation else ""
    return said + "".join(
        f"{text.ljust(width)}   # {comment}\n" if comment else f"{text}\n" for text, comment in rows
    )
