# SPDX-License-Identifier: BSD-3-Clause
"""Published and written values, kept for a plot or a file."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from unitylink.errors import UnknownName

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from typing_extensions import Self

    from unitylink.layer2_message.native_link import Times, Words

    from .published import PublishedValue
    from .publishing import Publisher
    from .write_value import WriteValue

    Rows = Union[Sequence[Sequence[int]], Words]


class Recording:
    """Keep every publish and every set-point of a tree while the `with` block runs.

    A set-point begins with its value at the start, if that is known. Each write that was done follows. A
    value that is both published and written is recorded from its publishes.

    >>> with robot.publishing(), robot.record() as recording:     # doctest: +SKIP
    ...     run()
    >>> times_s, angles = recording.series("j1.cpos")             # doctest: +SKIP
    """

    def __init__(self, publisher: Publisher, set_points: Iterable[WriteValue[Any]] = ()) -> None:
        self._publisher = publisher
        self._set_points = [value for value in set_points if getattr(value, "publish", None) is None]
        # by the values of a publish: the times, and the raw numbers at each time
        self._parts: dict[tuple[PublishedValue, ...], list[tuple[Sequence[float] | Times, Rows]]] = {}

    def _take(
        self, time_s: float, values: Sequence[PublishedValue], _: Sequence[Any], raws: Sequence[int]
    ) -> None:
        self._parts.setdefault(tuple(values), []).append(([time_s], [raws]))

    def _take_arrays(self, times: Times, values: Sequence[PublishedValue], raws: Words) -> None:
        self._parts.setdefault(tuple(values), []).append((times, raws))

    def _written(self, value: WriteValue[Any], raw: int) -> None:
        self._parts.setdefault((value,), []).append(([value.hardware.link.now_s()], [[raw]]))

    def __enter__(self) -> Self:
        for value in self._set_points:
            if value.raw is not None:
                self._written(value, value.raw)
            value.recorders = (*value.recorders, self._written)
        self._publisher.take_with(self._take, self._take_arrays)
        return self

    def __exit__(self, *_: object) -> None:
        self._publisher.take_no_more(self._take)
        for value in self._set_points:
            value.recorders = tuple(heard for heard in value.recorders if heard != self._written)

    def series(self, path: str) -> tuple[NDArray[np.float64], NDArray[Any]]:
        """Return (times in s, values) of one path, both of shape (n,). Raises UnknownName if nothing came.

        Values are float64, int64, uint64 or bool, as the type needs. Enumerations and packed values are
        numbers.
        """
        for values, samples in self._parts.items():
            for column, value in enumerate(values):
                if value.path == path:
                    parts = list(samples)  # a copy, because publishing may still go on
                    return (
                        np.concatenate([np.asarray(times, np.float64) for times, _ in parts]),
                        value.codec.decode_array(
                            np.concatenate([_column(rows, column) for _, rows in parts])
                        ),
                    )
        raise UnknownName(f"nothing was published for {path!r}, nor written to it")


def _column(rows: Rows, column: int) -> NDArray[np.uint64]:
    if isinstance(rows, np.ndarray):
        return rows[:, column].astype(np.uint64)
    return np.array([row[column] for row in rows], np.uint64)  # numbers of several words are too wide
