# SPDX-License-Identifier: BSD-3-Clause
"""A thousand clients that only stay: the server holds them, and one that reads is served beside them."""

from __future__ import annotations

import contextlib
import os
import resource
import socket
import time

from tests.unit.server.served import served
from tests.unit.server.test_serving import logged_in, until
from unitylink.server.serving import FILES_MOST, allow_files

MANY = 1000


def test_a_thousand_idle_clients() -> None:
    allow_files()  # this process has both ends of each connection
    with served() as one, one.link() as reader:
        reader.write(0x1B, 7)

        def clients() -> int:
            return len(one.server.report()["robots"][0]["clients"])

        with contextlib.ExitStack() as idle:
            for _ in range(MANY):
                idle.enter_context(logged_in(one, "looks"))
            until(lambda: clients() == MANY + 1)
            assert [reader.read(0x1B) for _ in range(100)] == [7] * 100
            assert clients() == MANY + 1
        until(lambda: clients() == 1)
        assert reader.read(0x1B) == 7


def test_open_files() -> None:
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    try:
        resource.setrlimit(resource.RLIMIT_NOFILE, (1024, before[1]))
        allow_files()
        assert resource.getrlimit(resource.RLIMIT_NOFILE)[0] == min(FILES_MOST, before[1])
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, before)


def test_a_caller_for_whom_there_is_no_file_waits_until_there_is_one() -> None:
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    with served() as one, one.link() as reader, socket.socket() as caller:
        host, port = one.server.place.rsplit(":", 1)
        caller.settimeout(10)
        free = os.dup(0)
        os.close(free)
        spent = time.process_time(), time.monotonic()
        try:
            resource.setrlimit(resource.RLIMIT_NOFILE, (free, before[1]))
            caller.connect((host, int(port)))
            caller.sendall(b"unitylink-serve 1 arm looks\n")
            time.sleep(0.5)
            reader.read(0x1B)
        finally:
            resource.setrlimit(resource.RLIMIT_NOFILE, before)
        took, passed = time.process_time() - spent[0], time.monotonic() - spent[1]
        assert caller.recv(1000).startswith(b"admitted")
    assert took < passed / 2, "the door asks for the caller over and over"
