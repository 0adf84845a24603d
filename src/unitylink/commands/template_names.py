# SPDX-License-Identifier: BSD-3-Clause
"""The names in templates of Python, which a project cannot have as its own."""

from __future__ import annotations

import io
import tokenize
from collections.abc import Iterable
from pathlib import Path

import click


def check_names(name: str, robot_class: str, templates: Iterable[Path]) -> None:
    """Raise a usage error if a template means something else by the name of the project or of its class."""
    for template in templates:
        text = template.read_text(encoding="utf-8")
        tokens = tokenize.generate_tokens(io.StringIO(text).readline)
        if {name, robot_class} & {token.string for token in tokens if token.type == tokenize.NAME}:
            raise click.UsageError(
                f"'{name}' means something else in the project; did you mean {name}_robot?"
            )
