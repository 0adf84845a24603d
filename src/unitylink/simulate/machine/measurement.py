# SPDX-License-Identifier: BSD-3-Clause
"""What a sensor makes of a quantity: late, noisy, off, limited, and in steps."""

from __future__ import annotations

import math
import random
from collections import deque

from unitylink.errors import ValueRangeError

from .checks import check_number


class Measurement:
    """The errors of a sensor, in the unit of what it measures.

        range_m = Measurement(noise_rms=0.003, delay_s=0.02, resolution=0.001, least=0.03, most=4.0)
        values["front.distance"] = range_m.of(distance_m, time_s)  # in each step

    A value is `delay_s` old, has the constant error `bias` and noise of normal distribution, stays from
    `least` to `most`, and is a multiple of `resolution` (0: any). The noise is that of `seed`: the same each
    time.
    """

    def __init__(
        self,
        *,
        noise_rms: float = 0.0,
        bias: float = 0.0,
        delay_s: float = 0.0,
        resolution: float = 0.0,
        least: float = -math.inf,
        most: float = math.inf,
        seed: int = 0,
    ) -> None:
        what = "measurement"
        self.noise_rms = check_number(what, "noise_rms", noise_rms, least=0.0)
        self.bias = check_number(what, "bias", bias)
        self.delay_s = check_number(what, "delay_s", delay_s, least=0.0)
        self.resolution = check_number(what, "resolution", resolution, least=0.0)
        if not least < most:
            raise ValueRangeError(
                f"{what}: least is {least!r} and most is {most!r}; least must be below most"
            )
        self._least, self._most = least, most
        self._past: deque[tuple[float, float]] = deque()
        self.seed(seed)

    def seed(self, number: int) -> None:
        """Begin the noise anew."""
        self._random = random.Random(number)

    def of(self, value: float, time_s: float) -> float:
        """Return what the sensor shows, at device time `time_s`, which must not go back."""
        check_number("measurement", "value", value, remedy="look at what the plant computes")
        if self._past and time_s < self._past[-1][0]:
            raise ValueRangeError(
                f"measurement: time_s is {time_s!r}, and was {self._past[-1][0]!r}; it cannot go back"
            )
        self._past.append((time_s, value))
        # half a nanosecond: sums of periods have rounding errors
        while len(self._past) > 1 and self._past[1][0] <= time_s - self.delay_s + 5e-10:
            self._past.popleft()
        shown = self._past[0][1] + self.bias
        if self.noise_rms:
            shown += self._random.gauss(0.0, self.noise_rms)
        shown = min(max(shown, self._least), self._most)
        return self.resolution * round(shown / self.resolution) if self.resolution else shown
