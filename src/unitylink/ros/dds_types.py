# SPDX-License-Identifier: BSD-3-Clause
"""Messages of ROS 2 as types of cyclonedds, with the names and the layout of ROS 2 on the wire."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Mapping
from operator import attrgetter
from typing import Any

from .standard import NOTHING, Fields

_CODES = {
    "bool": "?",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float32": "f",
    "float64": "d",
}


class DdsTypes:
    """Makes classes of messages: `types["std_msgs/Int32"](5)` is an instance for a cyclonedds writer."""

    def __init__(self, definitions: Mapping[str, Fields]) -> None:
        self._definitions = dict(definitions)
        self._made: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        if name not in self._made:
            package, _, message = name.partition("/")
            self._made[name] = self._make(f"{package}::msg::dds_::{message}_", self._definitions[name])
        return self._made[name]

    def service(self, name: str, part: str, fields: Fields) -> Any:
        """Return the class of a service's request or reply ("Request", "Response").

        The message's number comes first in it, as DDS needs it.
        """
        return self.part_of_service(
            name, part, (("guid", "uint64"), ("number", "int64"), *(fields or NOTHING))
        )

    def part_of_service(self, name: str, part: str, fields: Fields) -> Any:
        """Return the class of a service's request or reply without a number."""
        package, _, service = name.partition("/")
        return self._make(f"{package}::srv::dds_::{service}_{part}_", fields or NOTHING)

    def _make(self, name: str, fields: Fields) -> Any:
        from cyclonedds.idl import make_idl_struct

        made = make_idl_struct(
            name.rpartition("::")[2], name, {field: self._type(kind) for field, kind in fields}
        )
        flat = _flat(self._definitions, fields)
        if flat is not None:
            setattr(made, "serialize", _serializer(*flat))  # noqa: B010  a class made at run time
            setattr(made, "deserialize", _deserializer(made.deserialize, flat[0]))  # noqa: B010
        return made

    def _type(self, kind: str) -> Any:
        from cyclonedds.idl import types

        found = re.fullmatch(r"(.*)\[(\d*)\]", kind)
        if found:
            inner = self._type(found[1])
            array: Any = types.array
            sequence: Any = types.sequence
            return array[inner, int(found[2])] if found[2] else sequence[inner]
        if kind == "string":
            return str
        if kind == "bool":
            return bool
        return getattr(types, kind) if kind in _CODES else self[kind]


Flat = tuple[str, list[str]]  # (format of struct, paths of the attributes that fill it)


def _flat(definitions: Mapping[str, Fields], fields: Fields) -> Flat | None:
    """Return how a message without strings and sequences is packed in one step.

    Return None for other messages.
    """
    codes = ""
    paths: list[str] = []
    at = 0
    for name, kind in fields:
        if kind not in _CODES:
            return None
        size = struct.calcsize(f"<{_CODES[kind]}")
        pad = -at % size
        codes += "x" * pad + _CODES[kind]
        at += pad + size
        paths.append(name)
    return (codes, paths) if paths else None


def _serializer(codes: str, names: list[str]) -> Callable[..., bytes]:
    """Return a `serialize` for messages of plain numbers. It takes a tenth of the time of the general one."""
    pack = struct.Struct(f"<4s{codes}").pack
    if len(names) == 1:
        (name,) = names
        return lambda self, buffer=None, endianness=None, use_version_2=None: pack(
            b"\0\1\0\0", getattr(self, name)
        )
    fields = attrgetter(*names)
    return lambda self, buffer=None, endianness=None, use_version_2=None: pack(b"\0\1\0\0", *fields(self))


def _deserializer(general: Callable[..., Any], codes: str) -> Any:
    """Return a `deserialize` for the same messages.

    If the byte order of the CDR is not a PC's, it calls `general`.
    """
    layout = struct.Struct(f"<4x{codes}")
    unpack, size = layout.unpack_from, layout.size

    def deserialize(cls: Any, /, data: bytes, has_header: bool = True, **options: Any) -> Any:
        if has_header and data[:2] == b"\0\1" and len(data) >= size:
            return cls(*unpack(data))
        return general(data, has_header=has_header, **options)

    return classmethod(deserialize)
