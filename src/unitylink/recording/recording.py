# SPDX-License-Identifier: BSD-3-Clause
"""A recording: samples in the order in which they came, with their spec."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import TracebackType
from typing import TYPE_CHECKING, Any, Protocol

from unitylink.errors import UnityLinkError

if TYPE_CHECKING:
    from typing_extensions import Self


@dataclass(frozen=True)
class Sample:
    """Values of one moment.

    `time_s` counts from 1970. `values`, by path, are numbers, truth values, names of enumeration members, or
    a mapping of fields.
    """

    time_s: float
    values: Mapping[str, Any]


@dataclass(frozen=True)
class Origin:
    """What a recording was made with: file name, text and hash of the spec, and the units of its values by
    path.

    Each is empty if the file does not have it.
    """

    name: str = ""
    text: str = ""
    hash: str = ""
    units: Mapping[str, str] = field(default_factory=dict)


class RecordingTruncated(UnityLinkError):
    """A recording was cut off. All samples before that place have been returned."""


class Writer(Protocol):
    """A recording that is being written.

    The file holds whole samples, however the program ends. A full disk is an error. It names the file and how
    many samples it holds.
    """

    @property
    def count(self) -> int:
        """How many samples there are."""
        ...

    @property
    def size_bytes(self) -> int:
        """How large the file is so far."""
        ...

    def add(self, sample: Sample) -> None: ...
    def flush(self) -> None:
        """Write the added samples to the file. A program that is killed loses only later ones."""
        ...

    def close(self) -> None: ...
    def __enter__(self) -> Self: ...
    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...


def is_number(value: Any) -> bool:
    """Return whether it is a number or truth value of at most 64 bits, as for an item of a spec."""
    return isinstance(value, float) or (isinstance(value, int) and -(1 << 63) <= value < 1 << 64)
