# SPDX-License-Identifier: BSD-3-Clause
"""From samples at their own times to frames at a fixed rate, as a data set for learning has them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

from .lerobot_dataset import LerobotDataset, Look

_SLACK = 0.05  # of a frame: a sample that is later by so much belongs to it, or rounding would decide


class Frames:
    """Adds a frame to a data set each 1/fps of device time, with the newest values of that moment.

    The first frame is at the moment at which all values are known. Samples come in the order of their times.
    `keep_look` keeps what cameras see now, and returns what draws it later.
    """

    def __init__(
        self,
        dataset: LerobotDataset,
        lost: Callable[[], int],
        keep_look: Callable[[], Look] | None = None,
    ) -> None:
        self._keep_look = keep_look
        layout = dataset.layout
        self._dataset, self._lost, self._fps = dataset, lost, layout.fps
        self._state, self._action = layout.state, layout.action
        self._wanted = set(layout.state) | set(layout.action)
        self._values: dict[str, float] = {}
        self._times_s: dict[str, float] = {}
        self._begun_s = math.nan  # which is less than nothing
        self._slack_s = _SLACK / layout.fps
        self._fresh = False
        self.held = 0
        """Frames in which no value is newer than in the one before."""

    def take(self, time_s: float, values: Mapping[str, float]) -> None:
        """Take a sample: values by path, and their time."""
        self._emit(time_s - self._slack_s)
        for path, value in values.items():
            if path in self._wanted:
                self._values[path], self._times_s[path] = float(value), time_s
                self._fresh = True
        if math.isnan(self._begun_s) and len(self._values) == len(self._wanted):
            self._begun_s = time_s

    def until(self, time_s: float) -> None:
        """Add the frames up to a time, for the end of an episode."""
        self._emit(time_s + self._slack_s)

    def _emit(self, before_s: float) -> None:
        while self._begun_s + len(self._dataset) / self._fps < before_s:
            self.held += not self._fresh
            self._fresh = False
            sampled_ns = [round((self._times_s[path] - self._begun_s) * 1e9) for path in self._state]
            look = self._keep_look() if self._keep_look is not None else None
            state, action = self._of(self._state), self._of(self._action)
            self._dataset.add(state, action, sampled_ns=sampled_ns, lost=self._lost(), look=look)

    def missing(self) -> Sequence[str]:
        """Return the values that have not come yet."""
        return sorted(self._wanted - set(self._values))

    def _of(self, paths: Sequence[str]) -> list[float]:
        return [self._values[path] for path in paths]
