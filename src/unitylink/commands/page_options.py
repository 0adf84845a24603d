# SPDX-License-Identifier: BSD-3-Clause
"""The options of `dashboard` and `serve --page` for what a page has beside the spec."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from .failure import Failure
from .several_options import Command, with_options

if TYPE_CHECKING:
    from unitylink.dashboard.extras import Extras
    from unitylink.spec.model import Instance


_OPTIONS = (
    click.option(
        "--recordings",
        metavar="FOLDER",
        default="recordings",
        show_default=True,
        help="Where the page keeps recordings. The folder is made when one begins.",
    ),
    click.option(
        "--recordings-mb",
        type=click.FloatRange(1, 1_000_000),
        default=1000,
        show_default=True,
        metavar="MB",
        help="How much they may take of the disk, all together.",
    ),
    click.option("--urdf", metavar="FILE", help="The shape of the robot, which the page shows and moves."),
    click.option("--mjcf", metavar="FILE", help="The same as a model of MuJoCo."),
    click.option(
        "--joint",
        "joints",
        multiple=True,
        metavar="NAME=ITEM",
        help="The item that moves a joint of the shape, where the names differ.",
    ),
)


def page_options(command: Command) -> Command:
    """Give a command the options of a page."""
    return with_options(command, _OPTIONS)


def page_extras(
    root: Instance,
    source: str,
    *,
    recordings: str,
    recordings_mb: float,
    urdf: str | None,
    mjcf: str | None,
    joints: tuple[str, ...],
) -> Extras:
    """Return what the options say, for the board `root` of the spec in the file `source`.

    Tells on stderr what of the shape cannot be shown, or does not move.
    """
    from unitylink.dashboard.body.joint_values import with_values
    from unitylink.dashboard.body.mjcf import read_mjcf
    from unitylink.dashboard.body.urdf import read_urdf
    from unitylink.dashboard.extras import Extras
    from unitylink.dashboard.shelf import Shelf

    shelf = Shelf(recordings, round(recordings_mb * 1e6))
    text = Path(source).read_text(encoding="utf-8")
    if urdf is not None and mjcf is not None:
        raise click.UsageError("--urdf and --mjcf both give the shape; one is enough")
    shape = mjcf if urdf is None else urdf
    if shape is None:
        if joints:
            raise Failure("--joint names joints of the shape, and none is given", "add --urdf or --mjcf FILE")
        return Extras(shelf, text)
    given = {}
    for one in joints:
        name, found, path = one.partition("=")
        if not (name and found and path):
            raise click.BadParameter(f"'{one}': expected NAME=ITEM", param_hint="--joint")
        given[name] = path
    body = with_values(read_urdf(shape) if urdf is not None else read_mjcf(shape), root, given)
    for note in body.notes:
        click.echo(f"{shape}: {note}", err=True)
    return Extras(shelf, text, body)
