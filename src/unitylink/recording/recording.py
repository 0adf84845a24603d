# SPDX-License-Identifier: BSD-3-Clause
"""What a recording is: samples in the order they came, and the spec they belong to."""

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
    """Values that belong to one moment. `time_s` counts from 1970; `values` by path are numbers, truth
    values, names of enumeration members, or a mapping of fields."""

    time_s: float
    values: Mapping[str, Any]


@dataclass(frozen=True)
class Origin:
    """What a recording was made with: file name, text and hash of the spec, and the units of its values by
    path; empty where the file does not tell."""

    name: str = ""
    text: str = ""
    hash: str = ""
    units: Mapping[str, str] = field(default_factory=dict)


class RecordingTruncated(UnityLinkError):
    """A recording that was cut off; all samples before that have been given."""


class Writer(Protocol):
    """A recording being written. What was added is whole in the file however it ends; a full disk is an error
    that names the file and how many samples it holds."""

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
        """Put what was added into the file, whole: a program that is killed loses what came since."""
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
    """Make a recording; the ending of its name says in which format.

    `names` are the columns a CSV file begins with; without them those of the first sample. `topics` names,
    for MCAP, the topic of values that are sampled together; else it is made of their paths. Raises
    UnityLinkError for another ending, a file that cannot be written or, without `force`, exists already, a
    library that is not installed.
    """
    if _ending(path) == ".csv":
        from .csv_file import CsvWriter

        return CsvWriter(path, names, force=force)
    from .mcap_file import McapWriter

    return McapWriter(path, origin, topics, force=force)


def check_name(path: str | Path) -> None:
    """Raise the UnityLinkError of `create` for an ending no recording has, or a library that is absent."""
    if _ending(path) == ".mcap":
        from .mcap_file import need_library

        need_library()


def samples(path: str | Path) -> Iterator[Sample]:
    """Yield the samples of a recording in the order they were added.

    Raises UnityLinkError, with the place, for what is no recording; RecordingTruncated at the end of one that
    was cut off.
    """
    if _ending(path) == ".csv":
        from .csv_file import read_csv

        return read_csv(path)
    from .mcap_reader import read_mcap

    return read_mcap(path)


def origin(path: str | Path) -> Origin:
    """Return the spec a recording was made with, as far as the file tells; CSV files do not."""
    if _ending(path) == ".csv":
        return Origin()
    from .mcap_reader import read_origin

    return read_origin(path)


def is_number(value: Any) -> bool:
    """Is it a number, or truth value, that an item of a spec can have? It has 64 bits at most."""
    return isinstance(value, float) or (isinstance(value, int) and -(1 << 63) <= value < 1 << 64)


def _ending(path: str | Path) -> str:
    ending = Path(path).suffix.lower()
    if ending not in ENDINGS:
        raise UnityLinkError(f"{path}: a recording ends in {' or '.join(ENDINGS)}, not in '{ending}'")
    return ending
