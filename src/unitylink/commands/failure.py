# SPDX-License-Identifier: BSD-3-Clause
"""The failures of commands themselves. Links, specs and boards have the errors of `unitylink.errors`."""

from __future__ import annotations

import click


class Failure(click.ClickException):
    """A command cannot do its work. `help_line` is the remedy. The exit code is 1."""

    def __init__(self, message: str, help_line: str = "") -> None:
        super().__init__(message)
        self.help_line = help_line
