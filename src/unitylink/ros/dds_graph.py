# SPDX-License-Identifier: BSD-3-Clause
"""Tells ROS 2 that a participant of DDS is a node: on `ros_discovery_info`, with the end points it has.

With it `ros2 node list` and `ros2 node info` show a node that runs without ROS. The releases before Iron have
longer identifiers in this message, and a peer that gets one of the other length stops to listen. So the node
first hears what its peers send, and answers in their form. Without peers there is nobody to tell.
"""

from __future__ import annotations

import logging
import struct
import threading
from typing import Any

from .dds_reader import DdsReader
from .dds_types import DdsTypes
from .standard import Fields

_log = logging.getLogger("unitylink.ros")
TOPIC = "ros_discovery_info"
SIZES = (16, 24)  # of an identifier: since Iron, and before
_HEADER = b"\0\1\0\0"  # CDR, little endian
_GID, _NODE, _PARTICIPANT = (
    f"rmw_dds_common/{name}" for name in ("Gid", "NodeEntitiesInfo", "ParticipantEntitiesInfo")
)


class DdsGraph:
    """The node that a participant is. `add_reader` and `add_writer` may be called at any time."""

    def __init__(self, participant: Any, namespace: str, name: str, reader: DdsReader) -> None:
        from cyclonedds.core import Policy, Qos
        from cyclonedds.pub import DataWriter
        from cyclonedds.sub import DataReader
        from cyclonedds.topic import Topic as DdsTopic
        from cyclonedds.util import duration

        self._participant: bytes = participant.guid.bytes
        self._node = (f"/{namespace.strip('/')}", name)
        self._readers: list[bytes] = []
        self._writers: list[bytes] = []
        self._whole = False
        self._size = 0
        self._lock = threading.Lock()
        # durable, so that a peer that comes later is told too
        qos = Qos(
            Policy.Reliability.Reliable(duration(milliseconds=100)),
            Policy.Durability.TransientLocal,
            Policy.History.KeepLast(1),
            Policy.DataRepresentation(use_cdrv0_representation=True),
        )
        others = Qos(Policy.IgnoreLocal.Participant, Policy.History.KeepAll, base=qos)
        self._kind = _bytes_as_messages()
        topic = DdsTopic(participant, TOPIC, self._kind, qos=qos)
        self._writer = DataWriter(participant, topic, qos=qos)
        reader.add(DataReader(participant, topic, qos=others), TOPIC, lambda told: self.hear(told.gid))

    def add_reader(self, reader: Any) -> None:
        self._add(self._readers, reader)

    def add_writer(self, writer: Any) -> None:
        self._add(self._writers, writer)

    def start(self) -> None:
        """Tell of the node as soon as a peer is there. Call it when the node has its first end points."""
        with self._lock:
            self._whole = True
            self._tell()

    def hear(self, message: bytes) -> None:
        """Take what a peer tells of itself."""
        size = identifier_size(message)
        with self._lock:
            if size in (0, self._size):
                return
            if self._size:
                _log.warning(
                    "peers of ROS 2 of before and since Iron are here; `ros2 node list` needs one kind"
                )
                return
            self._size = size
            self._tell()

    def _add(self, among: list[bytes], entity: Any) -> None:
        with self._lock:
            among.append(entity.guid.bytes)
            self._tell()

    def _tell(self) -> None:
        if self._whole and self._size:
            told = encode(self._size, self._participant, self._node, self._readers, self._writers)
            self._writer.write(self._kind(told, []))


def encode(
    size: int, participant: bytes, node: tuple[str, str], readers: list[bytes], writers: list[bytes]
) -> bytes:
    """Return a ParticipantEntitiesInfo of one node, with identifiers of `size` bytes."""
    packed = participant.ljust(size, b"\0") + struct.pack("<I", 1)
    for text in node:
        raw = text.encode() + b"\0"
        packed += struct.pack("<I", len(raw)) + raw
        packed += bytes(-len(packed) % 4)
    for identifiers in (readers, writers):
        packed += struct.pack("<I", len(identifiers))
        packed += b"".join(one.ljust(size, b"\0") for one in identifiers)
    return _HEADER + packed


def identifier_size(message: bytes) -> int:
    """Return how long the identifiers of a ParticipantEntitiesInfo are, 0 if it is none.

    >>> node = ("/lab", "arm")
    >>> [identifier_size(encode(size, bytes(16), node, [bytes(16)], [])) for size in SIZES]
    [16, 24]
    """
    return next((size for size in SIZES if _ends(message, size)), 0)


def _ends(message: bytes, size: int) -> bool:
    """Does a message with identifiers of `size` bytes end where its bytes end?"""
    if len(message) < len(_HEADER) or message[0] != 0 or message[1] > 1:
        return False
    body, count = message[len(_HEADER) :], struct.Struct("<I" if message[1] else ">I")
    at = size

    def number() -> int:
        nonlocal at
        at += -at % 4
        (found,) = count.unpack_from(body, at)
        at += count.size
        return int(found)

    try:
        for _ in range(number()):
            for _ in range(2):
                length = number()
                at += length
                if not length or body[at - 1] != 0:
                    return False
            for _ in range(2):
                identifiers = number()
                at += size * identifiers
    except (struct.error, IndexError):
        return False
    return at <= len(body) < at + 4


def _bytes_as_messages() -> Any:
    """Return the class of the topic. Its messages hold their bytes, all of them in `gid`."""
    types = DdsTypes(DEFINITIONS)
    made = types[_PARTICIPANT]
    setattr(made, "serialize", lambda self, *_, **__: self.gid)  # noqa: B010  a class made at run time
    setattr(made, "deserialize", classmethod(lambda cls, data, *_, **__: cls(bytes(data), [])))  # noqa: B010
    return made


DEFINITIONS: dict[str, Fields] = {
    _GID: (("data", f"uint8[{SIZES[0]}]"),),
    _NODE: (
        ("node_namespace", "string"),
        ("node_name", "string"),
        ("reader_gid_seq", f"{_GID}[]"),
        ("writer_gid_seq", f"{_GID}[]"),
    ),
    _PARTICIPANT: (("gid", _GID), ("node_entities_info_seq", f"{_NODE}[]")),
}
