# SPDX-License-Identifier: BSD-3-Clause
"""A robot over a real Zenoh router: what clients get, what is executed once, and what is refused."""

from __future__ import annotations

import json
import math
import random
import struct
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from typing import Any

import pytest
from unit.zenoh.rig import ANGLE, BASE_S, GOAL, HITS, STAMP, Gap, Rig, rigged, until

from unitylink import connect
from unitylink.errors import (
    AccessRefused,
    DeviceMismatch,
    LeaseHeld,
    LinkBusy,
    LinkDown,
    LinkNotFound,
    OutcomeUnknown,
    UrlError,
    ValueRangeError,
)
from unitylink.interface.wire_hash import wire_hashes
from unitylink.server.gate import Client
from unitylink.server.scopes import Rights
from unitylink.server.tokens import User
from unitylink.spec import compile_text
from unitylink.zenoh.bridge import bridge
from unitylink.zenoh.bridge.visits import Visit
from unitylink.zenoh.link import ZenohLink
from unitylink.zenoh.messages import DO, ONCE, WRITE_VALUE, Request, SetPoint

ADD, READ = 21, 1


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Rig]:
    with rigged(tmp_path_factory.mktemp("zenoh")) as rig:
        yield rig


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


def opened(stack: ExitStack, rig: Rig, more: str = "", port: int | None = None) -> ZenohLink:
    link = stack.enter_context(connect(rig.url(more, port)))
    assert isinstance(link, ZenohLink)
    return link


def refused(rig: Rig, reason: str) -> tuple[int, str]:
    told = rig.bridge.refusals.report().get(reason, {"count": 0, "last": ""})
    return int(told["count"]), str(told["last"])


class Stranger:
    """Somebody who has the package of Zenoh, and nothing of ours but the page of the protocol."""

    def __init__(self, stack: ExitStack, rig: Rig, name: str = "stranger", **hello: Any) -> None:
        self.session = stack.enter_context(rig.network.opened())
        stack.enter_context(self.session.liveliness().declare_token(f"lab/arm1/client/{name}"))
        self.told = self.ask("hello", json.dumps({"client": name, **hello}).encode())

    def ask(self, key: str, payload: bytes | None = None) -> Any:
        for reply in self.session.get(f"lab/arm1/{key}", payload=payload, timeout=2.0):
            data = reply.ok.payload.to_bytes() if reply.ok else reply.err.payload.to_bytes()
            return json.loads(data) if data[:1] == b"{" else data
        return None

    def deadline_ns(self, ttl_s: float) -> int:
        return int(struct.unpack("<Qq", self.ask("clock"))[1]) + int(ttl_s * 1e9)


def test_the_objects_are_the_same_as_on_any_link(stack: ExitStack, rig: Rig) -> None:
    began_s = time.monotonic()
    link = opened(stack, rig)
    robot = link.robot()
    robot["j1.goal"].write(-0.25)
    assert rig.board.registers[GOAL] == 0x10000 - 250
    assert robot["j1.angle"].read() == 0.25
    assert robot.snapshot()["j1.angle"] == 0.25
    with link.batch() as batch:
        batch.write_masked(HITS, 0xF0, 0x50)
        word = batch.read(HITS)
    assert word.value == 0x50
    rows: list[tuple[float, float]] = []
    robot["j1.angle"].on_publish(lambda time_s, value: rows.append((time_s, value)))
    with robot.publishing():
        until(lambda: len(rows) >= 20)
    assert {value for _, value in rows} == {0.25}
    ended_s = time.monotonic()
    trip_s = (
        ended_s - began_s
    )  # longer than each question for the clock; a time is wrong by half of that at most
    assert all(began_s - trip_s < time_s < ended_s + trip_s for time_s, _ in rows)
    link.check_spec("arm.ul", wire_hashes(rig.spec, "arm"))
    other = compile_text("public arm() { @x = 0x1: READ(); }", "other.ul").spec
    assert other is not None
    with pytest.raises(DeviceMismatch, match=r"another spec than other\.ul"):
        link.check_spec("other.ul", wire_hashes(other, "arm"))


def test_who_only_reads_cannot_write(stack: ExitStack, rig: Rig) -> None:
    stranger = Stranger(stack, rig, "looker")
    stack.enter_context(stranger.session.liveliness().declare_token("lab/arm1/client/reader"))
    told = stranger.ask("hello_read", json.dumps({"client": "reader"}).encode())
    assert told["may"] == "read"
    before, _ = refused(rig, "access")
    stamp = rig.board.registers[STAMP]
    body = struct.pack("<I", stamp + 1)
    point = SetPoint("lab/arm1/set/stamp", told["visit"], 1, stranger.deadline_ns(1.0), body)
    stranger.session.put("lab/arm1/set/stamp", point.encode())
    until(lambda: refused(rig, "access")[0] > before)
    assert rig.board.registers[STAMP] == stamp


def test_who_may_read_a_part_reads_no_other(rig: Rig) -> None:
    part = Client(99, User("part", Rights.of(["read j1"])), "a test")

    def request(kind: int, address: int) -> Request:
        return Request(kind, 1, 1, argument=10, operations=((READ, address, 0, 0),))

    assert rig.bridge._executor.words(part, request(DO, ANGLE)) == [250]
    for_it = Visit(1, "part", part, 0)
    for ask in rig.bridge._executor.words, lambda _, asked: [rig.bridge._requests._subscribed(for_it, asked)]:
        with pytest.raises(AccessRefused, match="part may not read 0x0030"):
            ask(part, request(DO, HITS))


def test_one_client_at_a_time_writes_a_part(stack: ExitStack, rig: Rig) -> None:
    first, second = opened(stack, rig).robot(), opened(stack, rig).robot()
    first["j2.goal"].write(0.5)
    with pytest.raises(LeaseHeld, match="j2"):
        second["j2.goal"].write(0.6)
    second["j1.goal"].write(0.7)
    shown = second["j1.goal"].hardware.link.state()["leases"]
    assert {one["part"] for one in shown} == {"j1", "j2"}
    watcher = stack.enter_context(rig.network.opened())

    def leased() -> set[str]:
        found = watcher.liveliness().get("lab/arm1/lease/**", timeout=1.0)
        return {str(one.ok.key_expr).split("/")[3] for one in found if one.ok}

    until(lambda: leased() == {"j1", "j2"})
    first["j2.goal"].hardware.link.close()
    second["j2.goal"].write(0.6)
    assert rig.board.registers[0x20] == 600, "who goes in order leaves the outputs as they are"


def test_a_client_that_dies_leaves_its_part_safe(stack: ExitStack, rig: Rig) -> None:
    link = opened(stack, rig)
    link.robot()["j1.goal"].write(1.0)
    assert rig.board.registers[GOAL] == 1000
    began_s = time.monotonic()
    link._far.bridge.session.close()  # as if it were killed: no goodbye
    until(lambda: rig.board.registers[GOAL] == 0)
    assert time.monotonic() - began_s < 1.5


def test_an_answer_that_is_lost_or_late_executes_nothing_twice(stack: ExitStack, rig: Rig) -> None:
    gap = Gap(rig.port)
    stack.callback(gap.close)
    link = opened(stack, rig, "&timeout=0.15&attempts=4", gap.port)
    link.write(HITS, 0)
    gap.back.clear()  # requests arrive, answers do not
    waiting = time.monotonic()
    later = _after(0.25, gap.back.set)
    with link.batch() as batch:
        batch.add(HITS, 1)
    later.join()
    assert time.monotonic() - waiting >= 0.15, "the first answer was late"
    assert link.statistics().retries >= 1
    assert link.read(HITS) == 1
    assert rig.bridge.state()["clients"][0]["requests_again"] >= 1

    gap.back.clear()
    with pytest.raises(OutcomeUnknown, match="executed once or never"), link.batch() as batch:
        batch.add(HITS, 1)
    gap.back.set()
    until(lambda: rig.board.registers[HITS] == 2)
    assert link.read(HITS) == 2, "late answers do no harm"


@pytest.mark.parametrize("what", ["write", "arm"])
def test_a_request_that_arrives_after_its_client_has_given_up_is_not_executed(
    stack: ExitStack, rig: Rig, what: str
) -> None:
    gap = Gap(rig.port)
    stack.callback(gap.close)
    link = opened(stack, rig, "&timeout=0.1&attempts=2", gap.port)
    link.write(HITS, 7)
    if what == "arm":
        link.trip()
    gap.there.clear()
    before = refused(rig, "board")[0]
    with pytest.raises(OutcomeUnknown):
        link.arm() if what == "arm" else link.write(HITS, 8)
    time.sleep(0.1)
    gap.there.set()
    until(lambda: refused(rig, "board")[0] > before)
    assert "too late" in refused(rig, "board")[1]
    assert rig.board.registers[HITS] == 7 and bool(rig.bridge.state()["stopped_by"]) == (what == "arm")
    link.arm()


def test_copies_of_a_request_get_one_answer(stack: ExitStack, rig: Rig) -> None:
    stranger = Stranger(stack, rig)
    bridge, visit = stranger.told["bridge"], stranger.told["visit"]
    rig.board.registers[HITS] = 0
    request = Request(DO, visit, 1, 1, 0, ONCE, operations=((ADD, HITS, 1, 0), (READ, HITS, 0, 0)))
    answers = [stranger.ask(f"do/{bridge}", request.encode()) for _ in range(5)]
    assert answers == [answers[0]] * 5 and answers[0][-4:] == struct.pack("<I", 1)
    assert rig.board.registers[HITS] == 1


def test_set_points_are_fresh_or_not_executed(stack: ExitStack, rig: Rig) -> None:
    """The machine behind the board sees when each set-point was written. Each carries when it was sent."""
    gap = Gap(rig.port)
    stack.callback(gap.close)
    link = opened(stack, rig, port=gap.port)
    stamps = link.set_points("stamp", ttl_s=0.1)

    def send() -> int:
        now_ms = int((time.monotonic() - BASE_S) * 1000)
        stamps.send(now_ms)
        time.sleep(0.004)
        return now_ms

    rig.oracle.seen.clear()
    for _ in range(50):
        last = send()
    until(lambda: rig.oracle.seen[-1][1] == last)
    late = refused(rig, "late")[0]
    gap.there.clear()
    stale = {send() for _ in range(40)}
    time.sleep(0.2)  # now all of them are too old
    gap.there.set()

    def fresh_one_is_written() -> bool:
        with suppress(LinkDown, LeaseHeld):  # on a busy machine the client was taken for lost, and is greeted
            return rig.oracle.seen[-1][1] > max(stale) or send() < 0
        return False

    until(fresh_one_is_written)
    assert not stale & {value for _, value in rig.oracle.seen}, "nothing old was executed"
    # a busy machine drops some on the way already
    assert refused(rig, "late")[0] > late or link.statistics().reconnections
    ages_s = [seen_s - BASE_S - value / 1000 for seen_s, value in rig.oracle.seen if value]
    assert max(ages_s) < 0.1 + 0.1, "the oracle itself may be late on a busy machine"
    assert rig.bridge.state()["set_points"]["written"] >= 2


def test_the_last_set_point_of_a_burst_is_written(stack: ExitStack, rig: Rig) -> None:
    """Zenoh drops what finds no room in its queue, and that would be the newest one."""
    goals = opened(stack, rig).set_points("j1.goal", ttl_s=5.0)
    before = sum(rig.bridge.state()["set_points"].values())
    for number in range(1, 13):
        goals.send(number / 1000)
    until(lambda: sum(rig.bridge.state()["set_points"].values()) == before + 12)
    assert rig.board.registers[GOAL] == 12


def test_a_stop_and_what_follows(stack: ExitStack, rig: Rig) -> None:
    link, stranger = opened(stack, rig), Stranger(stack, rig)
    goal = link.robot()["j1.goal"]
    goal.write(1.0)
    stranger.session.put("lab/arm1/stop", b"")
    until(lambda: rig.board.registers[GOAL] == 0)
    with pytest.raises(AccessRefused, match="stopped the robot"):
        goal.write(1.0)
    until(lambda: _passes(link.arm))  # not before the stop, for whose end nobody waits, is over
    until(lambda: _passes(lambda: goal.write(0.5)))
    link.trip()
    assert rig.board.registers[GOAL] == 0
    link.arm()


def test_a_stranger_needs_nothing_but_the_key(stack: ExitStack, rig: Rig) -> None:
    stranger = Stranger(stack, rig)
    schema = stranger.ask("schema")
    assert schema["values"]["j1/angle"]["type"] == "f64"
    assert struct.unpack("<d", stranger.ask("value/j1/angle")) == (0.25,)
    several = stranger.session.get("lab/arm1/value/*/angle", timeout=2.0)
    assert {str(one.ok.key_expr) for one in several} == {"lab/arm1/value/j1/angle", "lab/arm1/value/j2/angle"}
    body = struct.pack("<d", 0.125)
    request = Request(WRITE_VALUE, stranger.told["visit"], 1, 1, stranger.deadline_ns(1), body=body)
    assert isinstance(stranger.ask("value/j2/goal", request.encode()), bytes)
    assert rig.board.registers[0x20] == 125
    got: list[bytes] = []
    topic = next(iter(schema["publish"]))
    with stranger.session.declare_subscriber(
        f"lab/arm1/publish/{topic}", lambda sample: got.append(sample.payload.to_bytes())
    ):
        until(lambda: len(got) >= 10)
    offset = schema["publish"][topic]["fields"][0]["offset"]
    assert struct.unpack_from("<d", got[0], offset) == (0.25,)
    numbers = [struct.unpack_from("<I", one)[0] for one in got]
    assert numbers == list(range(numbers[0], numbers[0] + len(got)))


def test_a_subscriber_waits_for_no_look_of_the_bridge(
    stack: ExitStack, rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bridge, "LOOK_S", 60.0)
    time.sleep(0.3)  # the look that was under way
    session = stack.enter_context(rig.network.opened())
    for _ in range(2):
        came = threading.Event()
        with session.declare_subscriber("lab/arm1/publish/**", lambda sample, came=came: came.set()):
            assert came.wait(5.0)
        until(lambda: not rig.bridge._groups._groups)
    monkeypatch.undo()
    rig.bridge._news.set()  # else it looks again after a minute only


def test_what_is_refused_is_counted_and_named(stack: ExitStack, rig: Rig) -> None:
    stranger = Stranger(stack, rig)
    visit, bridge, goal = stranger.told["visit"], stranger.told["bridge"], "lab/arm1/set/j1/goal"

    def put(key: str, body: bytes, ttl_s: float = 1.0, of: int = visit, number: int = 1) -> None:
        point = SetPoint(key, of, number, stranger.deadline_ns(ttl_s), body)
        stranger.session.put(key, point.encode())

    def counted(reason: str, text: str, before: int) -> None:
        until(lambda: refused(rig, reason)[0] > before, 3)
        assert text in refused(rig, reason)[1]

    for reason, text, act in (
        ("value", "goal", lambda: put(goal, struct.pack("<d", math.nan))),
        ("value", "2.0 rad is not in -1.5 to 1.5 rad", lambda: put(goal, struct.pack("<d", 2.0))),
        ("malformed", "7 bytes of values", lambda: put(goal, b"1234567")),
        ("malformed", "its head alone", lambda: stranger.session.put(goal, b"")),
        ("wildcard", "lab/arm1/set/*/goal", lambda: put("lab/arm1/set/*/goal", struct.pack("<d", 0))),
        ("unknown", "no set-point of this name", lambda: put("lab/arm1/set/j9", struct.pack("<d", 0))),
        ("unknown", "not said hello", lambda: put(goal, struct.pack("<d", 0), of=5)),
        ("late", "goal", lambda: put(goal, struct.pack("<d", 0), ttl_s=-0.001)),
        ("time to live", "goal", lambda: put(goal, struct.pack("<d", 0), ttl_s=3600)),
        ("malformed", "its head alone", lambda: stranger.ask(f"do/{bridge}", b"?")),
        ("spec", "made from 00", lambda: Stranger(stack, rig, "old", hash="00" * 8)),
        ("access", "there already", lambda: stranger.ask("hello", b'{"client":"stranger"}')),
        ("malformed", "a hello is JSON", lambda: stranger.ask("hello", b"\xff")),
        ("wildcard", "for one robot", lambda: _asked_all(stranger)),
    ):
        before = refused(rig, reason)[0]
        act()
        counted(reason, text, before)
    chance, before = random.Random(1), refused(rig, "malformed")[0]
    for _ in range(300):
        stranger.session.put(goal, chance.randbytes(chance.randrange(40)))
        stranger.session.put(f"lab/arm1/do/{bridge}", b"x")  # a put where queries are answered
    until(lambda: refused(rig, "malformed")[0] + refused(rig, "unknown")[0] >= before + 250)
    assert opened(stack, rig).read(ANGLE) == 250, "the bridge works on"


def _asked_all(stranger: Stranger) -> None:
    for _ in stranger.session.get("lab/*/hello", payload=b"{}", timeout=2.0):
        pass


def test_a_second_robot_of_the_name(stack: ExitStack, rig: Rig) -> None:
    with pytest.raises(LinkBusy, match="another bridge serves lab/arm1 already"):
        rig.made(rig.network)
    link = opened(stack, rig)
    session = stack.enter_context(rig.network.opened())
    with session.liveliness().declare_token("lab/arm1/board/00ff"):  # as after a network was cut in two
        until(lambda: not link.up)
        with pytest.raises(LinkDown, match="2 robots have the name"):
            link.write(HITS, 1)
        with pytest.raises(DeviceMismatch, match="2 robots have the name"):
            connect(rig.url())
    assert link.wait_up(3) and link.read(ANGLE) == 250


@pytest.mark.parametrize(
    ("url", "why"),
    [
        ("zenoh:lab/*", "wildcard"),
        ("zenoh:", "is no name"),
        ("zenoh:lab/arm1?speed=1", "no option 'speed'"),
        ("zenoh:lab/arm1?timeout=x", "could not convert"),
        ("zenoh:lab/arm1?attempts=0", "attempts are 1 to"),
        ("zenoh:lab/arm1?connect=here", "Zenoh does not take connect/endpoints of here"),
    ],
)
def test_a_url_that_cannot_be_understood(url: str, why: str) -> None:
    with pytest.raises(UrlError, match=why):
        connect(url)


def test_nobody_is_there(rig: Rig) -> None:
    with pytest.raises(LinkNotFound, match="no board of this name"):
        connect(rig.url().replace("arm1", "arm9"))
    with pytest.raises(ValueRangeError, match="time to live"), connect(rig.url()) as link:
        link.set_points("j1", ttl_s=math.nan)


def _after(delay_s: float, act: Any) -> threading.Timer:
    timer = threading.Timer(delay_s, act)
    timer.start()
    return timer


def _passes(act: Any) -> bool:
    try:
        act()
    except (LeaseHeld, AccessRefused):  # the part is being made safe, or the robot is being stopped
        return False
    return True


def test_who_looks_at_all_keys_stops_no_robot(rig: Rig) -> None:
    """Tools for Zenoh list a network by such queries, and storages put and ask by wildcards."""

    def refused() -> int:
        return int(rig.bridge.refusals.report().get("wildcard", {"count": 0})["count"])

    before = refused()
    with rig.network.opened() as session:
        for everything in ("lab/**", "lab/arm1/*"):
            assert "lab/arm1/stop" not in [str(one.ok.key_expr) for one in session.get(everything) if one.ok]
            session.put(everything, b"")
        until(lambda: refused() >= before + 10)  # each: two hellos, two stops, a set-point
        assert rig.bridge.state()["stopped_by"] == ""
        (reply,) = session.get("lab/*/stop", timeout=2.0)  # all robots, and said so
        assert json.loads(reply.ok.payload.to_bytes()) == {"outputs": 3}
    with connect(rig.url()) as link:
        link.arm()


def test_everybody_on_the_network_may_stop_the_robot(rig: Rig) -> None:
    """A stop needs no hello and no lease."""
    with rig.network.opened() as session:
        (reply,) = session.get("lab/arm1/stop", timeout=2.0)
        assert json.loads(reply.ok.payload.to_bytes()) == {"outputs": 3}
    with connect(rig.url()) as link:
        link.arm()
    assert rig.board.registers[STAMP] == 0
