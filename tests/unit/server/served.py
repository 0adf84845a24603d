# SPDX-License-Identifier: BSD-3-Clause
"""A server in front of a virtual board, for tests."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

from unitylink import Link
from unitylink.server.audit import Audit
from unitylink.server.robot import Robot
from unitylink.server.scopes import Rights
from unitylink.server.serving import Server
from unitylink.server.stop_file import StopFile
from unitylink.server.tls_files import TlsFiles
from unitylink.server.tokens import Tokens, User, digest
from unitylink.simulate import Board, BoardConfiguration
from unitylink.spec import compile_text
from unitylink.spec.model import Spec

TEXT = """
public arm() {
   @position = 0x12: i32 READ(PUBLISH(100 Hz));
   @target = 0x1A: i32 WRITE(SAFE=0);
   @power = 0x1B: u16 READWRITE(SAFE=0);
   @other = 0x13: u16 READ();
}
"""
REFUSED = 0x60  # the bus of the board refuses this address
TOKENS = {
    "all": ["admin"],
    "looks": ["read"],
    "moves": ["read", "write target", "arm"],
    "part": ["read power"],
}


def arm() -> Spec:
    spec = compile_text(TEXT, "arm.ul").spec
    assert spec is not None
    return spec


@dataclass
class Served:
    """A board, and the server in front of it. `lines` is the audit log."""

    board: Board
    server: Server
    lines: list[str]

    def url(self, options: str = "", name: str = "arm") -> str:
        return f"serve://{self.server.place}/{name}?timeout=2{options}"

    def link(self, token: str = "all", options: str = "", name: str = "arm") -> Link:
        with token_of(token):
            return Link(self.url(options, name))

    @property
    def robot(self) -> Robot:
        return self.server.robots["arm"]


_environment = threading.RLock()  # of two threads that set a token, the second would put the first one back


@contextmanager
def token_of(token: str) -> Iterator[None]:
    with _environment, mock.patch.dict(os.environ, {"UNITYLINK_TOKEN": token}):
        yield


@contextmanager
def served(
    board: Board | None = None,
    url: str | None = None,
    spec: Spec | None = None,
    tls: TlsFiles | None = None,
    silence_s: float = 0.0,
    *,
    lines: list[str] | None = None,
    memory: Path | None = None,
) -> Iterator[Served]:
    spec = spec if spec is not None else arm()
    configuration = BoardConfiguration.for_spec(spec, bus_error_ranges=((REFUSED, REFUSED),))
    with board or Board(spec, configuration=configuration, endpoint="tcp") as there:
        tokens = Tokens((digest(name), User(name, Rights.of(scopes))) for name, scopes in TOKENS.items())
        lines = lines if lines is not None else []
        audit = Audit(lines.append)
        stop_file = StopFile(str(memory)) if memory is not None else None
        url = url or f"{there.url}?timeout=0.5"
        robot = Robot("arm", url, spec, tokens, audit, silence_s=silence_s, memory=stop_file)
        with Server([robot], tokens, audit, "127.0.0.1", 0, tls=tls) as server:
            assert robot.opened.wait(20)
            yield Served(there, server, lines)
