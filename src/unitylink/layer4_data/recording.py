# SPDX-License-Identifier: BSD-3-Clause
"""What was published, kept for a plot or a file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from typing_extensions import Self

    from .publishing import Publisher
    from .read_value import ReadValue


class Recording:
    """Keep every publish of a tree while the `with` block runs.

    >>> with robot.publishing(), robot.record() as recording:     # doctest: +SKIP
    ...     run()
    >>> times_s, angles = recording.series("j1.cpos")             # doctest: +SKIP
    """

    def __init__(self, publisher: Publisher) -> None:
        self._publisher = publisher
        self._parts: dict[tuple[ReadValue[Any], ...], list[tuple[float, Sequence[int]]]] = {}

    def _take(
        self, time_s: float, values: Sequence[ReadValue[Any]], _: Sequence[Any], raws: Sequence[int]
    ) -> None:
        self._parts.setdefault(tuple(values), []).append((time_s, raws))

    def __enter__(self) -> Self:
        self._publisher.take_with(self._take)
        return self

    def __exit__(self, *_: object) -> None:
        self._publisher.take_no_more(self._take)

    def series(self, path: str) -> tuple[NDArray[np.float64], NDArray[Any]]:
        """Return (times in s, values) of one path, both of shape (n,); KeyError where nothing came.

        Values are float64, int64, uint64 or bool as the type asks; of enumerations and packed values the
        numbers.
        """
        for values, samples in self._parts.items():
            for column, value in enumerate(values):
                if value.path == path:
                    rows = list(samples)  # the publishing may still be going on
                    return (
                        np.array([time_s for time_s, _ in rows], np.float64),
                        value.codec.decode_array(np.array([raws[column] for _, raws in rows], np.uint64)),
                    )
        raise KeyError(f"nothing was published for {path!r}")
