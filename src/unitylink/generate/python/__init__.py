# SPDX-License-Identifier: BSD-3-Clause
"""Python proxies from a spec."""

from __future__ import annotations

from pathlib import Path

import jinja2

from unitylink.spec.model import Spec

from .planner import plan

__all__ = ["generate_python"]


def generate_python(spec: Spec) -> dict[str, str]:
    """Return {file name: text} of the module with one class per constructor of the spec."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(Path(__file__).parent),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,  # the result is Python, quoted by the planner
    )
    module = plan(spec)
    return {module.file: environment.get_template("proxies.py.jinja").render(module=module)}
