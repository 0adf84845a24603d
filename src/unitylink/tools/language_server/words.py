# SPDX-License-Identifier: BSD-3-Clause
"""The words of the language by the places where they may stand."""

from __future__ import annotations

from unitylink.spec.cursor import ACCESS_WORDS, LINK_KINDS
from unitylink.spec.properties import (
    ELEMENT_PROPERTIES,
    FIELD_PROPERTIES,
    LINK_KIND_PROPERTIES,
    LINK_PROPERTIES,
)

TOP = ("public", "link", "import", "const", "enum", "open enum", "bits")
TYPES = (
    "bool",
    "u8",
    "u16",
    "u32",
    "u64",
    "i8",
    "i16",
    "i32",
    "i64",
    "f32",
    "f64",
    "fixed",
    "ufixed",
    "signed",
)
OVERFLOW = ("error", "saturate")

__all__ = [
    "ACCESS_WORDS",
    "ELEMENT_PROPERTIES",
    "FIELD_PROPERTIES",
    "LINK_KINDS",
    "LINK_KIND_PROPERTIES",
    "LINK_PROPERTIES",
    "OVERFLOW",
    "TOP",
    "TYPES",
]
