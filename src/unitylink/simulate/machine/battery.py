# SPDX-License-Identifier: BSD-3-Clause
"""A battery, whose voltage falls as its charge is taken."""

from __future__ import annotations

from bisect import bisect_left

from unitylink.errors import ValueRangeError

from .checks import check_number, check_positive, check_share, check_whole
from .supply import Supply

# volts of a cell without a load, by what is left of its charge. Typical of lithium polymer at 25 degC
LITHIUM_V = (
    (0.0, 3.27),
    (0.05, 3.61),
    (0.1, 3.69),
    (0.2, 3.73),
    (0.3, 3.77),
    (0.4, 3.80),
    (0.5, 3.84),
    (0.6, 3.87),
    (0.7, 3.95),
    (0.8, 4.02),
    (0.9, 4.11),
    (1.0, 4.20),
)


class Battery(Supply):
    """Cells in series. A protection switches off below `cutoff_v`, and stays off. 0 is none.

    battery = Battery(cells=3, capacity_mah=2200, internal_mohm=30)
    battery.volts, battery.charge  # 1 is full, 0 is empty
    """

    def __init__(
        self,
        cells: int,
        capacity_mah: float,
        internal_mohm: float,
        *,
        charge: float = 1.0,
        cutoff_v: float = 0.0,
        cell_v: tuple[tuple[float, float], ...] = LITHIUM_V,
    ) -> None:
        check_whole("battery", "cells", cells, remedy="12.6 V when full are 3 cells of lithium")
        self.capacity_mah = check_positive("battery", "capacity_mah", capacity_mah)
        self.charge = check_share("battery", "charge", charge)
        self.cutoff_v = check_number("battery", "cutoff_v", cutoff_v, least=0.0)
        charges = [one for one, _ in cell_v]
        if len(cell_v) < 2 or charges[0] != 0 or charges[-1] != 1 or charges != sorted(set(charges)):
            raise ValueRangeError("battery: cell_v needs pairs (charge, volts), from charge 0 up to 1")
        for _, volts in cell_v:
            check_positive("battery", "cell_v", volts)
        self._cells, self._curve, self._charges = cells, cell_v, charges
        super().__init__(cells * cell_v[-1][1], internal_mohm)

    @property
    def open_v(self) -> float:
        if not self.is_on:
            return 0.0
        place = max(1, bisect_left(self._charges, self.charge))
        (low, low_v), (high, high_v) = self._curve[place - 1 : place + 1]
        return self._cells * (low_v + (high_v - low_v) * (self.charge - low) / (high - low))

    def take(self, consumer: object, amps: float, seconds: float) -> None:
        """Tell what a consumer took. Its charge is gone. An empty battery switches off."""
        super().take(consumer, amps, seconds)
        if not self.is_on:
            return
        self.charge = min(max(self.charge - amps * seconds / (3.6 * self.capacity_mah), 0.0), 1.0)
        if self.charge == 0.0 or self.volts < self.cutoff_v:
            self.is_on = False
