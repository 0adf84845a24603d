# SPDX-License-Identifier: BSD-3-Clause
"""A spec that was made from a file in another language."""

from __future__ import annotations

from dataclasses import dataclass

from unitylink.spec import compile_text, format_text, render
from unitylink.spec.model import Spec

from .failure import Failure


@dataclass(frozen=True)
class Imported:
    """A spec, and the parts of its source that it could not express. `build` makes its bitstream."""

    text: str
    notes: tuple[str, ...]
    build: str = ""


def checked(text: str, name: str) -> tuple[str, Spec]:
    """Return an imported text in the canonical layout, and its spec.

    Raises Failure, which names the parts that UL-spec cannot express.
    """
    laid_out = format_text(text, f"{name}.ul")
    result = compile_text(laid_out, f"{name}.ul")
    errors = [one for one in result.diagnostics if one.severity == "error"]
    if errors or result.spec is None:
        raise Failure(f"{name} cannot be expressed in UL-spec:\n{render(errors)}")
    return laid_out, result.spec
