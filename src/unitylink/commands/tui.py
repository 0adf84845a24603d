# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink tui`: a robot in the terminal."""

from __future__ import annotations

import sys

import click

from unitylink.optional import absent

from .failure import Failure
from .link_option import link_argument, open_target, spec_option
from .output import terminal
from .root_option import root_option


@click.command()
@link_argument
@spec_option
@click.option(
    "--rate",
    "rate_hz",
    type=click.FloatRange(0.1, 1000),
    default=5.0,
    show_default=True,
    metavar="HZ",
    help="How often to read items without PUBLISH.",
)
@root_option("Show one board")
def command(link: str, *, spec_file: str | None, rate_hz: float, root: str | None) -> None:
    """Show a robot in this terminal, also over ssh: values, charts, set-points, stop.

    The space bar stops the robot at any time. Take control of a part (t) before you write. q quits, and then
    the outputs keep their values. The key ? shows all keys.

    \b
    Examples:
      unitylink tui sim:arm.ul
      unitylink tui serial:/dev/ttyUSB0 --spec arm.ul
      unitylink tui serve://127.0.0.1:7450/arm --spec arm.ul
    """
    try:
        import textual  # noqa: F401
    except ImportError:
        raise absent("textual", "the dashboard in a terminal") from None
    if not (terminal() and sys.stdin.isatty()):
        raise Failure("this terminal cannot show a screen", "`unitylink watch` prints values as lines")
    with open_target(link, spec_file, quiet=True) as target:
        if target.spec is None:
            raise Failure("the screen is made from a spec", "add --spec FILE.ul")
        if root is None and len(target.spec.roots) > 1:
            boards = ", ".join(one.name for one in target.spec.roots)
            raise Failure(f"{target.names.source} has several boards: {boards}", "choose one with --root")
        from .terminal.app import run
        from .terminal.opening import open_screen

        with open_screen(target.link, target.spec, root=root, read_hz=rate_hz) as (screen, controls):
            run(screen, controls)
        target.link.check_alive()
