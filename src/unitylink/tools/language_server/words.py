# SPDX-License-Identifier: BSD-3-Clause
"""The words of the language by the places where they may stand."""

from __future__ import annotations

TOP = ("public", "link")
ACCESS = ("READ", "WRITE")
ELEMENT_PROPERTIES = ("ID", "CRC", "PUBLISH")
LINK_PROPERTIES = ("CTRL", "COMM", "BASE")
