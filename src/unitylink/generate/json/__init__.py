# SPDX-License-Identifier: BSD-3-Clause
"""The model of a spec as documented JSON."""

from __future__ import annotations

from .model import json_files, model_json, plan_model

__all__ = ["json_files", "model_json", "plan_model"]
