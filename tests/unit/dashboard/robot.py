# SPDX-License-Identifier: BSD-3-Clause
"""A dashboard on a virtual board, and programs that speak to it as a browser does."""

from __future__ import annotations

import http.client
import json
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from websockets.sync.client import ClientConnection
from websockets.sync.client import connect as open_socket

from unitylink import Link, connect
from unitylink.dashboard.extras import Extras
from unitylink.dashboard.opening import open_dashboard
from unitylink.dashboard.place import Place
from unitylink.dashboard.server import Dashboard
from unitylink.server.scopes import Rights
from unitylink.server.tokens import Tokens, User, digest
from unitylink.simulate import Board, BoardConfiguration, Plant, Registers
from unitylink.spec import compile_text, load
from unitylink.spec.model import Spec

TEXT = """
enum Grip: u8 { open = 0; hold = 1; }
bits Flags: u8 { ready: bool @ 0; }
joint(name: string): @ (speed, angle, target) {
   @angle: i16 READ(ID=name, UNIT="deg", SCALE=0.1, MIN=-90, MAX=90, PUBLISH(100 Hz));
   @speed: u16 READ();
   @target: i16 WRITE(UNIT="deg", SCALE=0.1, MIN=-90, MAX=90, SAFE=0);
}
public arm() {
   j1: joint("shoulder") @ (0x10, 0x11, 0x12);
   j2: joint("elbow") @ (0x20, 0x21, 0x22);
   @confirm("Open it?")
   @grip = 0x30: Grip WRITE(SAFE=1);
   @wide = 0x32: u64 READWRITE();
   @reset = 0x34: bool PULSE();
   @faults = 0x35: Flags W1C();
}
"""
USERS = {
    "owner": ["admin"],
    "ana": ["read", "write j1.*"],
    "ben": ["read j2.*"],
    "cem": ["write", "arm"],
    "dan": ["read"],
}


def tokens() -> Tokens:
    """Return the tokens of USERS: the token of each is his name."""
    return Tokens([(digest(name), User(name, Rights.of(scopes))) for name, scopes in USERS.items()])


def compiled() -> Spec:
    spec = compile_text(TEXT, "arm.ul").spec
    assert spec is not None
    return spec


class Still:
    """A plant that moves nothing, so that a test decides what the board says."""

    period_s = 0.01

    def attach(self, spec: Spec | None, registers: Registers) -> None: ...

    def step(self, time_s: float) -> None: ...


class Log:
    """An audit log. It takes no line while `flows` is not set, as a disk that hangs."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.flows = threading.Event()
        self.flows.set()

    def put(self, line: str) -> None:
        self.flows.wait(60)
        self.lines.append(line)

    def until(self, event: str, **facts: Any) -> list[dict[str, Any]]:
        """Return the entries of this event, once the last one has these facts."""
        end_s = time.monotonic() + 20
        while True:
            found = [one for one in map(json.loads, self.lines[:]) if one["event"] == event]
            if found and facts.items() <= found[-1].items():
                return found
            assert time.monotonic() < end_s, f"no {event} with {facts}: {found[-3:]}"
            time.sleep(0.005)


class Robot:
    """A virtual board, its link and its dashboard. `log` is its audit log."""

    def __init__(self, board: Board, link: Link, page: Dashboard, log: Log) -> None:
        self.board, self.link, self.page, self.log = board, link, page, log
        self.host = page.url.partition("//")[2] if page else ""

    def request(
        self, method: str, path: str, body: Any = None, **headers: str
    ) -> tuple[int, dict[str, str], bytes]:
        """Return (status, headers, body) of the answer."""
        connection = http.client.HTTPConnection(self.host, timeout=10)
        try:
            data = None if body is None else json.dumps(body)
            connection.request(
                method, path, data, {name.replace("_", "-"): one for name, one in headers.items()}
            )
            answer = connection.getresponse()
            return answer.status, {name.lower(): value for name, value in answer.getheaders()}, answer.read()
        finally:
            connection.close()

    def log_in(self, user: str = "owner") -> str:
        """Return the cookie of a user."""
        status, headers, body = self.request("POST", "/login", {"token": user})
        assert status == 204, body
        return headers["set-cookie"].partition(";")[0]

    @contextmanager
    def viewer(self, user: str = "owner") -> Iterator[Viewer]:
        with open_socket(
            f"ws://{self.host}/socket",
            additional_headers={"Cookie": self.log_in(user)},
            proxy=None,
            close_timeout=0.2,
        ) as socket:
            yield Viewer(socket)


class Viewer:
    """A program that speaks to the socket as the page does. It keeps what it was told."""

    def __init__(self, socket: ClientConnection) -> None:
        self.socket = socket
        self.told: dict[str, Any] = {}
        self.events: list[dict[str, Any]] = []
        self.frames: list[np.ndarray[Any, np.dtype[np.float64]]] = []
        self.values: dict[str, float] = {}
        self._number = 0
        self.until(lambda: "hello" in self.told)

    def until(self, done: Callable[[], Any], limit_s: float = 10.0) -> Any:
        """Take messages until `done()` is true, and return it."""
        end_s = time.monotonic() + limit_s
        while not (found := done()):
            left_s = end_s - time.monotonic()
            assert left_s > 0, f"it did not come in {limit_s} s: {self.told}"
            self._take(self.socket.recv(timeout=left_s))
        return found

    def _take(self, message: str | bytes) -> None:
        if isinstance(message, str):
            told = json.loads(message)
            self.told.update(told)
            if "event" in told:
                self.events.append(told["event"])
            return
        row = np.frombuffer(message, "<f8")
        self.frames.append(row)
        if row[0] == 1.0:
            names = [item["path"] for item in self.told["hello"]["items"]]
            for item, _, value in row[3 : 3 + 3 * int(row[2])].reshape(-1, 3):
                self.values[names[int(item)]] = value

    def ask(self, do: str, **facts: Any) -> str:
        """Ask for something, and return the error, or ""."""
        self._number += 1
        self.told.pop("answer", None)
        self.told.pop("error", None)
        self.socket.send(json.dumps({"do": do, "id": self._number, **facts}))
        self.until(lambda: self.told.get("answer") == self._number)
        return str(self.told.get("error", ""))

    def state(self, name: str) -> Any:
        """Return a part of the newest state, or []."""
        return self.told.get("state", {}).get(name, [])

    def item(self, path: str) -> int:
        return [item["path"] for item in self.told["hello"]["items"]].index(path)


@contextmanager
def robot(
    place: Place | None = None,
    *,
    spec: Spec | None = None,
    plant: Plant | None = None,
    options: str = "",
    extras: Extras | None = None,
    **board: Any,
) -> Iterator[Robot]:
    """Serve the dashboard of a virtual board, by default of TEXT. Nothing moves without a plant."""
    log = Log()
    made = spec if spec is not None else compiled()
    with ExitStack() as stack:
        configuration = BoardConfiguration.for_spec(made)
        plant = plant if plant is not None else Still()
        served = stack.enter_context(Board(made, configuration=configuration, plant=plant, **board))
        link = stack.enter_context(connect(served.url + options))
        page = stack.enter_context(
            open_dashboard(link, made, tokens(), log.put, place=place, read_hz=20.0, extras=extras)
        )
        yield Robot(served, link, page, log)


@contextmanager
def simulated(file: Path, plant: str, extras: Extras | None = None) -> Iterator[Robot]:
    """Serve the dashboard of a `sim:` link, whose time is that of the robot, however busy the machine is."""
    log = Log()
    with ExitStack() as stack:
        link = stack.enter_context(connect(f"sim:{file}?plant={plant}"))
        page = stack.enter_context(
            open_dashboard(link, load(file), tokens(), log.put, read_hz=20.0, extras=extras)
        )
        yield Robot(link.board, link, page, log)
