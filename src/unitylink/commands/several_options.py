# SPDX-License-Identifier: BSD-3-Clause
"""Options that several commands share, in one decorator."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

Command = TypeVar("Command", bound=Callable[..., Any])


def with_options(command: Command, options: Sequence[Callable[[Any], Any]]) -> Command:
    """Give a command the options, which are decorators of click. `--help` has them in their order."""
    for option in reversed(options):
        command = option(command)
    return command
