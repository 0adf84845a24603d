# SPDX-License-Identifier: BSD-3-Clause
"""A robot on a Zenoh network: its keys, its tokens, and who is there."""

from __future__ import annotations

import contextlib
import json
import secrets
import threading
import time
from typing import TYPE_CHECKING, Any

from unitylink.errors import LinkBusy, LinkDown, UnityLinkError
from unitylink.interface.wire_hash import wire_hash
from unitylink.protocol import CONTROL_ARM

from ..messages import CLOCK, VISIT
from ..schema import fields_of, schema_of, set_layouts
from .executor import Executor
from .groups import Groups
from .guests import Guests
from .queries import Queries, Refused, payload_of
from .refusals import Refusals
from .requests import Requests
from .set_points import SetPoints
from .stops import Stops
from .topics import Topics, layouts_of
from .values import Values
from .visits import UNKNOWN, Visit

if TYPE_CHECKING:
    import zenoh

    from unitylink.layer2_message import Link
    from unitylink.server.robot import Robot

    from ..keys import Keys
    from ..session import Network

LOOK_S = 0.2  # how often the board is asked whether it is there
_OTHERS_S = 0.5  # how long other bridges have to say that they are there
_FIRST_S = 5.0


class Bridge:
    """Serves `robot`, which has been started, under `keys` until `close`.

    `token` is that of the user as whom all clients come, and `reading` of those who only read. `spec_text` is
    what `pack_spec` returned.
    What is published goes through a session of its own. So a reader that is slow holds up no request and no
    stop.

    Raises LinkBusy if another bridge has this name already. `trouble` tells what ended the bridge by itself.
    """

    def __init__(
        self,
        robot: Robot,
        keys: Keys,
        network: Network,
        publishing: Network,
        spec_text: str,
        *,
        token: str,
        reading: str = "",
    ) -> None:
        self.robot, self.keys, self.id = robot, keys, secrets.token_hex(8)
        self.trouble = ""
        self.ended = threading.Event()
        self._news = threading.Event()  # subscribers have come or gone, or the bridge has ended
        self.refusals = Refusals()
        self.hash = f"{wire_hash(robot.spec):016x}"
        self._spec_text = spec_text
        self._guests = Guests(robot, keys, token, reading=reading, bridge=self.id, spec_hash=self.hash)
        self._guests.ended = self._let_go
        self._executor = Executor(robot)
        self._served: tuple[SetPoints, Topics] | None = None
        self._schema: dict[str, Any] = {}
        self._alive: zenoh.LivelinessToken | None = None
        self._at: Link | None = None
        with contextlib.ExitStack() as stack:
            self._session: zenoh.Session = stack.enter_context(network.opened())
            self._out: zenoh.Session = stack.enter_context(publishing.opened())
            self._refuse_second()
            self._groups = Groups(robot.board_link, self._words_publisher)
            self._requests = Requests(
                self._executor,
                self._guests.visits,
                self._guests.lock,
                self._groups,
                refusals=self.refusals,
                leave=self._guests.leave,
            )
            self._begin(stack)
            self._closing = stack.pop_all()

    def __enter__(self) -> Bridge:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Serve no more. The outputs keep their values; the leases of clients end in order."""
        self.ended.set()
        self._closing.close()

    def state(self) -> dict[str, Any]:
        """Return who is there, what was refused, and how the board is, as plain values."""
        report = self.robot.report()
        with self._guests.lock:
            clients = [
                {"name": one.name, "requests_again": one.ledger.repeated} for one in self._guests.visits.all()
            ]
        return {
            "name": self.keys.name,
            "robot": self.robot.name,
            "bridge": self.id,
            "hash": self.hash,
            "away": "" if self._alive else report["away"] or "the board does not answer",
            "device": _device(self._at),
            "statistics": report.get("statistics", {}),
            "clients": clients,
            "leases": report["leases"],
            "stopped_by": report["stopped_by"],
            "refused": self.refusals.report(),
            "set_points": self._served[0].report() if self._served else {},
            "published": self._groups.published,
        }

    # ---- beginning

    def _refuse_second(self) -> None:
        found = self._session.liveliness().get(self.keys.bridge("*"), timeout=_OTHERS_S)
        others = [str(reply.ok.key_expr) for reply in found if reply.ok is not None]
        if others:
            raise LinkBusy(
                f"another bridge serves {self.keys.name} already ({others[0]}); give this robot another name"
            )

    def _begin(self, stack: contextlib.ExitStack) -> None:
        session, fixed = self._session, self.keys.fixed
        stack.callback(self._end)
        token = session.liveliness().declare_token(self.keys.bridge(self.id))
        stack.callback(token.undeclare)
        for key, heard in (
            (self.keys.bridge("*"), self._heard_bridge),
            (self.keys.client("*"), self._guests.heard),
        ):
            stack.callback(session.liveliness().declare_subscriber(key, heard, history=True).undeclare)
        texts = {
            "spec": lambda: self._spec_text,
            "hash": lambda: self.hash,
            "schema": self._schema_text,
            "state": lambda: json.dumps(self.state()),
        }
        answers: dict[str, Any] = {
            fixed(name): self._teller(fixed(name), text) for name, text in texts.items()
        }
        answers[fixed("hello")] = answers[fixed("hello_read")] = self._guests.hello
        stack.callback(Queries(session, answers, self.refusals, threads=3).close)
        stack.callback(Queries(session, {fixed("clock"): self._clock}, self.refusals).close)
        do = {self.keys.request(self.id): self._requests.answer}
        stack.callback(Queries(session, do, self.refusals, threads=4).close)
        stack.callback(Stops(session, fixed("stop"), self._executor, self._guests, self.refusals).close)
        self._governor = threading.Thread(
            target=self._govern, args=(stack,), name="zenoh bridge", daemon=True
        )
        self._governor.start()

    def _end(self) -> None:
        self.ended.set()
        self._news.set()
        self._governor.join()
        self._alive_is(False)
        if self._served is not None:
            self._served[0].close()
        self._end_groups()
        self._guests.leave_all()

    def _serve_items(self, link: Link) -> None:
        """Begin with what needs the width of the board's words."""
        spec, keys, session = self.robot.spec, self.keys, self._session
        fields = fields_of(spec, link.configuration.data_bits)
        sets, topics = set_layouts(spec, fields), layouts_of(spec, fields)
        self._schema = schema_of(spec, fields, sets, topics)
        self._schema |= {"hash": self.hash, "bridge": self.id}
        layouts = {keys.set_point(part): (part, layout) for part, layout in sets.items()}
        points = SetPoints(
            session,
            keys.fixed("set"),
            layouts,
            self._executor,
            visits=self._guests.visits,
            lock=self._guests.lock,
            refusals=self.refusals,
        )
        publishers = {name: self._out.declare_publisher(keys.publish(name)) for name in topics}
        self._served = points, Topics(spec, fields, publishers, self._groups, self._news.set)
        reader = self._guests.enter("zenoh")
        values = Values(
            {keys.value(path): one for path, one in fields.items()}, self._executor, self._requests, reader
        )
        self._values = Queries(
            session, {f"{keys.fixed('value')}/**": values.answer}, self.refusals, threads=2
        )

    # ---- the board

    def _govern(self, _: object) -> None:
        self.robot.opened.wait(_FIRST_S)
        while not self.ended.is_set():
            link = self._link()
            if link is not self._at:
                if self._at is not None and link is not None:  # so fast that nobody was told that it was away
                    self._guests.dismiss_all("the board was replaced")
                self._at = link
                self._end_groups()
            if link is not None and self._served is None:
                try:
                    self._serve_items(link)
                except UnityLinkError as error:
                    self._give_up(str(error))
                    return
            self._alive_is(link is not None)
            self._guests.look(self._session)
            if link is not None and self._served is not None:
                self._served[1].look()
            self._news.wait(LOOK_S)
            self._news.clear()
        if self._served is not None:
            self._values.close()

    def _link(self) -> Link | None:
        """Return the link if the board answers now."""
        try:
            link = self.robot.board_link()
            link.read_control(CONTROL_ARM)
        except UnityLinkError:
            return None
        return link

    def _alive_is(self, alive: bool) -> None:
        if alive and self._alive is None:
            self._alive = self._session.liveliness().declare_token(self.keys.board(self.id))
        elif not alive and self._alive is not None:
            token, self._alive = self._alive, None
            token.undeclare()

    def _words_publisher(self, number: int) -> zenoh.Publisher:
        return self._out.declare_publisher(self.keys.words(self.id, number))

    def _end_groups(self) -> None:
        """The board was lost: whoever wants its publishes has to ask again."""
        self._groups.clear()
        if self._served is not None:
            self._served[1].forget()

    # ---- who is there

    def _heard_bridge(self, sample: zenoh.Sample) -> None:
        import zenoh

        other = str(sample.key_expr).rpartition("/")[2]
        if sample.kind == zenoh.SampleKind.PUT and other < self.id:
            self._give_up(f"another bridge serves {self.keys.name}, too ({other}); this one ends")

    def _give_up(self, why: str) -> None:
        self.trouble = why
        self.ended.set()

    def _let_go(self, visit: Visit) -> None:
        if self._served is not None:
            self._served[0].forget(visit.number)
        for group in tuple(visit.groups):
            self._groups.leave(group, visit.number)

    # ---- answers

    def _teller(self, key: str, text: Any) -> Any:
        def answer(query: zenoh.Query) -> None:
            query.reply(key, text())

        return answer

    def _schema_text(self) -> str:
        if not self._schema:
            raise LinkDown("the board has not come yet")
        return json.dumps(self._schema)

    def _clock(self, query: zenoh.Query) -> None:
        """Answer who this is, and when. Who sends the number of its visit is told if that has ended."""
        data = payload_of(query)
        if len(data) == VISIT.size:
            with self._guests.lock:
                known = self._guests.visits.get(*VISIT.unpack(data)) is not None
            if not known:
                raise Refused("unknown", LinkDown(UNKNOWN))
        query.reply(self.keys.fixed("clock"), CLOCK.pack(int(self.id, 16), time.monotonic_ns()))


def _device(link: Link | None) -> dict[str, Any]:
    """Return what the gateware says of itself. The hash is empty if it does not know its spec."""
    description = link.description if link is not None else None
    if description is None:
        return {}
    known = f"{description.spec_hash:016x}" if description.spec_hash else ""
    return {"hash": known, "gateware_version": description.gateware_version, "build": description.build}
