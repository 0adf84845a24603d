# SPDX-License-Identifier: BSD-3-Clause
"""Section VI of the paper, repeated on a model of its USB chip: `unitylink experiments`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from .document import html, markdown
from .report import TITLE, pictures, report
from .results import PARTS, run_all


def write(out: Path, results: dict[str, Any]) -> None:
    """Write report.md, report.html, the figures and results.json into `out`.

    `results` is what `run_all` returned.
    """
    out.mkdir(parents=True, exist_ok=True)
    blocks = report(results)
    files = {
        "results.json": json.dumps(results, indent=1, allow_nan=False) + "\n",
        "report.md": markdown(blocks),
        "report.html": html(blocks, TITLE),
        **pictures(results),
    }
    for name, text in files.items():
        (out / name).write_text(text, encoding="utf-8")


__all__ = ["PARTS", "markdown", "pictures", "report", "run_all", "write"]
