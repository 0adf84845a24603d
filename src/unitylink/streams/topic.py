# SPDX-License-Identifier: BSD-3-Clause
"""Values that are sampled together, under one name, as a reader may see them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from unitylink.recording.json_messages import JsonMessage, schema_of
from unitylink.values import Quantity, plain

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from unitylink.layer2_message.native_link import Words
    from unitylink.layer4_data import Value
    from unitylink.server.scopes import Rights

    Rows = Union[Sequence[Sequence[int]], Words]


@dataclass(frozen=True)
class Batch:
    """Samples that have come: (n,) times in s since 1970, and n rows of raw numbers, one for each value."""

    times_s: NDArray[np.float64]
    rows: Rows

    def thinned(self, most_hz: float) -> Iterator[tuple[float, Sequence[int]]]:
        """Yield the last sample of each 1 / `most_hz` s. The newest of all is always among them.

        >>> few = Batch(np.array([0.0, 0.3, 0.6, 1.1]), [[1], [2], [3], [4]])
        >>> [row for _, row in few.thinned(1.0)]
        [[3], [4]]
        """
        slot = np.floor(self.times_s * most_hz)
        for number in np.flatnonzero(np.append(slot[1:] != slot[:-1], True)).tolist():
            yield float(self.times_s[number]), self.rows[number]


class Topic:
    """The values of one publish. `name` is that of the topic in a recording. `rate_hz` is 0 on an event."""

    def __init__(self, name: str, values: Sequence[Value[Any]], rate_hz: float) -> None:
        self.name, self.values, self.rate_hz = name, tuple(values), rate_hz

    def view(self, rights: Rights) -> View | None:
        """Return what somebody with these rights sees of it, or None if it is nothing."""
        columns = [n for n, value in enumerate(self.values) if rights.allow("read", value.path)]
        return View(self, columns) if columns else None


class View:
    """Some values of a topic. `values` and `paths` name them."""

    def __init__(self, topic: Topic, columns: Sequence[int]) -> None:
        self.topic, self._columns = topic, tuple(columns)
        self.values = tuple(topic.values[column] for column in columns)
        self.paths = tuple(value.path for value in self.values)
        self._message = JsonMessage(self.paths)

    @cached_property
    def schema(self) -> dict[str, Any]:
        """The JSON schema of the messages. The units are in its descriptions."""
        sample = {value.path: like(value.quantity) for value in self.values}
        return schema_of(sample, {value.path: value.unit for value in self.values})

    def plain(self, row: Sequence[int]) -> tuple[Any, ...]:
        """Return a sample as values for JSON: enumerations by name, packed bits as objects."""
        return tuple(plain(value, one.quantity) for one, value in self._decoded(row))

    def numbers(self, row: Sequence[int]) -> tuple[Any, ...]:
        """Return a sample as numbers, as far as there are: enumerations by number."""
        return tuple(
            int(value) if one.quantity.type.kind == "enum" else plain(value, one.quantity)
            for one, value in self._decoded(row)
        )

    def text(self, values: tuple[Any, ...]) -> str:
        """Return the JSON of what `plain` or `numbers` returned."""
        return self._message.text(values)

    def _decoded(self, row: Sequence[int]) -> Iterator[tuple[Value[Any], Any]]:
        for column, value in zip(self._columns, self.values, strict=True):
            yield value, value.codec.decode(int(row[column]))


Batches = Mapping[Topic, Batch]


def like(quantity: Quantity) -> Any:
    """Return a value whose type in JSON is that of all values of the quantity."""
    kind = quantity.type
    if kind.kind == "bits":
        return {field.name: like(Quantity.of(field)) for field in kind.fields}
    return {"bool": False, "enum": ""}.get(kind.kind, 0.0)
