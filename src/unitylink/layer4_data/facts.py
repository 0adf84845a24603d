# SPDX-License-Identifier: BSD-3-Clause
"""The names with which generated code describes its values: `facts.Quantity(facts.ValueType("int", 16))`."""

from __future__ import annotations

from unitylink.spec.model import Publish
from unitylink.spec.types import INT32, UINT32, EnumType, EnumValue, Field, ValueType
from unitylink.values import Enumeration, Quantity

__all__ = [
    "INT32",
    "UINT32",
    "EnumType",
    "EnumValue",
    "Enumeration",
    "Field",
    "Publish",
    "Quantity",
    "ValueType",
]
