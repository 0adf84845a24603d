# SPDX-License-Identifier: BSD-3-Clause
"""The model of a spec as documented JSON."""

from __future__ import annotations

from .model import generate_json, model_json

__all__ = ["generate_json", "model_json"]
