# SPDX-License-Identifier: BSD-3-Clause
"""The stop: a query or a put at its key makes all outputs safe, and waits for nothing else."""

from __future__ import annotations

import contextlib
import json
import queue
import threading
from typing import TYPE_CHECKING

from unitylink.errors import ProtocolError, UnityLinkError

from .queries import Queries, Refused, reason_of

if TYPE_CHECKING:
    import zenoh

    from .executor import Executor
    from .guests import Guests
    from .refusals import Refusals


class Stops:
    """Takes stops at `key`, by threads of their own. Everybody on the network may stop the robot.

    A key with a wildcard stops only if its last part is that of `key`: `lab/*/stop` does, `lab/**` does not.
    Who looks around on the network asks for all keys, and means no stop.
    """

    def __init__(
        self, session: zenoh.Session, key: str, executor: Executor, guests: Guests, refusals: Refusals
    ) -> None:
        self._key, self._executor, self._guests, self._refusals = key, executor, guests, refusals
        self._puts: queue.Queue[bool] = queue.Queue(1)
        self._queries = Queries(session, {key: self._answer}, refusals)
        self._subscriber = session.declare_subscriber(key, self._take)
        self._thread = threading.Thread(target=self._work, name="zenoh stop", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Take no more."""
        self._subscriber.undeclare()
        self._queries.close()
        self._puts.put(False)
        self._thread.join()

    def _answer(self, query: zenoh.Query) -> None:
        if not self._meant(str(query.key_expr)):
            raise Refused("wildcard", ProtocolError(f"a stop is for {self._key}, and named by its last part"))
        query.reply(self._key, json.dumps({"outputs": self._stop()}))

    def _take(self, sample: zenoh.Sample) -> None:
        if not self._meant(key := str(sample.key_expr)):
            return self._refusals.add("wildcard", f"{key}: a stop is named by the last part of its key")
        with contextlib.suppress(queue.Full):  # another stop is about to begin
            self._puts.put_nowait(True)
        return None

    def _meant(self, key: str) -> bool:
        return key.rpartition("/")[2] == self._key.rpartition("/")[2]

    def _work(self) -> None:
        while self._puts.get():
            try:
                self._stop()
            except UnityLinkError as error:
                self._refusals.add(reason_of(error), f"{self._key}: {error}")

    def _stop(self) -> int:
        client = self._guests.enter("zenoh stop")
        try:
            return self._executor.stop(client)
        finally:
            self._guests.exit(client)
