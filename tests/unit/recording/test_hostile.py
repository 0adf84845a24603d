# SPDX-License-Identifier: BSD-3-Clause
"""Malicious recordings: their expanded size is bounded, and damage gives an error of ours."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from functools import cache
from pathlib import Path

import lz4.frame
import pytest
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.records import Channel, Chunk, Message
from mcap.writer import Writer

from unitylink.errors import UnityLinkError
from unitylink.recording import RecordingTruncated, origin, samples
from unitylink.recording.mcap_file import NAMES, ORIGIN

MEGABYTE = 1 << 20


def of_messages(data: bytes, count: int = 1, names: str = '["x"]') -> bytes:
    """Return the records of one chunk."""
    builder = RecordBuilder()
    Channel(id=1, topic="/x", message_encoding="json", metadata={NAMES: names}, schema_id=0).write(builder)
    one = RecordBuilder()
    Message(channel_id=1, data=data, log_time=1, publish_time=1, sequence=0).write(one)
    return bytes(builder.end() + one.end() * count)


def file_of(path: Path, compression: str, data: bytes, size: int, *, chunks: int = 1) -> Path:
    """Write an MCAP file with a chunk, `chunks` times, that claims to expand to `size` bytes."""
    builder = RecordBuilder()
    chunk = Chunk(
        compression=compression,
        data=data,
        message_start_time=0,
        message_end_time=0,
        uncompressed_crc=0,
        uncompressed_size=size,
    )
    chunk.write(builder)
    stream = io.BytesIO()
    writer = Writer(stream)
    writer.start()
    writer.finish()  # type: ignore[no-untyped-call]
    plain = stream.getvalue()
    head = 8 + 9 + int.from_bytes(plain[9:17], "little")  # the magic bytes and the header record
    path.write_bytes(plain[:head] + builder.end() * chunks + plain[head:])
    return path


@cache
def zeros(of_mb: int) -> bytes:
    """Return a frame of zstd that states its length."""
    return zstandard.compress(bytes(of_mb * MEGABYTE))


def unsized_zeros(of_mb: int) -> bytes:
    """Return a frame of zstd that does not state its length."""
    return zstandard.ZstdCompressor(write_content_size=False).compress(bytes(of_mb * MEGABYTE))


BOMBS: dict[str, Callable[[Path], Path]] = {
    "larger than any chunk": lambda path: file_of(path, "zstd", zeros(65), 65 * MEGABYTE),
    "larger than it says": lambda path: file_of(path, "zstd", zeros(65), 1000),
    "larger, and does not say": lambda path: file_of(path, "zstd", unsized_zeros(65), 1000),
    "claims more than there is": lambda path: file_of(path, "zstd", zeros(1), 1 << 62),
    "lz4": lambda path: file_of(path, "lz4", lz4.frame.compress(bytes(32 * MEGABYTE)), 1000),
    "many small": lambda path: file_of(path, "zstd", zeros(1), MEGABYTE, chunks=40),
}


@pytest.mark.parametrize("name", BOMBS)
def test_a_small_file_that_expands_to_a_large_one_is_refused(name: str, tmp_path: Path) -> None:
    path = BOMBS[name](tmp_path / "bomb.mcap")
    assert path.stat().st_size < MEGABYTE // 2
    with pytest.raises(RecordingTruncated, match="damaged before its first sample"):
        list(samples(path))


def test_a_bomb_of_samples_ends(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each record is a sample, so some are read. But not all of those that 40 kB can expand to are."""
    monkeypatch.setattr("unitylink.recording.mcap_reader._EXPANDED_BYTES", 1 << 16)
    records = of_messages(b'{"x":1}', 1000)
    path = file_of(tmp_path / "bomb.mcap", "zstd", zstandard.compress(records), len(records), chunks=30)
    assert path.stat().st_size < MEGABYTE // 4
    count = 0
    with pytest.raises(RecordingTruncated, match="damaged after sample"):
        for _ in samples(path):
            count += 1
    assert 1000 <= count < 30 * 1000


@pytest.mark.parametrize(
    "data",
    [
        b"[" * 100_000,
        b'{"x":' + b"9" * 5000 + b"}",
        b'{"x":' + b"9" * 400 + b"}",
        b'{"x":[1]}',
        b'{"x":{"a":{"b":1}}}',
        b"[1]",
        b'{"y":1}',
        b"\xff",
        b"",
    ],
    ids=lambda data: repr(data[:12]),
)
def test_messages_that_are_no_values_are_damage(data: bytes, tmp_path: Path) -> None:
    records = of_messages(data)
    path = file_of(tmp_path / "r.mcap", "", records, len(records))
    with pytest.raises(RecordingTruncated, match="damaged before its first sample"):
        list(samples(path))


@pytest.mark.parametrize("names", ["", "1", "{}", '"x"', "[1]", "[" * 100_000, "[null]"])
def test_paths_that_are_none_are_damage(names: str, tmp_path: Path) -> None:
    records = of_messages(b'{"x":1}', names=names)
    path = file_of(tmp_path / "r.mcap", "", records, len(records))
    with pytest.raises(RecordingTruncated, match="damaged before its first sample"):
        list(samples(path))


@pytest.mark.parametrize("units", ["", "1", "[]", '{"x":1}', "[" * 100_000])
def test_units_that_are_none_are_damage(units: str, tmp_path: Path) -> None:
    path = tmp_path / "r.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        writer.add_metadata(ORIGIN, {"units": units})
        writer.finish()  # type: ignore[no-untyped-call]
    with pytest.raises(UnityLinkError, match="damaged: its units cannot be read"):
        origin(path)


@pytest.mark.parametrize(
    "row",
    [
        "nan,1",
        "inf,1",
        "1e300,1",
        "0," + "9" * 400,
        "0," + "9" * 5000,
        '0,"{""a"":[1]}"',
        '0,"{' + "[" * 100_000 + '"',
        "x,1",
        "0",
    ],
    ids=lambda row: row[:12],
)
def test_invalid_rows_are_refused_with_their_line(row: str, tmp_path: Path) -> None:
    path = tmp_path / "r.csv"
    path.write_text(f"time_s,x\n0.0,1\n{row}\n")
    with pytest.raises(UnityLinkError, match=r"r\.csv: line 3: "):
        list(samples(path))


def test_what_expands_as_recordings_do_is_read(tmp_path: Path) -> None:
    records = of_messages(json.dumps({"x": 1.5}).encode(), 1000)
    for compression, data in (("zstd", zstandard.compress(records)), ("lz4", lz4.frame.compress(records))):
        path = file_of(tmp_path / f"{compression}.mcap", compression, bytes(data), len(records))
        assert [sample.values for sample in samples(path)] == [{"x": 1.5}] * 1000
