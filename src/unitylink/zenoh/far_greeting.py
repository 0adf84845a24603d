# SPDX-License-Identifier: BSD-3-Clause
"""How a client finds the bridge of its robot on Zenoh, and says hello to it."""

from __future__ import annotations

import json
import secrets
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from unitylink.errors import DeviceMismatch, LinkNotFound, LinkTimeout, UnityLinkError

from .far_questions import PAUSE_S
from .hello import read_welcome

if TYPE_CHECKING:
    import zenoh

    from .far_options import FarOptions
    from .far_questions import FarQuestions

LOOK_S = 1.0  # how long to look for the board


@dataclass(frozen=True)
class Welcome:
    """What a bridge has `told`, asked and heard at these times. `token` says that the client is there."""

    told: dict[str, Any]
    token: zenoh.LivelinessToken
    asked_ns: int
    heard_ns: int


class FarGreeting:
    """Greets, as a new client each time. All methods raise UnityLinkError."""

    def __init__(self, options: FarOptions, session: zenoh.Session, questions: FarQuestions) -> None:
        self._options, self._keys = options, options.keys
        self._session, self._questions = session, questions

    def boards(self) -> set[str]:
        """Return the bridges of this name whose boards are there now."""
        found = self._session.liveliness().get(self._keys.board("*"), timeout=LOOK_S)
        return {str(one.ok.key_expr).rpartition("/")[2] for one in found if one.ok is not None}

    def find(self) -> set[str]:
        """Return the same, once there is one. Raises LinkNotFound if there is none for a second."""
        until_s = time.monotonic() + LOOK_S
        while not (boards := self.boards()):
            if time.monotonic() > until_s:
                raise LinkNotFound(
                    f"{self._options.url}: no board of this name is on the network; is `unitylink bridge` "
                    "running there, and does its board answer?"
                )
            time.sleep(PAUSE_S)
        return boards

    def greet(self, boards: set[str], known_hash: str) -> Welcome:
        """Say hello to the only bridge of `boards`. `known_hash` is that of the spec before, or ""."""
        if len(boards) > 1:
            raise DeviceMismatch(
                f"{len(boards)} robots have the name {self._keys.name} on this network; stop one bridge"
            )
        name = "-".join(filter(None, (self._options.name, secrets.token_hex(8))))
        token = self._session.liveliness().declare_token(self._keys.client(name))
        answer, asked_ns = self._hello(json.dumps({"client": name}).encode())
        heard_ns = time.monotonic_ns()
        try:
            if not isinstance(answer, bytes):
                raise answer or LinkTimeout(f"{self._options.url}: the bridge does not say hello")
            told = read_welcome(answer)
            if told["bridge"] not in boards:
                raise DeviceMismatch(f"two bridges have the name {self._keys.name} on this network")
            self._check_hash(told["hash"], known_hash)
        except BaseException:
            token.undeclare()
            raise
        return Welcome(told, token, asked_ns, heard_ns)

    def _hello(self, hello: bytes) -> tuple[bytes | UnityLinkError | None, int]:
        """Say hello. Return the answer, and when the bridge was asked.

        If there is nobody, the network does not let us write, and perhaps it lets us read. Or the bridge has
        just come back, and its keys are not there yet: its clock comes after them.
        """
        ask = self._questions
        until_s = time.monotonic() + LOOK_S
        while True:
            asked_ns = time.monotonic_ns()
            answer = ask.once(self._keys.fixed("hello"), hello, LOOK_S)
            if answer is not None or ask.reached or time.monotonic() > until_s:
                return answer, asked_ns
            if ask.once(self._keys.fixed("clock"), b"", LOOK_S) is not None:
                break
            time.sleep(PAUSE_S)
        for key in ("hello", "hello_read"):
            asked_ns = time.monotonic_ns()
            answer = ask.once(self._keys.fixed(key), hello, LOOK_S)
            if answer is not None or ask.reached:
                break
        return answer, asked_ns

    def _check_hash(self, told: str, known: str) -> None:
        wanted = self._options.spec_hash
        for one, whose in ((known, "before"), (wanted if wanted != "any" else "", "in the URL")):
            if one and one != told and wanted != "any":
                raise DeviceMismatch(
                    f"{self._options.url}: the robot has the spec {told}; {whose} it was {one}"
                )
