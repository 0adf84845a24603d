# SPDX-License-Identifier: BSD-3-Clause
"""The words of the language by the places where they may stand."""

from __future__ import annotations

from unitylink.spec.meaning.type_names import BUILT_IN_TYPES
from unitylink.spec.model import ENGINES, PHYSICAL_LAYERS, SEND_IMMEDIATE
from unitylink.spec.text.cursor import ACCESS_WORDS, LINK_KINDS
from unitylink.spec.text.properties import (
    ELEMENT_PROPERTIES,
    FIELD_PROPERTIES,
    LINK_KIND_PROPERTIES,
    LINK_PROPERTIES,
)

TOP = ("public", "link", "import", "const", "enum", "open enum", "bits")
# property -> the words that are its possible values
CHOICES = {
    "OVERFLOW": ("error", "saturate"),
    "PHYSICAL": PHYSICAL_LAYERS,
    "SEND_IMMEDIATE": SEND_IMMEDIATE,
    "ENGINE": ENGINES,
}

__all__ = [
    "ACCESS_WORDS",
    "BUILT_IN_TYPES",
    "CHOICES",
    "ELEMENT_PROPERTIES",
    "FIELD_PROPERTIES",
    "LINK_KINDS",
    "LINK_KIND_PROPERTIES",
    "LINK_PROPERTIES",
    "TOP",
]
