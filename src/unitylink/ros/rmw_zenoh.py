# SPDX-License-Identifier: BSD-3-Clause
"""What nodes of ROS 2 with rmw_zenoh_cpp send each other: keys, tokens and attachments.

Its design documents them: docs/design.md of github.com/ros2/rmw_zenoh. Nothing here opens anything.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

from unitylink.optional import absent

from .interface import Topic

NO_HASH = "TypeHashNotSupported"  # what Humble writes in the place of a hash
PUBLISHER, SUBSCRIBER, SERVER, NODE = "MP", "MS", "SS", "NN"
_DEPTH = 42  # of a history, if nobody asks for another
_GID_BYTES = 16
_ATTACHMENT = struct.Struct(f"<qqB{_GID_BYTES}s")


@dataclass(frozen=True)
class Qos:
    """The qualities of a topic that a node of ours may have. It keeps the last `depth` messages."""

    depth: int = 10
    reliable: bool = True

    def __str__(self) -> str:
        """Return its text in a token, in which each default is an empty field.

        >>> str(Qos()), str(Qos(5, reliable=False)), str(Qos(42))
        ('::,10:,:,:,,', '2::,5:,:,:,,', '::,:,:,:,,')
        """
        depth = "" if self.depth == _DEPTH else str(self.depth)
        return f"{'' if self.reliable else 2}::,{depth}:,:,:,,"


def qos_of(topic: Topic, depth: int | None = None) -> Qos:
    """Return the qualities of a topic of a robot."""
    return Qos(topic.queue if depth is None else depth, topic.reliable)


@dataclass(frozen=True)
class Endpoint:
    """What others talk to: its full name without the outer slashes, its type, and the hash of the type.

    >>> chatter = Endpoint(2, "chatter", "std_msgs::msg::dds_::String_", "RIHS01_df66")
    >>> chatter.key
    '2/chatter/std_msgs::msg::dds_::String_/RIHS01_df66'
    """

    domain: int
    name: str
    type: str
    hash: str

    @property
    def key(self) -> str:
        """The key of its messages or calls."""
        return f"{self.domain}/{self.name}/{self.type}/{self.hash}"


@dataclass(frozen=True)
class Graph:
    """The tokens of one node, by which others list it. `session` is the id of its Zenoh session.

    >>> Graph(2, "aac3178e146ba6f1fc6e6a4085e77f21", "/", "listener").node
    '@ros2_lv/2/aac3178e146ba6f1fc6e6a4085e77f21/0/0/NN/%/%/listener'
    """

    domain: int
    session: str
    namespace: str
    name: str

    @property
    def node(self) -> str:
        return self._token(0, NODE)

    def token(self, number: int, kind: str, endpoint: Endpoint, qos: Qos) -> str:
        """Return the token of an endpoint. `number` is another one for each of them."""
        name = _mangled(f"/{endpoint.name}")
        return f"{self._token(number, kind)}/{name}/{endpoint.type}/{endpoint.hash}/{qos}"

    def _token(self, number: int, kind: str) -> str:
        namespace = _mangled(self.namespace.rstrip("/"))
        return f"@ros2_lv/{self.domain}/{self.session}/0/{number}/{kind}/%/{namespace}/{self.name}"


def _mangled(name: str) -> str:
    return name.replace("/", "%") or "%"


def gid_of(token: str) -> bytes:
    """Return the 16 bytes by which others know an endpoint: a hash of its token.

    Raises ToolError if xxhash is missing.

    >>> gid_of("@ros2_lv/2/aac3178e146ba6f1fc6e6a4085e77f21/0/0/NN/%/%/listener").hex()
    '49877999dacb858702d11ac823785912'
    """
    try:
        import xxhash
    except ImportError:
        raise absent("xxhash", "ROS 2 over Zenoh") from None
    return xxhash.xxh3_128_intdigest(token.encode()).to_bytes(_GID_BYTES, "little")


@dataclass(frozen=True)
class Attachment:
    """What goes beside each message and each call: its number from 1, when it was sent, and by whom.

    A peer's process ends if an attachment has another form. So `packed` is the only place that makes one.
    """

    sequence: int
    time_ns: int
    gid: bytes

    def packed(self) -> bytes:
        """Return its 33 bytes.

        >>> Attachment(1, 1700000000123456789, bytes(range(16))).packed().hex()
        '010000000000000015cd853dfe9c971710000102030405060708090a0b0c0d0e0f'
        """
        return _ATTACHMENT.pack(self.sequence, self.time_ns, _GID_BYTES, self.gid)


def read_attachment(data: bytes | None) -> Attachment:
    """Return what a peer has attached. Raises ValueError for something else."""
    if data is None:
        raise ValueError("it has no attachment")
    if len(data) != _ATTACHMENT.size:
        raise ValueError(f"its attachment has {len(data)} bytes; expected {_ATTACHMENT.size}")
    sequence, time_ns, length, gid = _ATTACHMENT.unpack(data)
    if length != _GID_BYTES:
        raise ValueError(f"its attachment has a sender of {length} bytes; expected {_GID_BYTES}")
    if sequence < 0 or time_ns < 0:
        raise ValueError("its attachment has a negative number or time")
    return Attachment(sequence, time_ns, gid)
