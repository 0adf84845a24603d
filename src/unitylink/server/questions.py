# SPDX-License-Identifier: BSD-3-Clause
"""Questions to a server, which need no link to the board: who is there, who may write, and passing that on.

A question is a line of words. The answer is a line of JSON. `unitylink status` and `unitylink lease` ask.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from unitylink import _native, errors
from unitylink.errors import UnityLinkError

if TYPE_CHECKING:
    from unitylink._native import Conversation
    from unitylink.server.robot import Robot
    from unitylink.server.tokens import User

TIMEOUT_S = 5.0  # for a question, and for its answer
WORDS = {"status": 0, "ask": 1, "give": 2, "break": 1}  # question -> how many words may follow


def ask_server(url: str, *words: str, timeout_s: float = TIMEOUT_S) -> dict[str, Any]:
    """Ask the server of a serve:// URL, and return its answer.

        ask_server("serve://127.0.0.1:7450/arm", "status")["robots"][0]["leases"]

    Raises the errors of opening such a link, and those of the server: AccessRefused, LeaseHeld, UnknownName.
    """
    for word in words:
        if not word or not word.isascii() or not word.isprintable() or " " in word:
            raise UnityLinkError(f"{word!r} is not one word of printable characters")
    answer: dict[str, Any] = json.loads(_native.ask_server(url, " ".join(words), timeout_s))
    if "error" in answer:
        kind = getattr(errors, str(answer["error"]), UnityLinkError)
        raise kind(answer["text"])
    return answer


def answer_question(talk: Conversation, user: User, where: str, robots: list[Robot], server: Any) -> None:
    """Answer the question of a client that has logged in. `server` tells about the whole server."""
    line = talk.read_line(TIMEOUT_S)
    if line is None:
        return talk.end()
    try:
        told = _answer(line.split(" "), user, where, robots, server)
    except UnityLinkError as error:
        told = {"error": type(error).__name__, "text": str(error)}
    talk.write(json.dumps(told) + "\n", TIMEOUT_S)
    return talk.end()


def _answer(words: list[str], user: User, where: str, robots: list[Robot], server: Any) -> dict[str, Any]:
    question, *more = words
    if question not in WORDS or len(more) > WORDS[question]:
        raise UnityLinkError(f"this server does not know the question {' '.join(words)!r}")
    if question == "status":
        return {**server(), "you": user.name, "robots": [robot.report() for robot in robots]}
    if len(robots) != 1:
        raise UnityLinkError(
            f"the URL names no board; there are: {', '.join(robot.name for robot in robots)}"
        )
    (robot,) = robots
    part = more[0] if more else "*"
    if question == "ask":
        return {"holders": robot.ask(user, where, part)}
    if question == "give":
        return {"kept_for": robot.give(user, where, part, more[1] if len(more) > 1 else "")}
    robot.break_up(user, where, part)
    return {}
