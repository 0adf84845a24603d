# SPDX-License-Identifier: BSD-3-Clause
"""The page put together: one file with its style, its scripts and the model."""

from __future__ import annotations

import base64
import hashlib
import re
from functools import cache
from importlib.resources import files
from typing import Any

from ..json import plan_model
from ..quoting import Html
from ..spec_plan import SpecPlan

_PRECISE = 1 << 53  # JavaScript's numbers are doubles, so larger integers go as text
_SLOT = re.compile(r"\{\{ (\w+) \}\}")


def html_files(plan: SpecPlan) -> dict[str, str]:
    """Return {file name: text} of the register map, one page that needs nothing else."""
    model = plan.part(plan_model)
    script = _part("codec.js") + _part("map.js")
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    slots = {
        "generated": Html.remark(model["generated"]),
        "name": Html.text(plan.spec.name),
        "style": _part("style.css"),
        "script": script,
        "script_hash": f"sha256-{digest}",
        "model": Html.data(page_data(model)),
    }
    text = _SLOT.sub(lambda slot: slots[slot[1]], _part("page.html"))
    return {f"{plan.spec.name}.html": text}


@cache
def _part(name: str) -> str:
    return files(__package__).joinpath(name).read_text("utf-8")


def page_data(value: Any) -> Any:
    """Return the model for the page. Empty members are left out, and most are empty."""
    if isinstance(value, dict):
        return {name: page_data(inner) for name, inner in value.items() if inner not in (None, "", [], {})}
    if isinstance(value, list):
        return [page_data(inner) for inner in value]
    return str(value) if isinstance(value, int) and abs(value) > _PRECISE else value
