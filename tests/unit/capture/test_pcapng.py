# SPDX-License-Identifier: BSD-3-Clause
"""Captures of either writer: read whole, cut off and damaged."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from unitylink import connect
from unitylink.capture import Packet, PcapngWriter, read_packets
from unitylink.capture.pcapng import CaptureTruncated
from unitylink.errors import LinkNotFound, UnityLinkError, UrlError

PACKETS = st.lists(
    st.builds(
        Packet,
        time_s=st.integers(0, 1 << 40).map(lambda ns: ns / 1e9),
        direction=st.sampled_from(["sent", "received"]),
        data=st.binary(max_size=40),
        comment=st.text(max_size=20),
    ),
    max_size=10,
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return one folder for all examples. Making one for each takes longer than the rest of the test."""
    return tmp_path_factory.mktemp("capture")


def write(path: Path, packets: list[Packet]) -> bytes:
    path.unlink(missing_ok=True)
    with PcapngWriter(path) as writer:
        for packet in packets:
            writer.write(packet)
    return path.read_bytes()


@given(packets=PACKETS)
def test_what_is_written_is_read(packets: list[Packet], folder: Path) -> None:
    path = folder / "c.pcapng"
    write(path, packets)
    read = list(read_packets(path))
    assert [(p.direction, p.data, p.comment) for p in read] == [
        (p.direction, p.data, p.comment) for p in packets
    ]
    assert all(abs(a.time_s - b.time_s) < 1e-6 for a, b in zip(read, packets, strict=True))


@given(packets=PACKETS, data=st.data())
def test_a_file_cut_off_anywhere_gives_all_whole_packets(
    packets: list[Packet], data: st.DataObject, folder: Path
) -> None:
    path = folder / "c.pcapng"
    whole = write(path, packets)
    path.write_bytes(whole[: data.draw(st.integers(60, len(whole)))])
    seen = []
    try:
        for packet in read_packets(path):
            seen.append(packet)
    except CaptureTruncated as error:
        assert "cut off at byte" in str(error)
    assert [p.data for p in seen] == [p.data for p in packets][: len(seen)]


@given(packets=PACKETS, data=st.data())
def test_a_damaged_file_is_an_error_with_its_place_or_read(
    packets: list[Packet], data: st.DataObject, folder: Path
) -> None:
    path = folder / "c.pcapng"
    damaged = bytearray(write(path, packets))
    damaged[data.draw(st.integers(0, len(damaged) - 1))] ^= data.draw(st.integers(1, 255))
    path.write_bytes(damaged)
    try:
        list(read_packets(path))
    except UnityLinkError as error:
        assert str(error).startswith(str(path))


def test_other_files_are_refused_with_what_they_are(tmp_path: Path) -> None:
    text = tmp_path / "notes.txt"
    text.write_text("no capture at all")
    with pytest.raises(UnityLinkError, match="not a pcapng file"):
        list(read_packets(text))
    ethernet = tmp_path / "ethernet.pcapng"
    whole = bytearray(write(ethernet, []))
    at = whole.index(struct.pack("<II", 1, 32)) + 8
    whole[at : at + 2] = struct.pack("<H", 1)
    ethernet.write_bytes(whole)
    with pytest.raises(UnityLinkError, match="link type 1 is not a capture of a link"):
        list(read_packets(ethernet))
    with pytest.raises(UnityLinkError, match="No such file"):
        list(read_packets(tmp_path / "absent.pcapng"))


def test_a_block_that_claims_to_be_huge_counts_as_damaged_at_once(tmp_path: Path) -> None:
    path = tmp_path / "c.pcapng"
    whole = write(path, [Packet(0.0, "sent", b"#RLC\n")])
    for length in (1 << 24 | 4, 0xFFFFFFFC, 8, 13):
        path.write_bytes(whole + struct.pack("<II", 6, length))
        with pytest.raises(UnityLinkError, match=f"damaged at byte {len(whole)}: a block of {length} bytes"):
            list(read_packets(path))


@pytest.fixture
def lamp(tmp_path: Path) -> str:
    spec = tmp_path / "lamp.ul"
    spec.write_text("public lamp() { @led = 0x10: WRITE(); @light = 0x11: READ(); }")
    return f"sim:{spec}?plant=loopback"


def test_a_link_writes_all_it_sends_and_receives(lamp: str, tmp_path: Path) -> None:
    path = tmp_path / "a & b.pcapng"
    with connect(f"{lamp}&protocol=classic&trace={str(path).replace('&', '%26')}") as link:
        link.write(0x10, 7)
        link.read(0x10)
        statistics = link.statistics()
    packets = list(read_packets(path))
    sent = b"".join(p.data for p in packets if p.direction == "sent")
    received = b"".join(p.data for p in packets if p.direction == "received")
    assert len(sent) == statistics.bytes_sent
    assert len(received) == statistics.bytes_received
    assert b"#W:" in sent and b"#S_W" in received
    assert sorted(p.time_s for p in packets) == [p.time_s for p in packets]


def test_a_trace_that_cannot_be_written_says_so_before_the_port_is_opened(lamp: str, tmp_path: Path) -> None:
    with pytest.raises(LinkNotFound, match=r"trace=.*No such file.*folder that can be written"):
        connect(f"{lamp}&trace={tmp_path}/absent/t.pcapng")
    with pytest.raises(LinkNotFound, match="No space left"):
        connect(f"{lamp}&trace=/dev/full")
    with pytest.raises(UrlError, match="two hex digits"):
        connect("tcp://127.0.0.1:5555?trace=a%2")


def test_a_trace_on_a_full_disk_stays_valid_and_warns_at_the_end(lamp: str, tmp_path: Path) -> None:
    import resource

    path = tmp_path / "full.pcapng"
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    import signal

    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))
    try:
        with pytest.warns(RuntimeWarning, match="ends early"), connect(f"{lamp}&trace={path}") as link:
            for _ in range(100):
                assert link.read(0x11) == 0
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, ignored)
    assert 0 < path.stat().st_size <= 1000
    list(read_packets(path))  # it is whole, so there is no CaptureTruncated
