# SPDX-License-Identifier: BSD-3-Clause
"""Types, units and limits of values, and the one codec between raw words and engineering values."""

from __future__ import annotations

from .classes import Enumeration, enum_class, field_names, member_names, record_class
from .codec import Codec, member_text
from .names import python_names
from .plain import plain
from .quantity import Quantity, format_value

__all__ = [
    "Codec",
    "Enumeration",
    "Quantity",
    "enum_class",
    "field_names",
    "format_value",
    "member_names",
    "member_text",
    "plain",
    "python_names",
    "record_class",
]
