# SPDX-License-Identifier: BSD-3-Clause
"""What a server tells about its clients and leases, and how a lease is passed on."""

from __future__ import annotations

import json
from collections.abc import Iterator

import pytest

from tests.unit.server.served import Served, served, token_of
from tests.unit.server.test_losses import freeze_process
from tests.unit.server.test_serving import socket_of, until, written
from unitylink.cli import main
from unitylink.errors import AccessRefused, LeaseHeld, LinkNotFound, UnityLinkError, UnknownName, UrlError
from unitylink.server.lease_watch import LeaseWatch
from unitylink.server.questions import ask_server
from unitylink.server.serving import TALKS_MAX

TARGET, POWER = 0x1A, 0x1B


@pytest.fixture
def one() -> Iterator[Served]:
    with served() as all_of_it:
        yield all_of_it


def asked(one: Served, token: str, *words: str) -> dict[str, object]:
    with token_of(token):
        return ask_server(one.url(), *words)


def test_everybody_can_see_who_is_there_and_who_writes(one: Served) -> None:
    with one.link("moves") as ana, one.link("looks") as ben:
        ana.write(TARGET, 1)
        ben.read(0x50)
        told = asked(one, "looks", "status")
        (robot,) = told["robots"]
        assert [client["name"] for client in robot["clients"]] == ["moves", "looks"]
        assert [(lease["holder"], lease["part"]) for lease in robot["leases"]] == [("moves", "target")]
        assert robot["leases"][0]["where"] == robot["clients"][0]["where"]
        assert robot["away"] == "" and robot["clients"][1]["requests"] > 0
    events = [json.loads(line)["event"] for line in one.lines]
    assert events.count("login") == 2  # a question is no login
    assert "up" in events


def test_a_lease_is_asked_for_and_handed_over(one: Served) -> None:
    with one.link("moves") as holder, one.link("all") as wants, one.link("all") as third:
        holder.write(TARGET, 5)
        assert asked(one, "all", "ask", "target") == {"holders": ["moves"]}
        wishes = asked(one, "moves", "status")["robots"][0]["wishes"]
        assert [(wish["user"], wish["part"], wish["kept"]) for wish in wishes] == [("all", "target", False)]
        with pytest.raises(LeaseHeld):
            wants.write(TARGET, 6)
        assert asked(one, "moves", "give", "target") == {"kept_for": "all"}
        for refused in (lambda: holder.write(TARGET, 7),):  # at once, although its connection goes on
            with pytest.raises(LeaseHeld):
                refused()
        assert one.board.registers[TARGET] == 5  # in order: not made safe
        wants.write(TARGET, 6)
        assert one.board.registers[TARGET] == 6
        with pytest.raises(LeaseHeld):
            third.write(TARGET, 8)
        assert asked(one, "all", "status")["robots"][0]["wishes"] == []
    events = [json.loads(line) for line in one.lines]
    assert {"event": "asked", "user": "all", "part": "target"}.items() <= next(
        entry for entry in events if entry["event"] == "asked"
    ).items()


def test_a_program_is_told_while_it_runs_and_hands_over(one: Served) -> None:
    told: list[tuple[str, str]] = []

    def hand_over(part: str, user: str) -> None:
        told.append((part, user))
        ask_server(one.url(), "give", part, user)

    with one.link("moves") as holder, one.link("all") as wants, token_of("moves"):
        holder.write(TARGET, 5)
        with LeaseWatch(one.url(), hand_over, look_s=0.01):
            asked(one, "all", "ask", "target")
            until(lambda: written(wants, TARGET, 6))
    assert told == [("target", "all")]
    assert one.board.registers[TARGET] == 6


def test_a_watch_logs_what_nobody_handles(one: Served, caplog: pytest.LogCaptureFixture) -> None:
    def broken(part: str, user: str) -> None:
        raise ValueError("this program has a mistake")

    with one.link("moves") as holder, token_of("moves"):
        holder.write(TARGET, 5)
        asked(one, "all", "ask", "target")  # before the watch: it is told, too
        with LeaseWatch(one.url(), look_s=0.01), LeaseWatch(one.url(), broken, look_s=0.01):
            until(lambda: "all wants to write target" in caplog.text and "has a mistake" in caplog.text)
    assert caplog.text.count("all wants to write target") == 1


def test_a_watch_needs_a_server() -> None:
    with pytest.raises(LinkNotFound), token_of("moves"):
        LeaseWatch("serve://127.0.0.1:1/arm")


def test_who_may_pass_a_lease_on(one: Served) -> None:
    with one.link("all") as holder:
        holder.write(TARGET, 5)
        with pytest.raises(AccessRefused, match="all holds it, and moves may not admin"):
            asked(one, "moves", "give", "target")
        with pytest.raises(AccessRefused, match="needs the scope `write target"):
            asked(one, "looks", "ask", "target")
        with pytest.raises(AccessRefused, match="needs the scope `admin`"):
            asked(one, "moves", "break", "*")
        with pytest.raises(UnknownName, match="did you mean target"):
            asked(one, "all", "ask", "targt")
        with pytest.raises(UnknownName, match="no token of this server is that of eve"):
            asked(one, "all", "give", "target", "eve")
        with pytest.raises(LeaseHeld, match="nobody holds"):
            asked(one, "all", "give", "power")
        holder.write(TARGET, 6)  # nothing has happened


def test_a_broken_lease_is_made_safe_first(one: Served) -> None:
    with one.link("moves") as holder, one.link("all") as other:
        holder.write(TARGET, 5)
        assert asked(one, "all", "break", "target") == {}
        until(lambda: one.board.registers[TARGET] == 0)
        until(lambda: written(other, TARGET, 9))


@pytest.mark.takes(3)
def test_a_holder_that_is_silent_loses_its_lease() -> None:
    with served(silence_s=0.5) as one, one.link("all") as other:
        with freeze_process(one, TARGET) as frozen:
            assert one.board.registers[TARGET] == 3
            until(lambda: written(other, TARGET, 9))
            assert frozen.poll() is None  # its connection is still there
        events = [json.loads(line) for line in one.lines]
        assert [entry["event"] for entry in events if entry["event"] in ("lost", "safe")] == ["lost", "safe"]


@pytest.mark.parametrize("words", [["status", "x"], ["nothing"], ["ask"], ["give", "a", "b", "c"]])
def test_questions_that_are_none(one: Served, words: list[str]) -> None:
    if words == ["ask"]:
        assert asked(one, "all", *words) == {"holders": []}  # for the whole robot
        return
    with pytest.raises(UnityLinkError, match="does not know the question"):
        asked(one, "all", *words)


def test_wrong_questions_are_told_before_anything_is_sent(one: Served) -> None:
    with pytest.raises(UnityLinkError, match="not one word"):
        asked(one, "all", "ask", "two words")
    with pytest.raises(UrlError, match="only a server answers questions"):
        ask_server("tcp://127.0.0.1:1", "status")
    with pytest.raises(AccessRefused, match="token is wrong"):
        asked(one, "guess", "status")


def test_who_asks_and_says_nothing_holds_nobody_up(one: Served) -> None:
    silent = [socket_of(one) for _ in range(TALKS_MAX + 2)]
    try:
        for caller in silent:
            caller.sendall(b"unitylink-serve 1 arm looks ask\n")
        told = [caller.recv(1000).split()[0] for caller in silent]
        assert told.count(b"admitted") == TALKS_MAX and told.count(b"refused") == 2
        with one.link() as link:
            link.write(0x50, 4)
        for line in (b"x" * 600, b"\n", b"status\xff\n"):
            with socket_of(one) as caller:
                caller.sendall(b"unitylink-serve 1 arm looks ask\n" + line)
    finally:
        for caller in silent:
            caller.close()
    until(lambda: asked_well(one))


def asked_well(one: Served) -> bool:
    try:
        return bool(asked(one, "looks", "status"))
    except UnityLinkError:
        return False


def test_the_commands(one: Served, capsys: pytest.CaptureFixture[str]) -> None:
    with token_of("all"), one.link("moves") as holder:
        holder.write(TARGET, 5)
        url = f"serve://{one.server.place}/arm"
        assert main(["lease", url, "ask", "target"]) == 0
        assert "moves is asked for it" in capsys.readouterr().out
        assert main(["status", url]) == 0
        told = capsys.readouterr().out
        assert "moves from 127.0.0.1:" in told and "writes target" in told
        assert "target is wanted by all" in told and "requests/s" in told
        assert main(["lease", url, "give", "target", "--to", "looks"]) == 0
        assert "target is kept for looks" in capsys.readouterr().out
        assert main(["status", url, "--json"]) == 0
        assert json.loads(capsys.readouterr().out)["robots"][0]["wishes"][-1]["kept"] is True
        assert main(["lease", url, "break", "target"]) == 0
        assert main(["lease", url, "ask", "target", "--to", "x"]) == 2
