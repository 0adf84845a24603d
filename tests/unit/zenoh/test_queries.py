# SPDX-License-Identifier: BSD-3-Clause
"""Queries that wait for an answer, and threads that wait for queries."""

from __future__ import annotations

import threading
import time
from pathlib import Path

import zenoh
from unit.zenoh.rig import free_port, until

from unitylink.zenoh.bridge.queries import WAITING_MAX, Queries
from unitylink.zenoh.bridge.refusals import Refusals
from unitylink.zenoh.session import Network

KEY = "lab/slow"


def woken(queries: Queries) -> int:
    """How often its threads have gone to sleep by themselves so far."""
    states = [Path(f"/proc/self/task/{one.native_id}/status").read_text() for one in queries._threads]
    return sum(int(state.partition("\nvoluntary_ctxt_switches:")[2].split()[0]) for state in states)


def test_the_oldest_of_too_many_queries_get_no_answer_and_idle_threads_sleep() -> None:
    go_on, begun, answers, over = threading.Event(), list[str](), list[str](), list[str]()

    def answer(query: zenoh.Query) -> None:
        begun.append(str(query.parameters))
        go_on.wait()
        query.reply(KEY, str(query.parameters))

    with Network(listen=f"tcp/127.0.0.1:{free_port()}").opened() as session:

        def ask(name: str) -> None:
            def take(reply: zenoh.Reply) -> None:
                assert reply.ok is not None
                answers.append(reply.ok.payload.to_string())

            session.get(
                f"{KEY}?{name}", zenoh.handlers.Callback(take, drop=lambda: over.append(name)), timeout=60
            )

        queries = Queries(session, {KEY: answer}, Refusals(), threads=2)
        before = woken(queries)
        time.sleep(0.5)
        assert woken(queries) - before <= 2  # they may just have begun to wait
        for number in range(2):
            ask(f"first{number}")
        until(lambda: len(begun) == 2)
        for number in range(WAITING_MAX + 10):
            ask(str(number))
        until(lambda: len(over) == 10)
        assert sorted(map(int, over)) == list(range(10)) and not answers
        go_on.set()
        until(lambda: len(over) == WAITING_MAX + 12)
        assert set(answers) == {"first0", "first1", *map(str, range(10, WAITING_MAX + 10))}
        go_on.clear()
        for name in ("last0", "last1", "waits"):
            ask(name)
        until(lambda: len(begun) == WAITING_MAX + 4)
        closing = threading.Thread(target=queries.close)
        closing.start()
        until(lambda: "waits" in over)
        assert not {"last0", "last1"} & set(over)
        go_on.set()
        closing.join(10)
        assert not closing.is_alive() and "waits" not in answers
