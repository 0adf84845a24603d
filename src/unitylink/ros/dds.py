# SPDX-License-Identifier: BSD-3-Clause
"""The front end of ROS 2 without ROS.

Its topics and services are on cyclonedds, and genuine ROS 2 sees them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from unitylink.errors import LinkNotFound
from unitylink.optional import absent

from .cdr_plane import COMMANDS, NODE, CdrPlane, Matched
from .dds_graph import DdsGraph
from .dds_reader import DdsReader
from .dds_writer import Here, gathering_writer
from .interface import Interface, Topic
from .plane import SERVICE_FIELDS, Port, Refuse, log_refused


class DdsPlane(CdrPlane):
    """A plane that carries messages as ROS 2 does: topic `rt/<namespace>/<name>`, type
    `std_msgs::msg::dds_::Int32_`.

    If `domain` is None, it is ROS_DOMAIN_ID, or 0. CYCLONEDDS_URI configures the network, as it does for ROS
    2. The participant is the node `name` for ROS 2. Raises LinkNotFound if DDS does not start.
    """

    def __init__(self, interface: Interface, namespace: str, domain: int, name: str = NODE) -> None:
        try:
            from cyclonedds.core import DDSException, Policy, Qos
            from cyclonedds.domain import DomainParticipant
        except ImportError:
            raise absent("cyclonedds", "ROS 2 over DDS") from None
        super().__init__(interface, namespace, "DDS")
        # by this mark, ROS 2 knows its participants
        try:
            self._participant = DomainParticipant(domain, qos=Qos(Policy.Userdata(b"enclave=/;")))
        except DDSException as error:
            raise LinkNotFound(
                f"DDS does not start in the domain {domain}: is CYCLONEDDS_URI right? {error.msg}"
            ) from None
        self._here = Here()
        # A service, such as set_safe, is answered even if the thread of the topics hangs.
        self._topics = DdsReader(self._participant, "the thread that takes messages", self.life)
        self._services = DdsReader(self._participant, "the thread that answers services", self.life)
        self._graph = DdsGraph(self._participant, namespace, name, self._services)

    def start(self) -> None:
        """Start taking messages. Call it after the last subscribe and serve."""
        self._topics.start()
        self._services.start()
        self._graph.start()

    def close(self) -> None:
        """Stop taking messages, and leave the domain at once. Close the node that publishes here first."""
        self._topics.close()
        self._services.close()
        # Garbage collection would do this later or never. Others would still see a node that has ended.
        self._participant.__del__()

    def advertise(self, topic: Topic) -> Port:
        kind = self.types[topic.type]
        writer = self._writer(
            f"rt/{self.name(topic.name)}", kind, topic.queue, topic.reliable, gathering_writer()
        )
        return Port(writer.sender(self._here), Matched(writer.get_matched_subscriptions))

    @contextmanager
    def gathered(self) -> Iterator[None]:
        """Within it, send the publishes of this thread in as few packets as possible."""
        held: set[Callable[[], None]] = set()
        self._here.held = held
        try:
            yield
        finally:
            self._here.held = None
            for flush in held:
                flush()

    def subscribe(
        self,
        topic: Topic,
        take: Callable[[Any], None],
        refuse: Refuse = log_refused,
        *,
        depth: int = COMMANDS,
    ) -> None:
        kind = self.types[topic.type]
        reader = self._reader(f"rt/{self.name(topic.name)}", kind, depth, topic.reliable)
        self._topics.add(reader, topic.name, take, refuse)

    def serve(self, name: str, kind: str, handler: Callable[..., Any]) -> None:
        """Offer a service as rmw_cyclonedds does: with a topic of requests and one of replies."""
        request, reply = SERVICE_FIELDS[kind]
        full = self.service_name(kind)
        asked = self.types.service(full, "Request", request)
        answered = self.types.service(full, "Response", reply)
        writer = self._writer(f"rr/{self.name(name)}Reply", answered, 10, True)
        names = [field for field, _ in request]

        def answer(message: Any) -> None:
            results = handler(*(getattr(message, field) for field in names))
            writer.write(answered(message.guid, message.number, *results))

        self._services.add(self._reader(f"rq/{self.name(name)}Request", asked, 10, True), name, answer)

    def _qos(self, depth: int, reliable: bool) -> Any:
        from cyclonedds.core import Policy, Qos
        from cyclonedds.util import duration

        return Qos(
            Policy.Reliability.Reliable(duration(milliseconds=100))
            if reliable
            else Policy.Reliability.BestEffort,
            Policy.Durability.Volatile,
            Policy.History.KeepLast(depth),
            Policy.DataRepresentation(use_cdrv0_representation=True),
        )

    def _writer(self, name: str, kind: Any, depth: int, reliable: bool, writer: Any = None) -> Any:
        from cyclonedds.pub import DataWriter
        from cyclonedds.topic import Topic as DdsTopic

        qos = self._qos(depth, reliable)
        topic = DdsTopic(self._participant, name, kind, qos=qos)
        made = (writer or DataWriter)(self._participant, topic, qos=qos)
        self._graph.add_writer(made)
        return made

    def _reader(self, name: str, kind: Any, depth: int, reliable: bool) -> Any:
        from cyclonedds.sub import DataReader
        from cyclonedds.topic import Topic as DdsTopic

        qos = self._qos(depth, reliable)
        topic = DdsTopic(self._participant, name, kind, qos=qos)
        made = DataReader(self._participant, topic, qos=qos)
        self._graph.add_reader(made)
        return made
