# SPDX-License-Identifier: BSD-3-Clause
"""Words of the registers as an array of numbers in SI units. It costs a tenth of BoardValues."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite

import numpy as np
import numpy.typing as npt

from unitylink.spec.model import Element

from ..registers import Registers

Numbers = npt.NDArray[np.float64]


@dataclass(frozen=True)
class SiWord:
    """A value of one word. Times `factor` plus `shift`, it is in SI units.

    With `amount`, it shows how large a number is, whatever its sign.
    """

    element: Element
    factor: float
    shift: float = 0.0
    amount: bool = False


class SiWords:
    """Values of one word each, as numbers in SI units.

    A number beyond the limits of its value or of its word becomes the limit, as with a sensor. One that is
    not a number becomes 0.
    """

    def __init__(self, words: Sequence[SiWord], registers: Registers) -> None:
        self._registers = registers
        bits = registers.data_bits
        values = [(word.element, word.factor) for word in words]
        self._addresses = [element.addresses[0] for element, _ in values]
        widths = [bits if element.type.bus else element.type.width for element, _ in values]
        self._mask = np.array([(1 << width) - 1 for width in widths], dtype=np.int64)
        self._sign = np.array(
            [
                1 << width - 1 if element.type.signed else 0
                for (element, _), width in zip(values, widths, strict=True)
            ],
            dtype=np.int64,
        )
        self._floats = np.array([element.type.kind == "float" for element, _ in values], dtype=np.bool_)
        self._some_floats = bool(self._floats.any())
        scales = [float(element.scale) / (1 << element.type.fraction) for element, _ in values]
        self._scale = np.array([scale * factor for scale, (_, factor) in zip(scales, values, strict=True)])
        self._offset = np.array([float(word.element.offset) * word.factor + word.shift for word in words])
        ends = [_ends(word) for word in words]
        low, high = np.array([low for low, _ in ends]), np.array([high for _, high in ends])
        # What a word can hold is a limit, too, and one for all is quicker than two.
        held = np.array([-self._sign, self._mask - self._sign]) * self._scale + self._offset
        self._low = np.where(self._floats, low, np.maximum(low, held.min(axis=0)))
        self._high = np.where(self._floats, high, np.minimum(high, held.max(axis=0)))
        self._amount = np.array([word.amount for word in words], dtype=np.bool_)
        self._some_amount = bool(self._amount.any())
        self._ones = np.ones(len(words))
        self._last_words: list[int] = []
        self._last: Numbers = np.zeros(0)

    def read(self) -> Numbers:
        """Return the numbers. They are the caller's own."""
        read = self._registers.read_many(self._addresses)
        if (
            read != self._last_words
        ):  # most times they are equal: a program writes less often than a plant steps
            self._last_words, self._last = read, self._of(read)
        numbers: Numbers = self._last.copy()
        return numbers

    def read_new(self) -> Numbers | None:
        """Return the numbers, or None if they are those of the last time. It is quicker then."""
        read = self._registers.read_many(self._addresses)
        if read == self._last_words:
            return None
        self._last_words, self._last = read, self._of(read)
        return self._last

    def forget(self) -> None:
        """Let `read_new` return the numbers again."""
        self._last_words = []

    def _of(self, read: Sequence[int]) -> Numbers:
        words = np.array(read, dtype=np.int64)
        raw = ((words & self._mask) ^ self._sign) - self._sign
        numbers: Numbers = raw * self._scale + self._offset
        if self._some_floats:
            floats = (words & 0xFFFFFFFF).astype(np.uint32).view(np.float32).astype(np.float64)
            numbers = np.where(self._floats, np.nan_to_num(floats) * self._scale + self._offset, numbers)
        return numbers

    def write(self, numbers: Numbers) -> None:
        """Set the words."""
        if not isfinite(numbers.dot(self._ones)):  # it is the quickest look for what is not a number
            numbers = np.nan_to_num(numbers, posinf=np.inf, neginf=-np.inf)
        if self._some_amount:
            numbers = np.where(self._amount, np.abs(numbers), numbers)
        values = np.minimum(np.maximum(numbers, self._low), self._high)
        values -= self._offset
        values /= self._scale
        whole = np.where(self._floats, 0.0, values) if self._some_floats else values
        raw = np.rint(whole).astype(np.int64) & self._mask
        if self._some_floats:
            floats = values.astype(np.float32).view(np.uint32).astype(np.int64)
            raw = np.where(self._floats, floats, raw)
        self._registers.write_many(self._addresses, raw.tolist())


def _ends(word: SiWord) -> tuple[float, float]:
    """Return the limits of a value in SI units, the lower one first."""
    low, high = word.element.minimum, word.element.maximum
    first = float(low) * word.factor + word.shift if low is not None else -np.inf * np.sign(word.factor)
    last = float(high) * word.factor + word.shift if high is not None else np.inf * np.sign(word.factor)
    return (first, last) if word.factor > 0 else (last, first)
