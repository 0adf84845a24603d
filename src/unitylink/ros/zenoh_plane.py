# SPDX-License-Identifier: BSD-3-Clause
"""The front end of ROS 2 over Zenoh, without ROS. Nodes with rmw_zenoh_cpp see it as one of theirs."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from contextlib import AbstractContextManager, ExitStack, nullcontext
from typing import TYPE_CHECKING, Any

from .cdr_plane import COMMANDS, NODE, CdrPlane, Matched
from .interface import Interface, Topic
from .plane import SERVICE_FIELDS, Port, Refuse, log_refused
from .rmw_zenoh import (
    NO_HASH,
    PUBLISHER,
    SERVER,
    SUBSCRIBER,
    Attachment,
    Endpoint,
    Graph,
    Qos,
    gid_of,
    qos_of,
    read_attachment,
)
from .type_hash import message_hash, service_hash
from .zenoh_reader import ZenohReader
from .zenoh_session import RosSession

if TYPE_CHECKING:
    import zenoh

_CALLS = 16  # of a service, that may wait
_MESSAGE_MOST = 1 << 20  # bytes of a message or call; to read more takes long enough to look like a hang


class ZenohPlane(CdrPlane):
    """A plane that carries messages as rmw_zenoh_cpp does.

    `hashes` is false among nodes of Humble, which have none. The network is that of
    ZENOH_SESSION_CONFIG_URI and ZENOH_CONFIG_OVERRIDE, as for them. Raises ToolError, UrlError, LinkNotFound.
    """

    def __init__(
        self, interface: Interface, namespace: str, domain: int, name: str = NODE, *, hashes: bool = True
    ) -> None:
        super().__init__(interface, namespace, "Zenoh")
        self._domain, self._hashes = domain, hashes
        self._topics = ZenohReader("the thread that takes messages", self.life)
        # A service, such as set_safe, is answered even if the thread of the topics hangs.
        self._services = ZenohReader("the thread that answers services", self.life)
        self._numbers = iter(range(1, 1 << 30))
        with ExitStack() as stack:
            self._session: zenoh.Session = stack.enter_context(RosSession().opened())
            self._graph = Graph(domain, str(self._session.info.zid()), f"/{self._namespace}", name)
            self._closing = stack.pop_all()
        self._declared(self._session.liveliness().declare_token(self._graph.node))

    def start(self) -> None:
        """Start taking messages. Call it after the last subscribe and serve."""
        self._topics.start()
        self._services.start()

    def close(self) -> None:
        """Stop taking messages, and leave the network. Close the node that publishes here first."""
        self._topics.close()
        self._services.close()
        self._closing.close()

    def gathered(self) -> AbstractContextManager[None]:
        return nullcontext()  # Zenoh joins small messages by itself

    def advertise(self, topic: Topic) -> Port:
        import zenoh

        endpoint = self._endpoint_of(topic)
        publisher = self._session.declare_publisher(
            endpoint.key,
            congestion_control=zenoh.CongestionControl.DROP,
            reliability=zenoh.Reliability.RELIABLE if topic.reliable else zenoh.Reliability.BEST_EFFORT,
        )
        self._declared(publisher)
        token = self._tell(PUBLISHER, endpoint, qos_of(topic))
        gid, lock = gid_of(token), threading.Lock()
        sequence = 0

        def send(message: Any) -> None:
            nonlocal sequence
            with lock:
                sequence += 1
                beside = Attachment(sequence, time.time_ns(), gid).packed()
                publisher.put(bytes(message.serialize()), attachment=beside)

        return Port(send, Matched(lambda: publisher.matching_status))

    def subscribe(
        self,
        topic: Topic,
        take: Callable[[Any], None],
        refuse: Refuse = log_refused,
        *,
        depth: int = COMMANDS,
    ) -> None:
        kind = self.types[topic.type]
        endpoint = self._endpoint_of(topic)

        def taken(sample: zenoh.Sample) -> None:
            try:
                read_attachment(_bytes(sample.attachment))
                message = kind.deserialize(_message(sample.payload))
            # for example a name that is not UTF-8, or a length beyond the message's end
            except Exception as error:
                refuse(topic.name, error)
            else:
                take(message)

        come = self._topics.box(topic.name, depth, taken)
        self._declared(self._session.declare_subscriber(endpoint.key, come))
        self._tell(SUBSCRIBER, endpoint, qos_of(topic, depth))

    def serve(self, name: str, kind: str, handler: Callable[..., Any]) -> None:
        """Offer a service as rmw_zenoh_cpp does: a queryable that answers with the number of the call."""
        request, reply = SERVICE_FIELDS[kind]
        full = self.service_name(kind)
        asked = self.types.part_of_service(full, "Request", request)
        answered = self.types.part_of_service(full, "Response", reply)
        package, _, service = full.partition("/")
        hashed = service_hash(self.definitions, full, request, reply) if self._hashes else NO_HASH
        endpoint = Endpoint(self._domain, self.name(name), f"{package}::srv::dds_::{service}_", hashed)
        names = [field for field, _ in request]

        def answer(query: zenoh.Query) -> None:
            with query:  # its end tells the peer that no answer comes, if there was none
                try:
                    call = read_attachment(_bytes(query.attachment))
                    message = asked.deserialize(_message(query.payload))
                except Exception as error:
                    log_refused(name, error)
                    return
                results = handler(*(getattr(message, field) for field in names))
                beside = Attachment(call.sequence, time.time_ns(), call.gid).packed()
                query.reply(endpoint.key, bytes(answered(*results).serialize()), attachment=beside)

        come = self._services.box(name, _CALLS, answer)
        self._declared(self._session.declare_queryable(endpoint.key, come, complete=True))
        self._tell(SERVER, endpoint, Qos())

    def _endpoint_of(self, topic: Topic) -> Endpoint:
        package, _, message = topic.type.partition("/")
        hashed = message_hash(self.definitions, topic.type) if self._hashes else NO_HASH
        return Endpoint(self._domain, self.name(topic.name), f"{package}::msg::dds_::{message}_", hashed)

    def _tell(self, kind: str, endpoint: Endpoint, qos: Qos) -> str:
        """Let others list an endpoint, which exists by now: who sees it may use it. Return its token."""
        token = self._graph.token(next(self._numbers), kind, endpoint, qos)
        self._declared(self._session.liveliness().declare_token(token))
        return token

    def _declared(self, one: Any) -> None:
        self._closing.callback(one.undeclare)


def _message(payload: Any) -> bytes:
    """Return the bytes of a message. Raises ValueError for one that no command of a robot is."""
    if payload is None:
        return b""
    if len(payload) > _MESSAGE_MOST:
        raise ValueError(f"it has {len(payload)} bytes; expected at most {_MESSAGE_MOST}")
    return bytes(payload.to_bytes())


def _bytes(attachment: Any) -> bytes | None:
    return None if attachment is None else attachment.to_bytes()
