# SPDX-License-Identifier: BSD-3-Clause
"""What the budget of the line promises for each publish, and what comes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any
from urllib.parse import parse_qsl

import numpy as np

from unitylink.errors import UnityLinkError
from unitylink.spec.isochrony.budget import DeviceBudget, GroupBudget, budget

from .requests import plain

if TYPE_CHECKING:
    from unitylink.layer2_message import Link
    from unitylink.layer4_data.publication import PublishReport
    from unitylink.spec.model import Instance, Spec

    from .feed import Portion

WINDOW_S = 10.0


@dataclass
class _Pace:
    """How far the times of a publish are from its rate, the worst of this window and of the one before."""

    last_s: float | None = None
    window: int = 0
    worst_s: list[float] = field(default_factory=lambda: [0.0, 0.0])

    def take(self, times_s: Any, period_s: float) -> None:
        window = int(times_s[-1] // WINDOW_S)
        if window != self.window:
            self.worst_s = [0.0, self.worst_s[0] if window == self.window + 1 else 0.0]
            self.window = window
        if self.last_s is not None:
            times_s = np.concatenate(([self.last_s], times_s))
        self.last_s = float(times_s[-1])
        if len(times_s) > 1:
            apart_s = np.diff(times_s)
            # a lost publish is counted as lost, and leaves a whole number of periods
            off_s = np.abs(apart_s - period_s * np.maximum(1.0, np.round(apart_s / period_s)))
            self.worst_s[0] = max(self.worst_s[0], float(off_s.max()))


class Promise:
    """Compares publishes of the gateware with the budget. `take` looks at samples.

    The baud rate is that of the link's URL, or of the spec. Without one, there is no promise of times.
    """

    def __init__(self, spec: Spec, root: Instance, link: Link) -> None:
        self.budget = _budget(spec, root, link)
        groups = self.budget.groups if self.budget is not None else ()
        self._groups = {frozenset(group.paths): group for group in groups}
        self._paces: dict[tuple[str, ...], _Pace] = {}
        self._periods_s: dict[tuple[str, ...], float] = {}

    def begin(self, reports: Sequence[PublishReport]) -> None:
        """Learn which publishes there are, and how often they shall come."""
        self._periods_s = {one.paths: 1 / one.rate_hz for one in reports if one.hardware and one.rate_hz}

    def take(self, portion: Portion) -> None:
        """Look at the times of samples."""
        paths = tuple(value.path for value in portion.values)
        period_s = self._periods_s.get(paths)
        if period_s is not None:
            self._paces.setdefault(paths, _Pace()).take(portion.times_s, period_s)

    def told(self, paths: tuple[str, ...]) -> dict[str, Any]:
        """Return for one publish, in s: the bounds that the budget promises, and the worst that came.

        Each is None if it is not known. A publish is `sampled_s` late at most, and all of it has left the
        board after `sent_s`. `off_s` is how far two samples were from their distance, in the last 10 to 20 s.
        """
        group: GroupBudget | None = self._groups.get(frozenset(paths))
        pace = self._paces.get(paths)
        return {
            "sampled_s": group.sampled_s if group is not None else None,
            "sent_s": group.latency_s if group is not None else None,
            "off_s": plain(max(pace.worst_s)) if pace is not None else None,
        }

    def line(self) -> dict[str, Any] | None:
        """Return what the budget says of the whole line, or None."""
        if self.budget is None:
            return None
        return {
            "bytes_per_s": self.budget.bytes_per_s,
            "baud_hz": self.budget.baud_hz,
            "load": self.budget.load,
        }


def _budget(spec: Spec, root: Instance, link: Link) -> DeviceBudget | None:
    device = next((one for one in spec.devices if one.root == root.name), None)
    if device is None:
        return None
    given = dict(parse_qsl(link.url.partition("?")[2])).get("baud", "")
    baud_hz = int(given) if given.isascii() and given.isdecimal() and int(given) else None
    try:
        return budget(device, protocol=link.protocol, baud_hz=baud_hz)
    except (UnityLinkError, ValueError, ArithmeticError):
        return None  # such a link has no line that could be planned
