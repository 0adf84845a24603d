# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink completion`: the script with which a shell completes our commands and options."""

from __future__ import annotations

import click
from click.shell_completion import get_completion_class

_WHERE = {
    "bash": 'eval "$(unitylink completion bash)"    # in ~/.bashrc',
    "zsh": 'eval "$(unitylink completion zsh)"     # in ~/.zshrc',
    "fish": "unitylink completion fish > ~/.config/fish/completions/unitylink.fish",
}


@click.command(
    help="Print the script that lets SHELL complete commands and options with the TAB key.\n\n"
    "\b\nExamples, which also say where the script belongs:\n"
    + "\n".join(f"  {where}" for where in _WHERE.values())
)
@click.argument("shell", type=click.Choice(list(_WHERE)))
@click.pass_context
def command(context: click.Context, shell: str) -> None:
    """The help text is in `help` above. It is made from the table."""
    kind = get_completion_class(shell)
    assert kind is not None
    click.echo(kind(context.find_root().command, {}, "unitylink", "_UNITYLINK_COMPLETE").source())
