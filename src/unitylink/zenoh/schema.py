# SPDX-License-Identifier: BSD-3-Clause
"""How values lie in the bytes of a message, and the JSON that tells a stranger. No I/O, no clock."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Sequence
from typing import Any

from unitylink.errors import ProtocolError, ValueRangeError
from unitylink.recording.json_messages import steps
from unitylink.spec.model import Element, Instance, Spec
from unitylink.values import Quantity
from unitylink.values.codec import Codec

from .messages import SAMPLE

PLAIN = ("WRITE", "READWRITE")  # what a set-point may be
_INTEGERS = {8: "b", 16: "h", 32: "i", 64: "q"}
Piece = tuple[str, int, int, int, bool, int, "tuple[float, float, float] | None"]


class Field:
    """One value in the bytes of a message: its path, its type there, and how it gets in and out.

    Numbers with a scale or a point are f64 in the unit of the spec. Whole numbers, enumerations and packed
    bits are integers of 8, 16, 32 or 64 bits. A bool is a byte.
    """

    def __init__(self, path: str, codec: Codec) -> None:
        self.path, self.codec = path, codec
        kind = codec.type
        self.packed = kind.kind == "bits"
        if kind.kind == "bool":
            self.type, code = "bool", "B"
        elif kind.kind == "float" or codec.quantity.scaled:
            self.type, code = "f64", "d"
        else:
            bits = next((bits for bits in _INTEGERS if codec.width <= bits), 64)
            self.type = f"{'i' if kind.signed else 'u'}{bits}"
            code = _INTEGERS[bits] if kind.signed else _INTEGERS[bits].upper()
        self._struct = struct.Struct(f"<{code}")
        self.bytes = self._struct.size

    @property
    def piece(self) -> Piece:
        """What `SampleOutput` needs to make these bytes of words, as `Codec.decode_array` and `pack` do.

        These are what it is, its words, their bits, its own bits, whether it has a sign, and its bytes. Last
        are (a, b, c) if its value is (number * a + b) / c.
        """
        codec, quantity = self.codec, self.codec.quantity
        arithmetic = None
        if quantity.scaled and self.type == "f64":
            steps = (codec.factor, quantity.offset, 1) if codec.ratio is None else codec.ratio
            if codec.type.kind == "float":
                steps = (quantity.scale, quantity.offset, 1)
            arithmetic = (float(steps[0]), float(steps[1]), float(steps[2]))
        kind = codec.type.kind if codec.type.kind in ("float", "bool") else "whole"
        signed = bool(codec.sign) and not self.packed
        return kind, codec.words, codec.data_bits, codec.width, signed, self.bytes, arithmetic

    def pack(self, raw: int) -> bytes:
        """Return the bytes of a raw number of the board."""
        if self.packed:
            return self._struct.pack(raw)
        return self._struct.pack(self.codec.decode(raw))

    def pack_value(self, value: Any) -> bytes:
        """Return the bytes of a value. Raises ValueRangeError if the spec does not allow it."""
        return self.pack(self.codec.encode(value))

    def unpack(self, data: bytes, offset: int = 0) -> Any:
        """Return the value in these bytes. Raises ProtocolError or ValueRangeError."""
        try:
            (value,) = self._struct.unpack_from(data, offset)
        except struct.error:
            raise ProtocolError(f"{self.path}: {len(data)} bytes, too few for {self.type}") from None
        if self.type == "bool":
            if value > 1:
                raise ValueRangeError(f"{self.path}: {value} is no bool; nothing was sent")
            return bool(value)
        if self.packed:
            if value >> self.codec.width:
                raise ValueRangeError(
                    f"{self.path}: {value:#x} has more than {self.codec.width} bits; nothing was sent"
                )
            return self.codec.decode(value)
        self.codec.encode(value)
        return value


class Layout:
    """Values one after the other, in the bytes of a message."""

    def __init__(self, fields: Iterable[Field]) -> None:
        self.fields = tuple(fields)
        self.bytes = sum(field.bytes for field in self.fields)

    def unpack(self, data: bytes) -> dict[str, Any]:
        """Return the values by path. Raises ProtocolError or ValueRangeError, which name the item."""
        if len(data) != self.bytes:
            paths = ", ".join(field.path for field in self.fields[:3])
            raise ProtocolError(f"{len(data)} bytes of values; {paths} take {self.bytes}")
        values, offset = {}, 0
        for field in self.fields:
            values[field.path] = field.unpack(data, offset)
            offset += field.bytes
        return values

    def pack(self, raws: Sequence[int]) -> bytes:
        """Return the bytes of raw numbers, one for each field."""
        return b"".join(field.pack(raw) for field, raw in zip(self.fields, raws, strict=True))

    def pack_values(self, values: Sequence[Any]) -> bytes:
        """Return the bytes of values. Raises ValueRangeError for the first that the spec does not allow."""
        return b"".join(field.pack_value(value) for field, value in zip(self.fields, values, strict=True))

    def described(self, offset: int = 0) -> list[dict[str, Any]]:
        """Return where each value is, for JSON."""
        told = []
        for field in self.fields:
            told.append({"path": field.path, "type": field.type, "offset": offset})
            offset += field.bytes
        return told


def fields_of(spec: Spec, data_bits: int) -> dict[str, Field]:
    """Return the field of each item by its path."""
    return {
        path: Field(path, Codec(path, Quantity.of(element), data_bits, commanded=element.writable))
        for path, element in spec.walk()
    }


def set_layouts(spec: Spec, fields: dict[str, Field]) -> dict[str, Layout]:
    """Return the layout of the set-points of each item, and of each part with several, by its path."""
    layouts: dict[str, Layout] = {}

    def add(instance: Instance) -> None:
        below = [element.path for element in instance.walk() if element.access in PLAIN]
        if below:
            layouts[instance.path] = Layout(fields[path] for path in below)
        layouts.update({path: Layout([fields[path]]) for path in below})
        for inner in instance.instances:
            add(inner)

    add(spec.roots[0])
    return layouts


def schema_of(
    spec: Spec, fields: dict[str, Field], sets: dict[str, Layout], topics: dict[str, Layout]
) -> dict[str, Any]:
    """Return what a stranger has to know to use the keys, for JSON."""
    elements = dict(spec.walk())
    return {
        "version": 1,
        "robot": spec.roots[0].name,
        "byte_order": "little",
        "values": {"/".join(steps(path)): _told(elements[path], fields[path]) for path in fields},
        "set": {
            "/".join(steps(part)): {"bytes": layout.bytes, "fields": layout.described()}
            for part, layout in sets.items()
        },
        "publish": {
            name: {"bytes": SAMPLE.size + layout.bytes, "fields": layout.described(SAMPLE.size)}
            for name, layout in topics.items()
        },
    }


def _told(element: Element, field: Field) -> dict[str, Any]:
    told: dict[str, Any] = {"path": element.path, "type": field.type, "access": element.access}
    for name in ("unit", "minimum", "maximum", "documentation"):
        if (value := getattr(element, name)) not in (None, ""):
            told[name] = value
    if element.type.enum is not None:
        told["members"] = {one.name: one.value for one in element.type.enum.values}
    return told
