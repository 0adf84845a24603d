# SPDX-License-Identifier: BSD-3-Clause
"""Recordings as MCAP. Values that come together share a channel, with messages in JSON and a schema.

Foxglove and PlotJuggler open it directly: `j1.cpos` is the field `cpos` of the object `j1`. The format is
described at https://mcap.dev/spec. The library of the format writes and reads it.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING

from unitylink.errors import UnityLinkError
from unitylink.optional import absent
from unitylink.output_file import create_output

from .json_messages import JsonMessage, schema_of, steps
from .recording import Origin, Sample

if TYPE_CHECKING:
    from typing_extensions import Self

_CHUNK_BYTES = 1 << 16
ORIGIN = "unitylink"  # the metadata record with the spec
NAMES = "names"  # a channel's metadata: the paths, in order
_NAMED = 3  # the most names that are joined in a topic's name


def need_library() -> None:
    """Raise ToolError if the format's library is not installed."""
    try:
        import mcap  # noqa: F401
    except ImportError:
        raise absent("mcap", "a recording in MCAP, unlike one in CSV,") from None


class _Counting:
    """A file that knows how many of its bytes are valid. When the disk is full, it ends there."""

    def __init__(self, path: str | Path, *, force: bool) -> None:
        self.file = open(create_output(path, force=force), "wb", buffering=0)  # noqa: SIM115  # by close()
        self.size_bytes = 0

    def write(self, data: bytes) -> int:
        view = memoryview(data)
        done = 0
        while done < len(view):
            done += self.file.write(view[done:]) or 0
        self.size_bytes += done
        return done

    def flush(self) -> None:
        pass

    def tell(self) -> int:
        return self.size_bytes

    def close(self) -> None:
        self.file.close()


class McapWriter:
    """Writes chunks of 64 KiB. Each is whole before the next one begins."""

    def __init__(
        self,
        path: str | Path,
        origin: Origin,
        topics: Mapping[tuple[str, ...], str] | None = None,
        *,
        force: bool = False,
    ) -> None:
        need_library()
        from mcap.writer import CompressionType
        from mcap.writer import Writer as Library

        self.path = path
        self.count = 0
        self._file = _Counting(path, force=force)
        self._channels: dict[tuple[str, ...], tuple[int, JsonMessage]] = {}  # by paths; with the channel's id
        self._topics = {} if topics is None else topics  # the caller adds to them later, so this is no copy
        self._units = origin.units
        self._taken: set[str] = set()  # topics
        self._whole = (0, 0)  # (samples, bytes) that are certainly in the file
        self._failed = False
        self._writer = Library(
            self._file,  # type: ignore[arg-type]
            chunk_size=_CHUNK_BYTES,
            compression=CompressionType.ZSTD,
        )
        with _errors(self):
            self._writer.start(profile="", library="unitylink")
            known = {"spec": origin.name, "text": origin.text, "hash": origin.hash}
            known["units"] = json.dumps(dict(origin.units), ensure_ascii=False)
            self._writer.add_metadata(ORIGIN, known)

    @property
    def size_bytes(self) -> int:
        return self._file.size_bytes

    def add(self, sample: Sample) -> None:
        """Add a message on the channel of its set of paths."""
        names = tuple(sample.values)
        with _errors(self):
            known = self._channels.get(names)
            if known is None:
                known = self._channels[names] = (self._register(names, sample), JsonMessage(names))
            channel, message = known
            text = message.text(tuple(sample.values.values()))
            time_ns = round(sample.time_s * 1e9)
            before = self._file.size_bytes
            self._writer.add_message(channel, time_ns, text.encode(), time_ns, self.count & 0xFFFFFFFF)
            self.count += 1
            if self._file.size_bytes != before:
                self._whole = (self.count, self._file.size_bytes)

    def flush(self) -> None:
        """End the current chunk, so that its samples stay in the file if the program is killed."""
        with _errors(self):
            if self._whole[0] != self.count:
                self._writer.flush()  # type: ignore[no-untyped-call]
                self._whole = (self.count, self._file.size_bytes)

    def _register(self, names: tuple[str, ...], sample: Sample) -> int:
        topic = self._topics.get(names) or _topic(names)
        count = 1
        while topic in self._taken:  # other values need another schema, and so another topic
            count += 1
            topic = f"{topic.removesuffix(f'_{count - 1}')}_{count}"
        self._taken.add(topic)
        title = "unitylink" + topic.replace("/", ".")
        schema = {"title": title, **schema_of(sample.values, self._units)}
        schema_id = self._writer.register_schema(
            title, "jsonschema", json.dumps(schema, separators=(",", ":"), ensure_ascii=False).encode()
        )
        return self._writer.register_channel(topic, "json", schema_id, {NAMES: json.dumps(names)})

    def close(self) -> None:
        """Write the index and close the file."""
        if self._file.file.closed:
            return
        try:
            if not self._failed:
                with _errors(self):
                    self._writer.finish()  # type: ignore[no-untyped-call]
        finally:
            self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self.close()
        except UnityLinkError:
            if error is None:  # otherwise the first error says more
                raise


class _errors:
    """Turn an error of the disk into one that names the file. Cut the file after its last whole chunk."""

    def __init__(self, writer: McapWriter) -> None:
        self.writer = writer

    def __enter__(self) -> None: ...

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        if isinstance(error, OSError):
            writer = self.writer
            writer._failed = True
            count, size = writer._whole
            if size:
                with suppress(OSError):  # a pipe
                    os.ftruncate(writer._file.file.fileno(), size)
            raise UnityLinkError(
                f"{writer.path}: {error.strerror or error}; it holds the first {count} samples, whole"
            ) from error


def _topic(names: tuple[str, ...]) -> str:
    """Return a topic for its contents: `/j1` for j1.cpos and j1.spd, `/x_y` for x.a and y.a."""
    first = list(dict.fromkeys(name.partition(".")[0] for name in names))
    if len(first) == 1:
        return "/" + "/".join(steps(first[0]))
    shown = ["".join(steps(name)) for name in first]
    more = len(shown) - _NAMED
    return "/" + "_".join(shown if more <= 1 else [*shown[:_NAMED], "and", str(more), "more"])
