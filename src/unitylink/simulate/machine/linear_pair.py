# SPDX-License-Identifier: BSD-3-Clause
"""Two states that act on each other, as the current and the speed of a motor do."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence

_KEPT = 16  # lengths of time whose matrices are kept
_SHORT = 0.5  # of a time constant: a series is better up to here
_TERMS = 24  # of this series, at most
_ALIKE = 1e-4  # two poles that differ by less of a time constant are one

_Matrix = tuple[float, float, float, float]


class LinearPair:
    """The states x and y of x' = a x + b y + u and y' = c x + d y + w, with u and w constant in a step.

    A step is the exact solution, whatever its length is: no pole is too quick for it. The determinant
    a d − b c must not be below 0, nor a + d above 0: then it is stable.
    """

    def __init__(self, a: float, b: float, c: float, d: float) -> None:
        self._a, self._b, self._c, self._d = a, b, c, d
        self._half = (a + d) / 2
        # A − half is a matrix whose square is this number
        self._inside = ((a - d) / 2) ** 2 + b * c
        self._root = math.sqrt(abs(self._inside))
        self._kept: dict[float, tuple[_Matrix, _Matrix, _Matrix]] = {}

    def step(
        self, x: float, y: float, u: float, w: float, seconds: float, *, keep: bool = True
    ) -> tuple[float, float, float]:
        """Return x and y after some time, and the integral of y over it.

        `keep` says that this length of time will come again.
        """
        kept = self._kept.get(seconds)
        if kept is None:
            kept = self._matrices(seconds)
            if keep:
                if len(self._kept) >= _KEPT:
                    self._kept.clear()
                self._kept[seconds] = kept
        (xx, xy, yx, yy), (xu, xw, yu, yw), (_, _, gone_u, gone_w) = kept
        return (
            xx * x + xy * y + xu * u + xw * w,
            yx * x + yy * y + yu * u + yw * w,
            yu * x + yw * y + gone_u * u + gone_w * w,
        )

    def _matrices(self, seconds: float) -> tuple[_Matrix, _Matrix, _Matrix]:
        """Return exp(A t), its integral over t, and the integral of that."""
        if (abs(self._half) + self._root) * seconds < _SHORT:
            parts = self._series(seconds)
        elif self._root * seconds < _ALIKE:
            parts = _double(self._half, seconds)
        elif self._inside < 0:
            turning = _functions(complex(self._half, self._root), seconds)
            parts = [(one.real, one.imag / self._root) for one in turning]
        else:
            return self._of_two_poles(seconds)
        first, second, third = (self._of(mean, by) for mean, by in parts)
        return first, second, third

    def _of_two_poles(self, seconds: float) -> tuple[_Matrix, _Matrix, _Matrix]:
        """Return the three matrices by the parts of A that belong to its poles.

        No difference of two numbers that are nearly the same is formed, however far apart the poles are.
        """
        a, b, c, d = self._a, self._b, self._c, self._d
        quick = self._half - self._root
        slow = (a * d - b * c) / quick
        # a − quick, which is also slow − d, and d − quick
        low, high = (b * c / (d - quick), d - quick) if abs(a) >= abs(d) else (a - quick, b * c / (a - quick))
        made: list[_Matrix] = []
        apart = 2 * self._root
        for one, two in zip(_functions(slow, seconds), _functions(quick, seconds), strict=True):
            late, early = one.real, two.real
            made.append(
                (
                    (late * low + early * high) / apart,
                    (late - early) * b / apart,
                    (late - early) * c / apart,
                    (late * high + early * low) / apart,
                )
            )
        return made[0], made[1], made[2]

    def _of(self, mean: float, by: float) -> _Matrix:
        """Return mean + by (A − half)."""
        return (
            mean + by * (self._a - self._half),
            by * self._b,
            by * self._c,
            mean + by * (self._d - self._half),
        )

    def _series(self, seconds: float) -> Sequence[tuple[float, float]]:
        """Return the three functions for a short time, each as (mean, by)."""
        half, inside = self._half * seconds, self._inside * seconds
        mean, by, total, total_by = 0.5, 0.0, 0.5, 0.0
        for term in range(3, _TERMS):  # of (A t)^k / (k + 2)!
            mean, by = (half * mean + inside * by) / term, (half * by + seconds * mean) / term
            total += mean
            total_by += by
            if abs(mean) < 1e-18 and abs(inside * by) < 1e-18:
                break
        once = 1.0 + half * total + inside * total_by, half * total_by + seconds * total
        kept = 1.0 + half * once[0] + inside * once[1], half * once[1] + seconds * once[0]
        square = seconds * seconds
        return kept, (seconds * once[0], seconds * once[1]), (square * total, square * total_by)


def _functions(pole: complex, seconds: float) -> tuple[complex, complex, complex]:
    """Return exp(p t), its integral, and the integral of that."""
    turned = pole * seconds
    if abs(turned) < 0.01:
        short = sum(turned**power / math.factorial(power + 2) for power in range(6))
        return 1 + turned + turned**2 * short, seconds * (1 + turned * short), seconds**2 * short
    kept = cmath.exp(turned)
    once = (kept - 1) / pole
    return kept, once, (once - seconds) / pole


def _double(pole: float, seconds: float) -> Sequence[tuple[float, float]]:
    """Return the functions of a double pole, each as (value, slope)."""
    kept = math.exp(pole * seconds)
    once = (kept - 1) / pole
    twice = (once - seconds) / pole
    slope = (seconds * kept - once) / pole
    return [(kept, seconds * kept), (once, slope), (twice, (slope - twice) / pole)]
