# SPDX-License-Identifier: BSD-3-Clause
"""The register map of a spec as one HTML page."""

from __future__ import annotations

from .page import html_files

__all__ = ["html_files"]
