# SPDX-License-Identifier: BSD-3-Clause
"""Tells ROS 2 that a participant of DDS is a node: on `ros_discovery_info`, with the end points it has.

With it `ros2 node list` and `ros2 node info` show a node that runs without ROS.
"""

from __future__ import annotations

import os
import threading
from typing import Any

from .dds_types import DdsTypes
from .standard import Fields

TOPIC = "ros_discovery_info"
_GUID_BYTES = 16
# The releases before Iron have longer identifiers in this message. The two cannot read each other's.
_LONG_BYTES, _LONG_RELEASES = 24, ("foxy", "galactic", "humble")


class DdsGraph:
    """The node that a participant is. `add_reader` and `add_writer` may be called at any time."""

    def __init__(self, participant: Any, namespace: str, name: str) -> None:
        from cyclonedds.core import Policy, Qos
        from cyclonedds.pub import DataWriter
        from cyclonedds.topic import Topic as DdsTopic
        from cyclonedds.util import duration

        long = os.environ.get("ROS_DISTRO", "") in _LONG_RELEASES
        self._bytes = _LONG_BYTES if long else _GUID_BYTES
        self._types = DdsTypes(_definitions(self._bytes))
        self._participant = participant
        self._node = (f"/{namespace.strip('/')}", name)
        self._readers: list[Any] = []
        self._writers: list[Any] = []
        self._told = False
        self._lock = threading.Lock()
        # durable, so that a peer that comes later is told too
        qos = Qos(
            Policy.Reliability.Reliable(duration(milliseconds=100)),
            Policy.Durability.TransientLocal,
            Policy.History.KeepLast(1),
            Policy.DataRepresentation(use_cdrv0_representation=True),
        )
        topic = DdsTopic(participant, TOPIC, self._types["rmw_dds_common/ParticipantEntitiesInfo"], qos=qos)
        self._writer = DataWriter(participant, topic, qos=qos)

    def add_reader(self, reader: Any) -> None:
        self._add(self._readers, reader)

    def add_writer(self, writer: Any) -> None:
        self._add(self._writers, writer)

    def tell(self) -> None:
        """Publish what the node has now. From then on, each new end point is told by itself."""
        with self._lock:
            self._told = True
            self._tell()

    def _add(self, among: list[Any], entity: Any) -> None:
        with self._lock:
            among.append(self._identifier(entity))
            if self._told:
                self._tell()

    def _tell(self) -> None:
        node = self._types["rmw_dds_common/NodeEntitiesInfo"](
            *self._node, list(self._readers), list(self._writers)
        )
        message = self._types["rmw_dds_common/ParticipantEntitiesInfo"]
        self._writer.write(message(self._identifier(self._participant), [node]))

    def _identifier(self, entity: Any) -> Any:
        whole = entity.guid.bytes
        return self._types["rmw_dds_common/Gid"]([*whole, *bytes(self._bytes - len(whole))])


def _definitions(size: int) -> dict[str, Fields]:
    return {
        "rmw_dds_common/Gid": (("data", f"uint8[{size}]"),),
        "rmw_dds_common/NodeEntitiesInfo": (
            ("node_namespace", "string"),
            ("node_name", "string"),
            ("reader_gid_seq", "rmw_dds_common/Gid[]"),
            ("writer_gid_seq", "rmw_dds_common/Gid[]"),
        ),
        "rmw_dds_common/ParticipantEntitiesInfo": (
            ("gid", "rmw_dds_common/Gid"),
            ("node_entities_info_seq", "rmw_dds_common/NodeEntitiesInfo[]"),
        ),
    }
