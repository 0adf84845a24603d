# SPDX-License-Identifier: BSD-3-Clause
"""Recordings as CSV: a column `time_s` and one for each path. A value that a sample lacks is empty."""

from __future__ import annotations

import csv
import io
import json
import math
import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, TextIO

from unitylink.errors import UnityLinkError
from unitylink.output_file import create_output

from .recording import RecordingTruncated, Sample, is_number

if TYPE_CHECKING:
    from typing_extensions import Self

_TIME = "time_s"
_FLUSH_BYTES = 1 << 15
_TIME_MOST_S = 1e11  # the year 5138


class CsvWriter:
    """A writer that writes only whole lines. So the file is valid CSV, whatever ends the program."""

    def __init__(self, path: str | Path, names: tuple[str, ...] = (), *, force: bool = False) -> None:
        self.path = path
        self.count = 0
        self.size_bytes = 0
        self._columns = names
        self._waiting = io.StringIO()
        self._written = 0  # samples that are in the file
        self._rows = csv.writer(self._waiting, lineterminator="\n")
        self._file = create_output(path, force=force)

    def add(self, sample: Sample) -> None:
        """Add a line."""
        if self.count == 0:
            self._columns = self._columns or tuple(sample.values)
            self._rows.writerow((_TIME, *self._columns))
        row = [f"{sample.time_s:.9f}", *("" for _ in self._columns)]
        for place, name in enumerate(self._columns, 1):
            if name in sample.values:
                row[place] = _text(sample.values[name])
        if unknown := sample.values.keys() - set(self._columns):
            raise UnityLinkError(f"{self.path}: no column for {', '.join(sorted(unknown))}")
        self._rows.writerow(row)
        self.count += 1
        if self._waiting.tell() > _FLUSH_BYTES:
            self.flush()

    def flush(self) -> None:
        """Write the waiting lines to the file, so that they survive the end of the program."""
        data = self._waiting.getvalue().encode("utf-8")
        self._waiting.seek(0)
        self._waiting.truncate()
        done = 0
        try:
            while done < len(data):
                done += os.write(self._file, data[done:])
        except OSError as error:
            whole = data[:done].rfind(b"\n") + 1
            os.ftruncate(self._file, self.size_bytes + whole)
            kept = self._written + data[:whole].count(b"\n")
            raise UnityLinkError(
                f"{self.path}: {error.strerror or error}; it holds the first {kept} lines, whole"
            ) from error
        self.size_bytes += done
        self._written = self.count

    def close(self) -> None:
        """Write the remaining lines and close the file."""
        if self._file >= 0:
            try:
                self.flush()
            finally:
                os.close(self._file)
                self._file = -1

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if error is None:
            self.close()
            return
        with suppress(UnityLinkError):  # the first error says more
            self.close()


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return "1" if value else "0"
    if isinstance(value, dict):
        return json.dumps(value, separators=(",", ":"))
    return "" if isinstance(value, float) and math.isnan(value) else str(value)


def read_csv(path: str | Path) -> Iterator[Sample]:
    """Yield the samples of a CSV file with a column `time_s`."""
    try:
        with open(path, encoding="utf-8", newline="") as stream:
            rows = csv.reader(_lines(stream, path))
            header = next(rows, None)
            if header is None:
                raise RecordingTruncated(f"{path}: cut off before its first line")
            if not header or header[0] != _TIME:
                raise UnityLinkError(
                    f"{path}: its first column is not {_TIME}: this is not a recording of Unity-Link"
                )
            for row in rows:
                if len(row) != len(header):
                    raise UnityLinkError(f"{path}: line {rows.line_num}: {len(row)} columns of {len(header)}")
                try:
                    values = {
                        name: _value(text) for name, text in zip(header[1:], row[1:], strict=True) if text
                    }
                    time_s = float(row[0])
                    if not abs(time_s) < _TIME_MOST_S:
                        raise ValueError(f"a time of {time_s}")
                    yield Sample(time_s, values)
                except (ValueError, RecursionError) as error:
                    raise UnityLinkError(f"{path}: line {rows.line_num}: {error}") from error
    except (OSError, ValueError, csv.Error) as error:
        raise UnityLinkError(f"{path}: {getattr(error, 'strerror', None) or error}") from error


def _lines(stream: TextIO, path: str | Path) -> Iterator[str]:
    """Yield only whole lines, because a number without its last digits is still a number."""
    for number, line in enumerate(stream, 1):
        if not line.endswith("\n"):
            raise RecordingTruncated(f"{path}: cut off in line {number}; the lines before it were read")
        yield line


def _value(text: str) -> Any:
    if text.startswith("{"):
        fields = json.loads(text)
        if not all(isinstance(field, str) or is_number(field) for field in fields.values()):
            raise ValueError(f"{text[:40]} is not a packed value")
        return fields
    for kind in (int, float):
        try:
            number = kind(text)
        except ValueError:
            continue
        if not is_number(number) or (math.isinf(number) and text[-1:].isdigit()):
            raise ValueError("a number that no item can have")
        return number
    return text  # a member of an enumeration
