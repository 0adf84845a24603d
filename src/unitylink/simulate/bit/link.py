# SPDX-License-Identifier: BSD-3-Clause
"""`bit:` URLs: a board that runs the bitstream of a spec, of a folder, or of a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from unitylink.boards import Board, Order, board_names, load_board
from unitylink.errors import UrlError
from unitylink.settings import SETTINGS
from unitylink.spec.model import Spec

from ..plant import load_plant
from ..rtl.build import on_terminal
from .board import BitBoard
from .place import Placed, check_runs, placed, placed_in

_ENDING = ".bin"


def names_spec(path: str) -> bool:
    """Tell whether the path of a `bit:` URL is a spec, which is built first.

    >>> names_spec("arms/lamp.ul"), names_spec("build/lamp-icebreaker"), names_spec("lamp.bin")
    (True, False, False)
    """
    return not path.endswith(_ENDING) and not Path(path).is_dir() and Path(path).suffix != ""


@dataclass(frozen=True)
class Wish:
    """A `bit:` URL in parts. `settings` are those of the design, `options` all others."""

    url: str
    path: str
    options: dict[str, str]
    settings: dict[str, Any]

    def wrong(self, text: str) -> UrlError:
        return UrlError(f"{self.url!r}: {text}")


def bit_board(wish: Wish, spec: Spec | None, endpoint: str) -> BitBoard:
    """Make the board of a `bit:` URL. Its own options are taken out of `wish.options`.

    `spec` is that of the URL, if it names one. Raises what BitBoard and `placed` raise, and UrlError.
    """
    name, plant, root = (wish.options.pop(option, None) for option in ("board", "plant", "root"))
    if names_spec(wish.path):
        found = placed(_order(wish, root, name), on_terminal())
    elif wish.path.endswith(_ENDING):
        found = _file(wish, name)
    else:
        if fixed := [*wish.settings, *(["board"] if name else [])]:
            raise wish.wrong(
                f"{wish.path} has been built, and {', '.join(sorted(fixed))} cannot be changed now"
            )
        found = placed_in(Path(wish.path))
    moving = None if plant is None else load_plant(plant, spec)
    return BitBoard(found, spec, plant=moving, endpoint=endpoint)


def _board_of(wish: Wish, name: str | None) -> Board:
    if name is None:
        raise wish.wrong(f"say for which board it is: board=NAME; there are {', '.join(board_names())}")
    board = load_board(name)
    check_runs(board)
    return board


def _order(wish: Wish, root: str | None, name: str | None) -> Order:
    board, settings = _board_of(wish, name), wish.settings
    if wrong := [key for key in settings if SETTINGS[key].needed_by == ("line",) and key != "baud_hz"]:
        raise wish.wrong(f"{wrong[0]} is for sim: and rtl:; the line of a bitstream has no such buffer")
    if settings.get("physical", board.physical) != board.physical:
        raise wish.wrong(f"the link of {board.name} is {board.physical}; leave physical= out")
    protocol = wish.options.get("protocol", "auto")
    if protocol == "both":  # of the design; the link chooses by itself
        del wish.options["protocol"]
    return Order(
        spec_file=wish.path,
        folder=Path(),
        root=root,
        board=board,
        clock_hz=settings.get("clock_hz"),
        baud_hz=settings.get("baud_hz"),
        protocol=None if protocol == "auto" else protocol,
        settings={key: settings[key] for key in settings.keys() - {"clock_hz", "baud_hz", "physical"}},
    )


def _file(wish: Wish, name: str | None) -> Placed:
    board = _board_of(wish, name)
    if wish.settings.keys() - {"baud_hz"}:
        raise wish.wrong(f"of a bitstream only board= and baud= can be said, not {', '.join(wish.settings)}")
    try:
        bitstream = Path(wish.path).read_bytes()
    except OSError as error:
        raise wish.wrong(f"{wish.path}: {error.strerror or error}") from error
    report = {"board": board.reference, "hash": None, "baud_hz": wish.settings.get("baud_hz", board.baud_hz)}
    return Placed(bitstream, {**report, "pins": {}, "words": {}})
