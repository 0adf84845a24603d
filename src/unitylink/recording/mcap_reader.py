# SPDX-License-Identifier: BSD-3-Clause
"""Reads recordings in MCAP. Any file, even a damaged or hostile one, gives samples or an error of ours.

The library of the format takes records apart. If it or JSON raises an exception, the file is damaged. Chunks
are decompressed here, because the library sets no limit, neither for one chunk nor for all together.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from unitylink.errors import UnityLinkError

from .mcap_file import NAMES, ORIGIN, need_library
from .recording import Origin, RecordingTruncated, Sample, is_number

if TYPE_CHECKING:
    from mcap.records import Chunk

_RECORD_BYTES_MAX = 1 << 26  # limit of one record, and of one decompressed chunk
_EXPANDED_BYTES = 1 << 22  # any file may expand to so many bytes,
_EXPANSION = 100  # or to this multiple of its size; a chunk's index keeps real recordings far below
_STEP = re.compile(r"[^.\[\]]+")


class _DamagedError(ValueError):
    """The file holds something that no valid recording has."""


def read_mcap(path: str | Path) -> Iterator[Sample]:
    """Yield the samples in the order in which they were added."""
    count = 0
    paths: dict[int, tuple[Any, list[str]]] = {}  # by channel
    for name, record in _records(path):
        if name == "message":
            channel, message = record
            try:
                known = paths.get(channel.id)
                if known is None or known[0] is not channel:
                    known = paths[channel.id] = channel, _paths(channel.metadata.get(NAMES, "[]"))
                values = _flat(json.loads(message.data), known[1])
            except (ValueError, RecursionError) as error:
                raise _cut_off(path, count) from error
            yield Sample(message.log_time / 1e9, values)
            count += 1


def read_origin(path: str | Path) -> Origin:
    """Return the spec at the beginning of the file."""
    for name, record in _records(path):
        if name == "message":
            break
        if record.name == ORIGIN:
            known = record.metadata
            try:
                units = json.loads(known.get("units", "{}"))
            except (ValueError, RecursionError):
                units = None
            if not isinstance(units, dict) or not all(isinstance(unit, str) for unit in units.values()):
                raise UnityLinkError(f"{path}: damaged: its units cannot be read")
            return Origin(known.get("spec", ""), known.get("text", ""), known.get("hash", ""), units)
    return Origin()


def _paths(text: str) -> list[str]:
    paths = json.loads(text)
    if not isinstance(paths, list) or not all(isinstance(path, str) for path in paths):
        raise _DamagedError("no list of paths")
    return paths


def _flat(message: Any, paths: list[str]) -> dict[str, Any]:
    values = {}
    for name in paths:
        value = message
        for step in _STEP.findall(name):
            if not isinstance(value, dict) or step not in value:
                raise _DamagedError(f"a message without {name}")
            value = value[step]
        if not _is_value(value):
            raise _DamagedError(f"a value of {name} that is not a value")
        values[name] = value
    return values


def _is_value(value: Any) -> bool:
    if isinstance(value, dict):  # a packed value
        return not any(isinstance(part, dict) or not _is_value(part) for part in value.values())
    return value is None or isinstance(value, str) or is_number(value)


def _records(path: str | Path) -> Iterator[tuple[str, Any]]:
    """Yield ("message", (channel, message)) and ("metadata", record) from front to back.

    The index is not used.
    """
    need_library()
    from mcap.exceptions import InvalidMagic
    from mcap.records import Channel, Chunk, Footer, Message, Metadata
    from mcap.stream_reader import StreamReader

    count = 0
    channels: dict[int, Any] = {}
    try:
        with open(path, "rb") as stream:
            left = _EXPANDED_BYTES + _EXPANSION * os.fstat(stream.fileno()).st_size
            found = StreamReader(stream, emit_chunks=True, record_size_limit=_RECORD_BYTES_MAX).records
            record: Any = None
            while True:
                try:
                    record = next(found, None)
                    if record is None:
                        raise EOFError("no footer")
                    inner = [record]
                    if isinstance(record, Chunk):
                        left -= record.uncompressed_size
                        inner = _of_chunk(record, left)
                except OSError:
                    raise
                except (
                    Exception
                ) as error:  # the library's own error, and those from its parsing of damaged bytes
                    if isinstance(error, InvalidMagic) and not count:
                        raise UnityLinkError(f"{path}: not an MCAP file ({error})") from error
                    raise _cut_off(path, count) from error
                for one in inner:
                    if isinstance(one, Channel):
                        channels[one.id] = one
                    elif isinstance(one, Metadata):
                        yield "metadata", one
                    elif isinstance(one, Message):
                        if one.channel_id not in channels:
                            raise _cut_off(path, count)
                        yield "message", (channels[one.channel_id], one)
                        count += 1
                if isinstance(record, Footer):
                    return
    except (OSError, ValueError) as error:  # a name with a NUL raises ValueError
        raise UnityLinkError(f"{path}: {getattr(error, 'strerror', None) or error}") from error


def _of_chunk(chunk: Chunk, left: int) -> list[Any]:
    """Return the records of a chunk. It must expand to its stated size, and to at most `left` bytes."""
    from mcap.records import Chunk as Plain
    from mcap.stream_reader import breakup_chunk

    size = chunk.uncompressed_size
    if size > _RECORD_BYTES_MAX or left < 0:
        raise _DamagedError(f"a chunk of {len(chunk.data)} bytes that expands to {size}")
    data = chunk.data
    if chunk.compression == "zstd":
        import zstandard

        if zstandard.frame_content_size(data) not in (-1, size):  # -1 means that the frame does not state it
            raise _DamagedError("a chunk whose size differs from its header")
        data = zstandard.ZstdDecompressor().decompress(data, max_output_size=size)
    elif chunk.compression == "lz4":
        from lz4.frame import LZ4FrameDecompressor  # type: ignore[import-untyped]

        data = LZ4FrameDecompressor().decompress(data, max_length=size + 1)
    if len(data) != size:
        raise _DamagedError("a chunk whose size differs from its header")
    plain = Plain(
        compression="",
        data=data,
        message_start_time=chunk.message_start_time,
        message_end_time=chunk.message_end_time,
        uncompressed_crc=chunk.uncompressed_crc,
        uncompressed_size=size,
    )
    return breakup_chunk(plain, validate_crc=True)


def _cut_off(path: str | Path, count: int) -> RecordingTruncated:
    if count == 0:
        return RecordingTruncated(f"{path}: cut off or damaged before its first sample")
    return RecordingTruncated(f"{path}: cut off or damaged after sample {count}; those before it were read")
