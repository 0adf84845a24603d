# SPDX-License-Identifier: BSD-3-Clause
"""The TosNet bus slave's status words, decoded."""

from __future__ import annotations

from dataclasses import dataclass

from unitylink import protocol


@dataclass(frozen=True)
class TosNetStatus:
    """The status word at 0x400.

    >>> status = TosNetStatus.decode(0xC0110001)
    >>> status.online, status.node_id, status.commit_pending
    (True, 1, True)
    >>> print(status)
    online, master, node 1 at ring address 1, commit pending
    >>> print(TosNetStatus.decode(0xC2100000))
    online, master, node 1 at ring address 0, ring 1 down
    """

    online: bool
    master: bool
    packet_error: bool
    system_halt: bool  # sticky until reset: too many cycles without a commit
    network_sync: bool
    node_id: int
    node_address: int
    rings_down: tuple[int, ...]  # of a network of two rings: those that do not run, 0 and 1
    other_spec: int  # the id of a node that was built from another spec; 0: none
    read_error: bool
    write_error: bool
    commit_aborted: bool  # memory was written while a commit was pending
    read_frozen: bool
    commit_pending: bool
    raw: int

    @classmethod
    def decode(cls, word: int) -> TosNetStatus:
        def bit(number: int) -> bool:
            return bool(word >> number & 1)

        return cls(
            online=bit(protocol.TOSNET_STATUS_ONLINE_BIT),
            master=bit(protocol.TOSNET_STATUS_MASTER_BIT),
            packet_error=bit(protocol.TOSNET_STATUS_PACKET_ERROR_BIT),
            system_halt=bit(protocol.TOSNET_STATUS_SYSTEM_HALT_BIT),
            network_sync=bit(protocol.TOSNET_STATUS_NETWORK_SYNC_BIT),
            node_id=word >> protocol.TOSNET_STATUS_NODE_ID_SHIFT & 0xF,
            node_address=word >> protocol.TOSNET_STATUS_NODE_ADDRESS_SHIFT & 0xF,
            rings_down=tuple(ring for ring in (0, 1) if bit(protocol.TOSNET_STATUS_NODE_ID_SHIFT + 4 + ring)),
            other_spec=word >> protocol.TOSNET_STATUS_READ_ERROR_BIT + 1 & 0xF,
            read_error=bit(protocol.TOSNET_STATUS_READ_ERROR_BIT),
            write_error=bit(protocol.TOSNET_STATUS_WRITE_ERROR_BIT),
            commit_aborted=bit(protocol.TOSNET_STATUS_COMMIT_ABORTED_BIT),
            read_frozen=bit(protocol.TOSNET_STATUS_READ_FROZEN_BIT),
            commit_pending=bit(protocol.TOSNET_STATUS_COMMIT_PENDING_BIT),
            raw=word,
        )

    def __str__(self) -> str:
        words = ["online" if self.online else "offline", "master" if self.master else "slave"]
        words.append(f"node {self.node_id} at ring address {self.node_address}")
        flags = (
            "system_halt",
            "packet_error",
            "read_error",
            "write_error",
            "commit_aborted",
            "commit_pending",
        )
        words += [f"ring {ring} down" for ring in self.rings_down]
        words += [flag.replace("_", " ") for flag in flags if getattr(self, flag)]
        return ", ".join(words)


@dataclass(frozen=True)
class TosNetCounters:
    """Packets seen, re-discoveries of the network, and errors, since reset."""

    packets: int
    resets: int
    errors: int


@dataclass(frozen=True)
class NetworkNode:
    """One node of the ring: its id, its ring address, and which of its 8 registers are enabled."""

    node_id: int
    ring_address: int
    registers: tuple[int, ...]

    @classmethod
    def decode_list(cls, words: list[int]) -> tuple[NetworkNode, ...]:
        """Decode the network registers. The list ends at the first entry whose ring address is not its index.

        Only the first node, the master, may have the id 0.

        >>> [n.node_id for n in NetworkNode.decode_list([0x010101, 0x030312, 0])]
        [1, 2]
        >>> [n.node_id for n in NetworkNode.decode_list([0, 0x030312, 0])], NetworkNode.decode_list([0, 0])
        ([0, 2], ())
        """
        nodes = []
        for index, word in enumerate(words):
            node_id, ring_address, enabled = word & 0xF, word >> 4 & 0xF, word >> 8 & 0xFF
            if ring_address != index or (node_id == 0 and index):
                break
            nodes.append(cls(node_id, ring_address, tuple(r for r in range(8) if enabled >> r & 1)))
        found = len(nodes) > 1 or any(words[:1])  # without a ring all are 0
        return tuple(nodes) if found else ()
