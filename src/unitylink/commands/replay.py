# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink replay`: a recording, served as a device."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import click

from .failure import Failure
from .output import json_option, print_json
from .serving import endpoint_of, serve, serving_options

if TYPE_CHECKING:
    from unitylink.simulate import Board
    from unitylink.simulate.plants.recording import RecordingPlant
    from unitylink.spec.model import Spec


@click.command()
@click.argument("recording", metavar="FILE")
@click.option("--spec", "spec_file", metavar="FILE", help="The spec. An MCAP recording brings its own.")
@serving_options
@click.option(
    "--speed", type=click.FloatRange(0, min_open=True), default=1.0, metavar="X", help="Play X times as fast."
)
@click.option("--loop", is_flag=True, help="Begin again at the end. Otherwise the last values stay.")
@json_option("the address")
def command(
    recording: str,
    *,
    spec_file: str | None,
    tcp: str | None,
    udp: str | None,
    pty: str | None,
    bind: str | None,
    anyone: bool,
    speed: float,
    loop: bool,
    as_json: bool,
) -> None:
    """Serve a recording as a device until Ctrl-C.

    It answers and publishes what the robot did when it was recorded.

    Everything that works on a robot works on its recording: watch, plot, your own program. Writes are
    accepted, but have no effect. `sim:SPEC.ul?plant=FILE.mcap` is the same inside one program.

    \b
    Examples:
      unitylink replay arm.mcap --tcp 5555
      unitylink replay arm.csv --spec arm.ul --speed 0.1 --loop
    """
    endpoint, address = endpoint_of(tcp, udp, pty, bind, anyone)
    if not Path(recording).is_file():
        raise Failure(f"{recording}: there is no such file", "`unitylink record` makes one")
    from unitylink.simulate import Board
    from unitylink.simulate.plants.recording import RecordingPlant

    spec = _spec(recording, spec_file)
    plant = RecordingPlant(recording, speed=speed, loop=loop)
    with Board(spec, plant=plant, endpoint=endpoint, bind=address) as board:
        serve(board, lambda: _announce(board, recording, spec, as_json), _teller(plant))


def _announce(board: Board, recording: str, spec: Spec, as_json: bool) -> None:
    if as_json:
        print_json({"url": board.url, "recording": recording, "spec": spec.source}, indent=None)
    else:
        click.echo(f"serving {recording} at {board.url}\nCtrl-C ends it")


def _teller(plant: RecordingPlant) -> Callable[[], None]:
    """Return a function that prints once that the recording has ended."""
    told = False

    def look() -> None:
        nonlocal told
        if plant.ended and not told:
            told = True
            click.echo(f"{plant.notice or 'the recording is over'}; its last values stay", err=True)

    return look


def _spec(recording: str, spec_file: str | None) -> Spec:
    from unitylink.recording import origin
    from unitylink.spec import compile_text, load

    if spec_file is not None:
        return load(spec_file)
    known = origin(recording)
    if not known.text:
        raise Failure(f"{recording} does not say which spec it belongs to", "add --spec FILE.ul")
    result = compile_text(known.text.encode("utf-8"), known.name)
    if result.spec is None:
        raise Failure(f"{recording}: its spec {known.name} does not compile alone", "add --spec FILE.ul")
    return result.spec
