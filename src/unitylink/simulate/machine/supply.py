# SPDX-License-Identifier: BSD-3-Clause
"""Where the current comes from: a supply whose voltage sags under load."""

from __future__ import annotations

from .checks import check_number, check_positive


class Supply:
    """A voltage with a resistance: a bench supply, or the base of a `Battery`.

        supply = Supply(24.0, internal_mohm=50)
        supply.volts         # with what all consumers take now
        supply.is_on = False  # somebody pulls the plug

    What feeds from it tells its current by `take`.
    """

    def __init__(self, volts: float, internal_mohm: float = 0.0) -> None:
        self._open_v = check_positive("supply", "volts", volts)
        self.ohm = check_number("supply", "internal_mohm", internal_mohm, least=0.0) / 1000
        self.is_on = True
        self._taken: dict[int, float] = {}  # A, by consumer

    @property
    def open_v(self) -> float:
        """The voltage without any load. 0 if it is off."""
        return self._open_v if self.is_on else 0.0

    @property
    def current_a(self) -> float:
        return sum(self._taken.values()) if self.is_on else 0.0

    @property
    def volts(self) -> float:
        return max(0.0, self.open_v - self.ohm * self.current_a)

    def without(self, consumer: object) -> float:
        """Return the voltage that this consumer would find if it took nothing."""
        others = self.current_a - self._taken.get(id(consumer), 0.0)
        return max(0.0, self.open_v - self.ohm * others)

    def take(self, consumer: object, amps: float, seconds: float) -> None:
        """Tell what a consumer took in the last `seconds`. A negative current flows back."""
        check_number("supply", "amps", amps, remedy="look at what the plant computes")
        self._taken[id(consumer)] = amps if self.is_on else 0.0

    def take_always(self, amps: float) -> None:
        """Take a current for all that is not modelled: the computer, the lights."""
        self._taken[id(self)] = check_number("supply", "amps", amps)
