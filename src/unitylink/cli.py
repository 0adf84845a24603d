# SPDX-License-Identifier: BSD-3-Clause
"""The command `unitylink`: the table of commands, and how each of them ends.

A command is a module of `commands/`, or of the package `unitylink_lab` in a checkout, with a click command
named `command`. It is imported when it is run. So
`unitylink --version` and a spec's `check` load neither the native core nor rich. Exit codes: 0 done, 1 an
error, 2 wrong usage, 130 interrupted, 141 the reader of a pipe went away.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from importlib import import_module
from io import TextIOWrapper

import click

from unitylink.commands.checkout import CHECKOUT_NEEDED, in_checkout
from unitylink.errors import UnityLinkError, UrlError
from unitylink.program import INTERRUPTED, PIPE_CLOSED, silence_stdout

# name -> (module of commands/ or folder of unitylink_lab/, one line for `unitylink --help`), in the order in
# which a user meets them
COMMANDS: dict[str, tuple[str, str]] = {
    "demo": ("demo", "Run an example on a virtual board: the SCARA robot moves."),
    "new": ("new", "Start a project: a spec, a script that moves it, a README."),
    "check": ("check", "Check specs, and show each mistake with its place and remedy."),
    "explain": ("explain", "Explain a code of `check` or of `doctor`."),
    "lsp": ("lsp", "Serve editors (the language server)."),
    "fmt": ("fmt", "Lay specs out in the canonical way."),
    "generate": ("generate", "Make typed Python classes and a VHDL design from a spec."),
    "build": ("build", "Build a bitstream from a spec for an FPGA board."),
    "flash": ("flash", "Write a bitstream to its board."),
    "gateware": ("gateware", "List the VHDL library, or export it for FuseSoC, VUnit and vendors' tools."),
    "diff": ("diff", "Compare two specs by meaning, and say what breaks."),
    "budget": ("budget", "Show the cost of a spec's publishes on the line."),
    "import": ("import_command", "Make a spec from SystemRDL, or from a configuration of riocore."),
    "map": ("map", "Show the register map of a spec in the browser."),
    "simulate": ("simulate", "Serve a virtual board on TCP, UDP or a pty."),
    "serve": ("serve", "Share boards among many programs: serve://HOST:PORT/NAME."),
    "info": ("info", "Show a device's configuration and the link's statistics."),
    "list": ("list", "List the items of a spec: address, access, type, publish."),
    "read": ("read", "Read items by name, pattern or address."),
    "write": ("write", "Write items: NAME=VALUE."),
    "dashboard": ("dashboard", "Show a robot in the browser: values, charts, set-points, stop."),
    "tui": ("tui", "Show a robot in the terminal: values, charts, set-points, stop."),
    "watch": ("watch", "Watch items change, live."),
    "plot": ("plot", "Draw items: a picture, or live in the terminal."),
    "record": ("record", "Record items to MCAP or CSV."),
    "bridge": ("bridge", "Put a robot on the topics of ROS 1 or ROS 2, or on Zenoh."),
    "fleet": ("fleet", "Run many robots on a Zenoh network, and look after them."),
    "token": ("token", "Make a token for a user of a server."),
    "status": ("status", "Show who is at a server, and who may write."),
    "lease": ("lease", "Ask for the right to write at a server, give it, or take it."),
    "replay": ("replay", "Serve a recording as a device."),
    "discover": ("discover", "List the ports of this machine, and what answers on them."),
    "doctor": ("doctor", "Find what keeps you from a board, and the remedy."),
    "term": ("term", "Type classic commands. Names and checksums are filled in."),
    "decode": ("decode", "Print what went over a link, from a capture (?trace=FILE)."),
    "conformance": ("conformance", "Replay recorded exchanges against the virtual board."),
    "faults": ("faults", "Try the engine on a bad wire."),
    "completion": ("completion", "Print the script that lets a shell complete commands with TAB."),
    "bench": ("bench", "Measure this machine against the required figures."),
    "experiments": ("experiments", "Repeat the paper's measurements on a model of its USB chip."),
}

CHECKOUT_ONLY = frozenset({"conformance", "bench", "experiments"})  # they are no part of a wheel

_EXAMPLES = """
\b
Examples, none of which needs a board:
  unitylink new arm && cd arm && python run.py
  unitylink read sim:arm.ul '*.position'
  unitylink simulate arm.ul --tcp 5555

The examples of all commands are about this arm.ul, which `unitylink new arm` writes.

LINK is where the device is: {forms}.
`unitylink COMMAND --help` shows examples of each.
"""


class Commands(click.Group):
    """A click group whose commands are imported when they are run."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names in the order of the table."""
        return list(available())

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import and return the command."""
        if cmd_name not in COMMANDS:
            return None
        command = import_module(module_of(cmd_name)).command
        assert isinstance(command, click.Command)
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the command, or raise a usage error with the name that was probably meant."""
        if args and args[0] in CHECKOUT_ONLY and args[0] not in available():
            raise click.UsageError(f"'{args[0]}' {CHECKOUT_NEEDED}", ctx)
        if args and args[0] not in COMMANDS and not args[0].startswith("-"):
            from unitylink.spec.report.suggest import nearest

            meant = nearest(args[0], available())
            hint = f"did you mean '{meant}'?" if meant else f"there are: {', '.join(available())}"
            raise click.UsageError(f"no command '{args[0]}'; {hint}", ctx)
        return super().resolve_command(ctx, args)

    def format_help_text(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Name the forms of a LINK. The native core knows them. It is loaded only here."""
        from unitylink.connection.schemes import forms

        self.help = (self.help or "").replace("{forms}", forms())
        super().format_help_text(ctx, formatter)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands without importing them."""
        with formatter.section("Commands"):
            formatter.write_dl([(name, line) for name, (_, line) in available().items()])


def module_of(name: str) -> str:
    """Return the module of a command."""
    module = COMMANDS[name][0]
    return f"unitylink_lab.{module}.command" if name in CHECKOUT_ONLY else f"unitylink.commands.{module}"


def available() -> dict[str, tuple[str, str]]:
    """Return the commands of this installation. In a wheel, these are the commands that need no checkout."""
    here = in_checkout()
    return {name: row for name, row in COMMANDS.items() if here or name not in CHECKOUT_ONLY}


def _version(ctx: click.Context, parameter: click.Parameter, wanted: bool) -> None:
    if wanted and not ctx.resilient_parsing:
        from unitylink import __version__, protocol

        spoken = f"framed {protocol.FRAME_VERSION}, classic {protocol.CLASSIC_VERSION}"
        click.echo(f"unitylink {__version__}, protocols: {spoken}, {_build()}")
        ctx.exit()


def _build() -> str:
    """Describe the platform and the place of this build, without loading the native core."""
    where = os.path.dirname(os.path.abspath(__file__))
    implementation = f"{sys.implementation.name} {sys.version_info[0]}.{sys.version_info[1]}"
    return f"{implementation} on {sys.platform}, from {where}"


@click.group(
    cls=Commands,
    help="Unity-Link connects a PC to FPGA gateware: one spec gives typed objects, a link carries them.\n"
    + _EXAMPLES,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110},
)
@click.option(
    "--version", is_flag=True, is_eager=True, expose_value=False, callback=_version, help="Show the version."
)
@click.option(
    "--include",
    "-I",
    multiple=True,
    metavar="DIR",
    help="Look there too for the specs that a spec imports; before the folders of UNITYLINK_PATH.",
)
@click.pass_context
def cli(ctx: click.Context, include: tuple[str, ...]) -> None:
    """The help text is in `help` above.

    The group itself only extends the search path while a command runs.
    """
    if include:
        before = os.environ.get("UNITYLINK_PATH")
        os.environ["UNITYLINK_PATH"] = os.pathsep.join([*include, *([before] if before else [])])
        ctx.call_on_close(lambda: _restore(before))


def _restore(path: str | None) -> None:
    if path is None:
        os.environ.pop("UNITYLINK_PATH", None)
    else:
        os.environ["UNITYLINK_PATH"] = path


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code; no error leaves as a traceback.

    >>> main(["--version"]) == 0  # doctest: +ELLIPSIS
    unitylink ...
    True
    """
    for stream in (sys.stdout, sys.stderr):
        # a character that the encoding lacks, in a file name or a bar, is no error
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    try:
        try:
            result = cli.main(
                args=None if arguments is None else list(arguments),
                prog_name="unitylink",
                standalone_mode=False,
            )
            return result if isinstance(result, int) else 0
        finally:
            if not sys.stdout.closed:  # the language server closes stdout when the conversation ends
                sys.stdout.flush()
    except click.UsageError as error:
        error.show()
        return 2
    except click.ClickException as error:
        complain(error.format_message(), getattr(error, "help_line", ""))
    except UrlError as error:
        complain(str(error), "`unitylink info --help` shows the forms of a LINK")
        return 2
    except UnityLinkError as error:
        complain(str(error))
    except (KeyboardInterrupt, click.Abort):
        return INTERRUPTED
    except (BrokenPipeError, SystemExit):  # click raises SystemExit at a broken pipe
        silence_stdout()
        return PIPE_CLOSED
    except OSError as error:
        if error.filename is None:  # writing to stdout failed, because the disk is full
            silence_stdout()
        complain(
            f"{error.filename}: {error.strerror}" if error.filename else f"output: {error.strerror or error}"
        )
    return 1


def complain(message: str, help_line: str = "") -> None:
    """Print an error on stderr, with its remedy if that is known."""
    from unitylink.commands.output import colours

    red, bold, off = ("\x1b[1;31m", "\x1b[1m", "\x1b[0m") if colours(sys.stderr) else ("", "", "")
    text = message if message.startswith("error") else f"error: {message}"
    text = f"{red}{text[:5]}{off}{text[5:]}" if red else text
    click.echo(text.rstrip("\n"), err=True)
    if help_line:
        click.echo(f"{bold}help{off}: {help_line}", err=True)
