# SPDX-License-Identifier: BSD-3-Clause
"""Pins as riocore names them, and as `unitylink build --pin` does."""

from __future__ import annotations

import re
from collections.abc import Mapping

from unitylink.boards import load_board
from unitylink.boards.manifest import Board

from ..failure import Failure
from .plugins import Plugin, PluginPin

# riocore's board -> ours
BOARDS = {"ICEBreakerV1.0e": "icebreaker", "icebreaker3x": "icebreaker"}
# our board -> (slot and pin of riocore, the name in our manifest)
SLOTS: Mapping[str, tuple[tuple[str, str], ...]] = {
    "icebreaker": (
        (r"PMOD_?1([AB]):P(\d+)", r"P1\1\2"),
        (r"PMOD_?2:P(\d+)", r"P2_\1"),
        (r"LED:([RG])", r"LED\1_N"),
    )
}
_STEPS_MOST = 8  # from a breakout board to another one


class BoardPins:
    """Finds the pins of a board. Each is given once."""

    def __init__(self, theirs: str, ours: str | None, plugins: list[Plugin]) -> None:
        name = ours or BOARDS.get(theirs)
        self.board: Board | None = load_board(name) if name is not None else None
        self._boards = {one.node.text("uid") for one in plugins if one.kind == "fpga"}
        self._through = {
            f"{one.node.text('uid')}:{slot}": pin.where
            for one in plugins
            if one.kind == "breakout"
            for slot, pin in one.pins.items()
        }
        self._taken: dict[str, str] = {}
        named = self.board.pins.values() if self.board else ()
        self._sites = {pin.site: pin.name for pin in reversed(tuple(named))}  # a site may have two names
        for pin in (pin for one in plugins for pin in one.pins.values()):
            known = self.board.pins.get(self._name(pin) or "") if self.board else None
            if known is not None and known.active_low:  # `unitylink build` inverts it
                pin.turn()

    def find(self, pin: PluginPin) -> str | None:
        """Return the name of a pin for `--pin`. None: this board has no such pin, as far as we know.

        Raises Failure if another plugin has the pin.
        """
        name = self._name(pin)
        if name is None or self.board is None:
            return None
        known = self.board.pins.get(name)
        site = known.site if known else name
        if site in self._taken:
            raise Failure(
                f"{pin.node.file}: {pin.node.place}: {pin.where} is taken by {self._taken[site]}",
                "give one of them another pin in the file",
            )
        self._taken[site] = pin.node.place
        return name

    def _name(self, pin: PluginPin) -> str | None:
        where = pin.where
        for _ in range(_STEPS_MOST):
            where = self._through.get(where, where)
        first, _, rest = where.partition(":")
        if first in self._boards:
            where = rest
        if self.board is None or not where:
            return None
        for pattern, name in SLOTS.get(self.board.name, ()):
            if found := re.fullmatch(pattern, where):
                return found.expand(name)
        if where in self.board.pins:
            return where
        return self._sites.get(where)
