# SPDX-License-Identifier: BSD-3-Clause
"""The gateware's dead-man as a node uses it: queried, watched, armed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from unitylink.protocol import CONTROL_VALUE_FEATURE_DEADMAN

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

_KEPT = "outputs keep their values when the link is lost"
NONE = f"this gateware has no dead-man: {_KEPT}, and are made safe when it is back"
OFF = f"the dead-man is off: {_KEPT}, and are made safe when it is back"
NO_SAFE = f"the spec gives no SAFE values for a dead-man: {_KEPT}"


class DeadManGuard:
    """Let the gateware make its outputs safe when this program or the link is gone, if it can.

    `lacking` says why it cannot. It is empty if it can. `tripped` means that the outputs are safe, and that
    nothing is written before `arm()`. A `deadman=` in the link's URL takes precedence over `silence_s`.
    """

    def __init__(self, link: Link, silence_s: float, *, safe: bool) -> None:
        self._link, self._wanted_s, self._safe = link, silence_s, safe
        self.silence_s = 0.0
        self.tripped = False
        has_one = link.description is not None and link.description.features & CONTROL_VALUE_FEATURE_DEADMAN
        self.lacking = "" if has_one else NONE
        self.renew()

    def renew(self) -> None:
        """Ask for its state, and start it if it does not run."""
        state = self._link.dead_man() if self.lacking != NONE else None
        if state is None:
            return
        self.tripped = state.tripped
        if state.tripped:
            return
        self.silence_s = state.silence_s if state.running else self._wanted_s
        self.lacking = OFF if not self.silence_s else "" if self._safe else NO_SAFE
        if not self.lacking and not state.running:
            self._link.set_dead_man(self.silence_s)

    def arm(self) -> None:
        """Allow outputs to be written again after a trip."""
        if self.tripped:
            self._link.arm()
            self.renew()

    def has_tripped(self) -> bool:
        """Ask whether the dead-man has tripped since this was last noticed."""
        if self.lacking or self.tripped:
            return False
        state = self._link.dead_man()
        return state is not None and state.tripped

    def told(self) -> str:
        """Return its state, in a few words for the diagnostics."""
        if self.tripped:
            return "tripped: the outputs are safe, call arm"
        return self.lacking.partition(":")[0].partition(",")[0] or f"trips after {self.silence_s:g} s"
