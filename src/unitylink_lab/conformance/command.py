# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink conformance`: recorded exchanges of the 2012 gateware, replayed against the twin."""

from __future__ import annotations

import click

from unitylink.commands.output import json_option, print_json


@click.command()
@click.argument("file")
@click.option("--rtl", is_flag=True, help="Ask the VHDL in GHDL instead of the twin.")
@click.option("--bit", is_flag=True, help="Ask bitstreams, unpacked and compiled.")
@click.option("--chip", type=click.Choice(["hx8k", "ecp5"]), default="hx8k", help="For which chip (hx8k).")
@json_option("the report, with every exchange")
def command(file: str, rtl: bool, bit: bool, chip: str, as_json: bool) -> int:
    """Replay the recorded exchanges in FILE against the virtual board, step by step on its own clock.

    Required exchanges must be equal byte for byte, as far as the `compare` rule of each one asks. Where the
    2012 gateware, the first that was published, has a known defect, the correct answer is required instead.
    Optional ones are only reported. The last line is the result, `N passed, 0 failed`. The exit code is 1 if
    an exchange failed or a defect was answered wrongly.

    With --bit, each of the 22 cores of the recordings is placed at its first use. That takes a minute each.

    \b
    Examples:
      unitylink conformance tests/conformance/classic-transcripts.json
      unitylink conformance tests/conformance/classic-transcripts.json --rtl
      unitylink conformance tests/conformance/classic-transcripts.json --bit
      unitylink conformance tests/conformance/classic-transcripts.json --bit --chip ecp5
      unitylink conformance recordings.json --json > report.json
    """
    from unitylink.simulate.rtl.build import on_terminal

    from .replay import as_dict, render, replay

    if rtl and bit:
        raise click.UsageError("--rtl and --bit are two players: give one of them")
    if bit:
        from unitylink.simulate.bit.bare import BARE_CHIPS

        from .chip import ChipPlayer

        say = on_terminal()
        report = replay(file, ChipPlayer(say=say, protocol="classic", chip=BARE_CHIPS[chip]))
        say("")
    elif rtl:
        from .rtl import rtl_player

        with rtl_player() as player:
            report = replay(file, player)
    else:
        report = replay(file)
    if as_json:
        print_json(as_dict(report))
    else:
        render(report)
    return int(not report.ok)
