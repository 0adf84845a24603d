# SPDX-License-Identifier: BSD-3-Clause
"""The option `--root`: one board of a spec that has several."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

import click

from .failure import Failure

if TYPE_CHECKING:
    from unitylink.spec.model import Spec

F = TypeVar("F", bound=Callable[..., Any])


def root_option(what: str) -> Callable[[F], F]:
    """Give a command the option `--root`. `what` says what the command does with the chosen board."""
    text = f"{what}: that of this public constructor, or behind this link, where the spec has several."
    return click.option("--root", metavar="NAME", help=text)


def part_of(spec: Spec, root: str | None) -> Spec:
    """Return the part of the spec that `--root` chooses, or all of it without one."""
    if root is None:
        return spec
    try:
        return spec.only(root)
    except KeyError as error:
        raise Failure(str(error.args[0]), "choose one with --root") from None
