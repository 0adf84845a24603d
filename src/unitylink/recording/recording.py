# SPDX-License-Identifier: BSD-3-Clause
"""A recording: samples in the order in which they came, and their spec."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType, TracebackType
from typing import TYPE_CHECKING, Any, Protocol

from unitylink.errors import UnityLinkError

if TYPE_CHECKING:
    from typing_extensions import Self

ENDINGS = (".mcap", ".csv")
_NO_TOPICS: Mapping[tuple[str, ...], str] = MappingProxyType({})


@dataclass(frozen=True)
class Sample:
    """Values that belong to one moment. `time_s` counts from 1970. `values`, by path, are numbers, truth
    values, names of enumeration members, or a mapping of fields."""

    time_s: float
    values: Mapping[str, Any]


@dataclass(frozen=True)
class Origin:
    """What a recording was made with: file name, text and hash of the spec, and the units of its values by
    path. Each is empty if the file does not tell."""

    name: str = ""
    text: str = ""
    hash: str = ""
    units: Mapping[str, str] = field(default_factory=dict)


class RecordingTruncated(UnityLinkError):
    """A recording that was cut off. All samples before that place have been returned."""


class Writer(Protocol):
    """A recording being written. The file holds whole samples, however the program ends. A full disk is an
    error that names the file and how many samples it holds."""

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
        """Put the added samples into the file. A program that is killed loses only later ones."""
        ...

    def close(self) -> None: ...
    def __enter__(self) -> Self: ...
    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...


def create(
    path: str | Path,
    origin: Origin,
    names: tuple[str, ...] = (),
    *,
    topics: Mapping[tuple[str, ...], str] = _NO_TOPICS,
    force: bool = False,
) -> Writer:
    """Make a recording. The ending of its name chooses the format.

    `names` are the first columns of a CSV file. Without them those of the first sample are taken. `topics`
    names, for MCAP, the topic of values that are sampled together. Otherwise it is made of their paths.
    Raises UnityLinkError for another ending, for a file that cannot be written or already exists (without
    `force`), and for a library that is not installed.
    """
    if _ending(path) == ".csv":
        from .csv_file import CsvWriter

        return CsvWriter(path, names, force=force)
    from .mcap_file import McapWriter

    return McapWriter(path, origin, topics, force=force)


def check_name(path: str | Path) -> None:
    """Raise the UnityLinkError of `create` for a wrong ending or an absent library."""
    if _ending(path) == ".mcap":
        from .mcap_file import need_library

        need_library()


def samples(path: str | Path) -> Iterator[Sample]:
    """Yield the samples of a recording in the order in which they were added.

    Raises UnityLinkError, with the place, if the file is not a recording. Raises RecordingTruncated at the
    end of one that was cut off.
    """
    if _ending(path) == ".csv":
        from .csv_file import read_csv

        return read_csv(path)
    from .mcap_reader import read_mcap

    return read_mcap(path)


def origin(path: str | Path) -> Origin:
    """Return the spec of a recording, as far as the file tells. CSV files do not tell it."""
    if _ending(path) == ".csv":
        return Origin()
    from .mcap_reader import read_origin

    return read_origin(path)


def is_number(value: Any) -> bool:
    """Return whether it is a number or truth value of at most 64 bits, as an item of a spec can have."""
    return isinstance(value, float) or (isinstance(value, int) and -(1 << 63) <= value < 1 << 64)


def _ending(path: str | Path) -> str:
    ending = Path(path).suffix.lower()
    if ending not in ENDINGS:
        raise UnityLinkError(f"{path}: a recording ends in {' or '.join(ENDINGS)}, not in '{ending}'")
    return ending
