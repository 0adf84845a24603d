# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink fleet`: many robots on a Zenoh network, from one description."""

from __future__ import annotations

import click

from .fleet_record import record
from .fleet_run import run
from .fleet_security import security
from .fleet_status import check, status
from .fleet_update import update


class Actions(click.Group):
    """A group that takes `run` if the first word is none of its actions."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the action that the words name."""
        if args and args[0] not in self.commands and not args[0].startswith("-"):
            args = ["run", *args]
        return super().resolve_command(ctx, args)


@click.group(cls=Actions)
def command() -> None:
    """Run many robots on a Zenoh network, and look after them.

    FLEET.toml describes them: for each robot its name, where its board is, its spec, and what may be done
    with it. Without an action it is run. docs/fleet.md has all words of the file.

    \b
    Examples:
      unitylink fleet fleet.toml
      unitylink fleet status fleet.toml
      unitylink fleet check fleet.toml
      unitylink fleet update fleet.toml
      unitylink fleet record fleet.toml --duration 60
      unitylink watch zenoh:lab/arm1
    """


for _action in (run, status, check, record, update, security):
    command.add_command(_action)
