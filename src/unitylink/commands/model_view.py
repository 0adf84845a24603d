# SPDX-License-Identifier: BSD-3-Clause
"""The part of `simulate` that shows a model of MuJoCo: a window, a picture, a film."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING

import click

from .several_options import Command, with_options

if TYPE_CHECKING:
    from unitylink.simulate.plants.mujoco import Film, MujocoPlant
    from unitylink.simulate.plants.mujoco.view import View

_FILM_HZ = 25.0
_OPTIONS = (
    click.option("--view", is_flag=True, help="Show the model of MuJoCo in a window."),
    click.option(
        "--picture",
        type=click.Path(dir_okay=False, path_type=Path),
        metavar="FILE.png",
        help="At the end, write a picture of the model of MuJoCo. It needs no display.",
    ),
    click.option(
        "--film",
        type=click.Path(dir_okay=False, path_type=Path),
        metavar="FILE",
        help="At the end, write a film of the model of MuJoCo, FILE.gif or FILE.mp4. It needs no display.",
    ),
)


def view_options(command: Command) -> Command:
    """Give a command `--view --picture --film`: the arguments of `ModelView`."""
    return with_options(command, _OPTIONS)


class ModelView:
    """Shows a plant while it moves, and writes its picture and film at the end.

    Raises UsageError if the plant has no model, and ToolError if something to draw with is absent. Both are
    told before the board is served.
    """

    def __init__(self, plant: object, view: bool, picture: Path | None, film: Path | None) -> None:
        self.tick_s: float | None = None  # how often `look` wants to be called, None for not at all
        self._picture, self._film = picture, film
        self._taken: Film | None = None
        self._view: View | None = None
        self._next_s = 0.0
        if not (view or picture or film):
            return
        self._plant = _model_of(plant)
        from unitylink.simulate.plants.mujoco import Film
        from unitylink.simulate.plants.mujoco.camera import Camera
        from unitylink.simulate.plants.mujoco.film import film_kind

        if film is not None:
            film_kind(film)
            self._taken = Film(self._plant, rate_hz=_FILM_HZ)
        if picture is not None or film is not None:
            Camera(self._plant.model).close()  # an error is better told now than after the run
        if view:
            from unitylink.simulate.plants.mujoco.view import View

            self._view = View(self._plant)
        if film is not None or view:
            self.tick_s = 1 / (2 * _FILM_HZ)

    def look(self) -> bool:
        """Show where the plant is. Return True if somebody has closed the window."""
        if self._view is not None:
            if not self._view.open:
                return True
            self._view.show()
        if self._taken is not None and time.monotonic() >= self._next_s:
            self._next_s = max(self._next_s + 1 / _FILM_HZ, time.monotonic() - 1 / _FILM_HZ)
            self._taken.take()
        return False

    def finish(self) -> None:
        """Close the window, and write the files."""
        if self._view is not None:
            self._view.close()
        if self._picture is not None:
            from unitylink.simulate.plants.mujoco import save_picture

            save_picture(self._plant, self._picture)
            click.echo(f"picture: {self._picture}", err=True)
        if self._film is not None and self._taken is not None:
            self._taken.take()
            self._taken.save(self._film)
            click.echo(f"film: {self._film}, {len(self._taken) / _FILM_HZ:.1f} s", err=True)


def _model_of(plant: object) -> MujocoPlant:
    try:
        from unitylink.simulate.plants.mujoco import MujocoPlant
    except ImportError:
        pass
    else:
        if isinstance(plant, MujocoPlant):
            return plant
    raise click.UsageError("--view, --picture and --film show a model: give one with --plant mujoco:FILE.xml")
