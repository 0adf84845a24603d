# SPDX-License-Identifier: BSD-3-Clause
"""The hash of a message or a service of ROS 2: RIHS01 of REP 2011, a SHA-256 of its description in JSON.

Only nodes whose hashes are equal talk to each other over Zenoh.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping
from typing import Any

from .standard import NOTHING, Fields

# The numbers of type_description_interfaces/FieldType, from Iron on.
_NESTED, _BYTE = 1, 16
_PRIMITIVES = {
    "int8": 2,
    "uint8": 3,
    "int16": 4,
    "uint16": 5,
    "int32": 6,
    "uint32": 7,
    "int64": 8,
    "uint64": 9,
    "float32": 10,
    "float64": 11,
    "bool": 15,
    "string": 17,
}
_ARRAY, _BOUNDED, _SEQUENCE = 48, 96, 144  # added to the number of what is in it
# ROS has a type `byte`, which is a uint8 on the wire.
_BYTES = {("diagnostic_msgs/msg/DiagnosticStatus", "level")}
_EVENT_INFO: Fields = (
    ("event_type", "uint8"),
    ("stamp", "builtin_interfaces/Time"),
    ("client_gid", "uint8[16]"),
    ("sequence_number", "int64"),
)


def message_hash(definitions: Mapping[str, Fields], name: str) -> str:
    """Return the hash of the message `name`, such as std_msgs/String, of `definitions`.

    >>> message_hash({"std_msgs/String": (("data", "string"),)}, "std_msgs/String")
    'RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18'
    """
    types = {_full(one): fields for one, fields in definitions.items()}
    return _hash(types, _full(name))


def service_hash(definitions: Mapping[str, Fields], name: str, request: Fields, response: Fields) -> str:
    """Return the hash of the service `name`, such as std_srvs/Trigger, with these fields."""
    package, _, service = name.partition("/")
    whole = f"{package}/srv/{service}"
    parts = {f"{whole}_Request": request or NOTHING, f"{whole}_Response": response or NOTHING}
    types = {_full(one): fields for one, fields in definitions.items()} | parts
    types["service_msgs/msg/ServiceEventInfo"] = _EVENT_INFO
    types[f"{whole}_Event"] = (
        ("info", "service_msgs/ServiceEventInfo"),
        ("request", f"{whole}_Request[<=1]"),
        ("response", f"{whole}_Response[<=1]"),
    )
    types[whole] = (
        ("request_message", f"{whole}_Request"),
        ("response_message", f"{whole}_Response"),
        ("event_message", f"{whole}_Event"),
    )
    return _hash(types, whole)


def _full(name: str) -> str:
    """Return the name with the kind in it: std_msgs/msg/String."""
    return name if name.count("/") == 2 else name.replace("/", "/msg/")


def _hash(types: Mapping[str, Fields], name: str) -> str:
    others = sorted(_within(types, name) - {name})
    described = {
        "type_description": _described(types, name),
        "referenced_type_descriptions": [_described(types, other) for other in others],
    }
    return f"RIHS01_{hashlib.sha256(json.dumps(described).encode()).hexdigest()}"


def _within(types: Mapping[str, Fields], name: str) -> set[str]:
    """Return `name` and the types of its fields, and those of their fields."""
    found = {name}
    for _, kind in types[name]:
        inner = kind.partition("[")[0]
        if inner not in _PRIMITIVES:
            found |= _within(types, _full(inner))
    return found


def _described(types: Mapping[str, Fields], name: str) -> dict[str, Any]:
    fields = []
    for field, kind in types[name]:
        inner, _, size = kind.partition("[")
        number = _BYTE if (name, field) in _BYTES else _PRIMITIVES.get(inner, _NESTED)
        count = re.match(r"<=(\d+)|(\d*)", size)
        assert count is not None
        if "[" in kind:
            number += _BOUNDED if count[1] else _ARRAY if count[2] else _SEQUENCE
        described = {
            "type_id": number,
            "capacity": int(count[1] or count[2] or 0),
            "string_capacity": 0,
            "nested_type_name": "" if inner in _PRIMITIVES else _full(inner),
        }
        fields.append({"name": field, "type": described})
    return {"type_name": name, "fields": fields}
