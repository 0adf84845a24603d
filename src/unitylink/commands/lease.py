# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink lease`: ask for a write lease at a server, give one, or break one."""

from __future__ import annotations

import click


@click.command()
@click.argument("server", metavar="SERVER")
@click.argument("action", type=click.Choice(["ask", "give", "break"]))
@click.argument("part", metavar="PART")
@click.option("--to", metavar="USER", help="With give: for whom the part is kept. Else for who asked first.")
def command(server: str, action: str, part: str, *, to: str | None) -> None:
    """Pass the right to write a part of a robot on.

    SERVER is serve://HOST:PORT/BOARD. PART is a part of the robot, such as j1, or * for all of it. Your
    token is in UNITYLINK_TOKEN. `unitylink status` shows who has which lease, and who has asked.

    \b
    ask    says to the holder that you want the part, for 60 s
    give   gives what your programs hold; the outputs keep their values. The part is then kept for 10 s for
           whom you name, or for who has asked first. Your program gets LeaseHeld if it writes meanwhile
    break  takes it away from whoever has it; the outputs get their SAFE values. This needs the scope admin

    \b
    Examples:
      unitylink lease serve://127.0.0.1:7450/arm ask j1
      unitylink lease serve://127.0.0.1:7450/arm give j1 --to ben
      unitylink lease serve://127.0.0.1:7450/arm break '*'
    """
    from unitylink.server.questions import ask_server

    if to is not None and action != "give":
        raise click.UsageError("--to goes with give")
    told = ask_server(server, action, part, *([to] if to else []))
    if action == "ask":
        holders = ", ".join(told["holders"])
        click.echo(f"{holders} is asked for it" if holders else f"nobody else holds {part}; you can write it")
    elif action == "give":
        kept_for = told["kept_for"]
        click.echo(
            f"{part} is kept for {kept_for}" if kept_for else f"{part} is free; nobody has asked for it"
        )
    else:
        click.echo(f"{part} is taken away, and made safe")
