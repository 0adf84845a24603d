# SPDX-License-Identifier: BSD-3-Clause
"""The formats of a recording. The ending of a file's name chooses the format."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from types import MappingProxyType

from unitylink.errors import UnityLinkError

from .recording import Origin, Sample, Writer

ENDINGS = (".mcap", ".csv")
_NO_TOPICS: Mapping[tuple[str, ...], str] = MappingProxyType({})


def create(
    path: str | Path,
    origin: Origin,
    names: tuple[str, ...] = (),
    *,
    topics: Mapping[tuple[str, ...], str] = _NO_TOPICS,
    force: bool = False,
) -> Writer:
    """Make a recording. The ending of its name chooses the format.

    `names` are the first columns of a CSV file. Without them, the names of the first sample are taken.
    `topics`, for MCAP, gives the topic of values that are sampled together. Without it, the topic is made
    from their paths. Raises UnityLinkError for another ending, for a file that cannot be written or already
    exists (without `force`), and for a library that is not installed.
    """
    if _ending(path) == ".csv":
        from .csv_file import CsvWriter

        return CsvWriter(path, names, force=force)
    from .mcap_file import McapWriter

    return McapWriter(path, origin, topics, force=force)


def check_name(path: str | Path) -> None:
    """Raise the UnityLinkError of `create` for a wrong ending or a missing library."""
    if _ending(path) == ".mcap":
        from .mcap_file import need_library

        need_library()


def samples(path: str | Path) -> Iterator[Sample]:
    """Yield the samples of a recording in the order in which they were added.

    Raises UnityLinkError, with the place, if the file is not a recording. Raises RecordingTruncated at the
    end of a recording that was cut off.
    """
    if _ending(path) == ".csv":
        from .csv_file import read_csv

        return read_csv(path)
    from .mcap_reader import read_mcap

    return read_mcap(path)


def origin(path: str | Path) -> Origin:
    """Return the spec of a recording, as far as the file has it. CSV files do not have it."""
    if _ending(path) == ".csv":
        return Origin()
    from .mcap_reader import read_origin

    return read_origin(path)


def _ending(path: str | Path) -> str:
    ending = Path(path).suffix.lower()
    if ending not in ENDINGS:
        raise UnityLinkError(f"{path}: a recording ends in {' or '.join(ENDINGS)}, not in '{ending}'")
    return ending
