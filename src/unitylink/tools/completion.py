# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink completion`: what a shell needs to complete our commands and options."""

from __future__ import annotations

import click
from click.shell_completion import get_completion_class

_WHERE = {
    "bash": 'eval "$(unitylink completion bash)"    in ~/.bashrc',
    "zsh": 'eval "$(unitylink completion zsh)"    in ~/.zshrc',
    "fish": "unitylink completion fish > ~/.config/fish/completions/unitylink.fish",
}


@click.command(epilog="\b\n" + "\n".join(f"{shell:<6} {where}" for shell, where in _WHERE.items()))
@click.argument("shell", type=click.Choice(list(_WHERE)))
def command(shell: str) -> None:
    """Print the script that lets SHELL complete commands and options with the TAB key.

    Examples, which also say where the script belongs:
    """
    from unitylink.cli import cli

    kind = get_completion_class(shell)
    assert kind is not None
    click.echo(kind(cli, {}, "unitylink", "_UNITYLINK_COMPLETE").source())
