# SPDX-License-Identifier: BSD-3-Clause
"""What a viewer sees, and what it may do, over a real socket to a virtual board."""

from __future__ import annotations

import itertools
import json
import threading
import time
from collections.abc import Iterator

import numpy as np
import pytest
from unit.dashboard.robot import Robot, robot

from unitylink.errors import LinkTimeout
from unitylink.server.rate_limit import RateLimit
from unitylink.server.stop_switch import now


@pytest.fixture(scope="module")
def arm() -> Iterator[Robot]:
    with robot() as served:
        served.page.app.logins = RateLimit(1000, 1000)
        yield served


@pytest.fixture(autouse=True)
def calm(arm: Robot) -> Iterator[None]:
    """After each test nobody holds anything, and nobody has stopped the robot."""
    yield
    desk = arm.page.station.desk
    for _ in range(300):
        with desk.gate() as gate:
            if not gate.leases.all():
                break
        time.sleep(0.01)
    with desk.gate() as gate:
        stopped = gate.stopped_by
        owner = gate.login("cem", "calm", now())
    if stopped:
        desk.arm(owner, desk.switch.stops)
    with desk.gate() as gate:
        gate.logout(owner, now())


def test_the_page_and_what_it_is_made_of(arm: Robot) -> None:
    for path, kind in ("/", "text/html"), ("/page.js", "text/javascript"), ("/page.css", "text/css"):
        status, headers, body = arm.request("GET", path, accept_encoding="gzip")
        assert status == 200 and headers["content-type"].startswith(kind) and len(body) > 100
        assert "default-src 'self'" in headers["content-security-policy"]
        assert headers["x-content-type-options"] == "nosniff" and "server" not in headers
        assert arm.request("GET", path, if_none_match=headers["etag"])[0] == 304
    assert arm.request("GET", "/../server.py")[0] == 404


def test_hello_tells_the_spec_and_frames_bring_values(arm: Robot) -> None:
    arm.board.registers[0x11] = 123
    with arm.viewer() as viewer:
        hello = viewer.told["hello"]
        angle = hello["items"][viewer.item("j1.angle")]
        assert (angle["unit"], angle["digits"], angle["maximum"], angle["verb"]) == ("deg", 1, 90, None)
        grip = hello["items"][viewer.item("grip")]
        assert grip["members"] == [[0, "open"], [1, "hold"]] and grip["confirm"] == "Open it?"
        assert [part["path"] for part in hello["tree"]["parts"]] == ["j1", "j2"]
        assert hello["rates"][viewer.item("j1.angle")] == 100.0
        viewer.until(lambda: viewer.values.get("j1.angle") == 12.3)


def test_a_chart_gets_each_peak_once_and_then_what_follows(arm: Robot) -> None:
    with arm.viewer() as viewer:
        item = viewer.item("j2.angle")
        assert viewer.ask("view", series=[[item, 0.05, viewer.told["hello"]["now_s"]]]) == ""
        for number in range(5):
            arm.board.registers[0x21] = 100 + number
            time.sleep(0.15)
        seen: dict[float, tuple[float, float]] = {}

        def peak() -> bool:
            for row in viewer.frames:
                at = 3 + 3 * int(row[2])
                for _ in range(int(row[at])):
                    which, step, count = row[at + 1 : at + 4]
                    assert (which, step) == (item, 0.05)
                    rows = row[at + 4 : at + 4 + 3 * int(count)].reshape(-1, 3)
                    assert (np.diff(rows[:, 0]) > 0).all()
                    seen.update({bucket: (least, most) for bucket, least, most in rows})
                    at += 3 + 3 * int(count)
            viewer.frames.clear()
            return any(most == 10.4 for _, most in seen.values())

        viewer.until(peak)
        assert all(later - bucket == 1 for bucket, later in zip(list(seen), list(seen)[1:], strict=False))


def test_a_range_and_the_csv_of_it(arm: Robot) -> None:
    with arm.viewer() as viewer:
        viewer.until(lambda: viewer.values.get("j1.angle") is not None)
        end_s = arm.link.now_s()
        item = viewer.item("j1.angle")
        viewer.socket.send(
            json.dumps({"do": "range", "id": 900, "end_s": end_s, "series": [[item, 0.1, end_s - 1]]})
        )
        viewer.until(lambda: any(row[0] == 2.0 and row[1] == 900 for row in viewer.frames))
    cookie = arm.log_in()
    path = f"/csv?item=j1.angle&begin_s={end_s - 1}&end_s={end_s}"
    status, headers, body = arm.request("GET", path, cookie=cookie)
    lines = body.decode().split("\r\n")
    assert status == 200 and "attachment" in headers["content-disposition"]
    assert lines[0] == "item,unit,time_s,least,greatest" and lines[1].startswith("j1.angle,deg,")
    assert arm.request("GET", path)[0] == 401
    assert arm.request("GET", path, cookie=arm.log_in("ben"))[0] == 403
    assert arm.request("GET", "/csv?item=none", cookie=cookie)[0] == 400


def test_writes_need_control_and_reach_the_board_together(arm: Robot) -> None:
    with arm.viewer() as ana, arm.viewer("cem") as cem:
        assert ana.ask("take", part="") == ""
        assert ana.ask("write", values={"j1.target": 12.5, "j2.target": -3, "grip": "hold"}) == ""
        assert (arm.board.registers[0x12], arm.board.registers[0x22] & 0xFFFF) == (125, 0xFFE2)
        assert "owner holds the write lease" in cem.ask("write", values={"j1.target": 1})
        assert "is not in -90 to 90 deg; nothing was sent" in ana.ask("write", values={"j1.target": 91})
        assert "not in" in ana.ask("write", values={"j1.target": 5, "j2.target": 1e9})
        assert arm.board.registers[0x12] == 125, "nothing of a wrong write is sent"
        ana.until(lambda: [one["holder"] for one in ana.state("leases")] == ["owner"])
        assert ana.ask("release", part="") == ""
        assert cem.ask("write", values={"j1.target": 1}) == ""
    arm.log.until("write", user="cem", values={"j1.target": 1})


def test_wide_numbers_travel_as_texts(arm: Robot) -> None:
    big = 2**64 - 3
    with arm.viewer() as viewer:
        assert viewer.ask("write", values={"wide": str(big)}) == ""
        wide = viewer.item("wide")
        viewer.until(lambda: viewer.told.get("texts", {}).get(str(wide)) == str(big))


def test_a_lease_that_is_lost_makes_its_part_safe(arm: Robot) -> None:
    with arm.viewer() as viewer:
        assert viewer.ask("take", part="j1", seconds=30) == ""
        assert viewer.ask("write", values={"j1.target": 45}) == ""
        assert arm.board.registers[0x12] == 450
    with arm.viewer("cem") as cem:  # the first one has gone
        cem.until(lambda: arm.board.registers[0x12] == 0)
        cem.until(lambda: cem.state("leases") == [])
        assert cem.ask("take", part="j1") == ""


def test_stop_goes_its_own_way_and_nobody_writes_until_arm(arm: Robot) -> None:
    with arm.viewer("cem") as cem, arm.viewer("ana") as ana:
        assert cem.ask("write", values={"j1.target": 20, "j2.target": 20}) == ""
        seen = cem.until(lambda: cem.state("stops"))
        status, _, body = arm.request("POST", "/stop", cookie=arm.log_in("ben"))  # who may only look may stop
        assert status == 200 and json.loads(body)["wrote"] == 3
        assert (arm.board.registers[0x12], arm.board.registers[0x22]) == (0, 0)
        assert "ben has stopped the robot" in cem.ask("write", values={"j1.target": 20})
        assert "stops is no whole number" in cem.ask("arm")
        cem.until(lambda: cem.state("stops") != seen)
        assert "after this was asked for; if it may move, arm it again" in cem.ask("arm", stops=seen)
        assert "ana may not arm" in ana.ask("arm", stops=cem.state("stops"))
        assert cem.ask("arm", stops=cem.state("stops")) == ""
        assert cem.ask("write", values={"j1.target": 20}) == ""
    assert arm.request("POST", "/stop")[0] == 401


def test_stop_works_while_every_other_thread_waits_for_the_board(
    arm: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Requests that hang fill all threads. A stop is written all the same, and again after them."""
    held, entered = threading.Event(), threading.Event()
    link = type(arm.link)
    original = link.write_many

    def hang(self: object, addresses: object, values: object, **options: object) -> None:
        if threading.current_thread().name.startswith("unitylink-desk"):
            entered.set()
            held.wait(10)
        original(self, addresses, values, **options)  # type: ignore[arg-type]

    arm.board.registers[0x12] = 77
    with arm.viewer() as viewer:
        assert viewer.ask("take", part="", seconds=60) == ""
        monkeypatch.setattr(link, "write_many", hang)
        monkeypatch.setattr(link, "write", lambda self, a, v, **o: hang(self, [a], [v], **o))
        for number in range(8):
            viewer.socket.send(json.dumps({"do": "write", "id": 100 + number, "values": {"j1.target": 60}}))
        assert entered.wait(5)
        cookie = arm.log_in()
        done: list[int] = []
        stopping = threading.Thread(
            target=lambda: done.append(arm.request("POST", "/stop", cookie=cookie)[0])
        )
        stopping.start()
        viewer.until(lambda: arm.board.registers[0x12] == 0, 5)
        held.set()
        stopping.join(10)
        assert done == [200]
    assert arm.board.registers[0x12] == 0, "the write that hung came after the stop"


def test_a_stop_that_the_board_does_not_answer_says_so(arm: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    def silent(*_: object, **__: object) -> None:
        raise LinkTimeout("no answer")

    cookie = arm.log_in()
    with monkeypatch.context() as patched:
        patched.setattr(type(arm.link), "write_many", silent)
        patched.setattr(type(arm.link), "trip", silent)
        status, _, body = arm.request("POST", "/stop", cookie=cookie)
        assert status == 502 and "no answer" in json.loads(body)["error"]
    assert arm.request("POST", "/stop", cookie=cookie)[0] == 200


def test_users_see_and_write_only_their_parts(arm: Robot) -> None:
    arm.board.registers[0x21] = 5
    with arm.viewer("ben") as ben, arm.viewer("ana") as ana:
        assert ben.told["hello"]["writes"] == [] and ana.told["hello"]["writes"] == ["j1"]
        ben.until(lambda: ben.values.get("j2.angle") == 0.5)
        assert set(ben.values) <= {"j2.angle", "j2.speed", "j2.target"}
        series = [[ben.item("j1.angle"), 0.1, 0.0]]
        assert "ben may not read it" in ben.ask("view", series=series)
        assert "may not write" in ana.ask("write", values={"j2.target": 1})
        assert ana.ask("write", values={"j1.target": 1}) == ""


def test_a_pulse_and_flags_that_are_cleared(arm: Robot) -> None:
    with arm.viewer() as viewer:
        assert viewer.ask("pulse", path="reset") == ""
        viewer.until(lambda: "faults" in viewer.values)
        assert viewer.ask("clear", path="faults") == ""
        assert "is a WRITE" in viewer.ask("pulse", path="j1.target")


def test_the_owner_takes_control_away(arm: Robot) -> None:
    with arm.viewer("cem") as cem, arm.viewer() as owner:
        assert cem.ask("take", part="", seconds=60) == ""
        assert cem.ask("write", values={"j2.target": 9}) == ""
        assert "may not admin" in cem.ask("break", part="")
        assert owner.ask("break", part="") == ""
        owner.until(lambda: arm.board.registers[0x22] == 0)
        owner.until(lambda: owner.state("leases") == [])
        assert owner.ask("take", part="") == ""
        assert "owner holds" in cem.ask("write", values={"j2.target": 9})


def test_who_wants_control_is_shown_and_gets_it_back_given(arm: Robot) -> None:
    with arm.viewer("cem") as cem, arm.viewer() as owner:
        assert cem.ask("take", part="j2", seconds=60) == ""
        assert owner.ask("ask", part="") == ""
        cem.until(lambda: cem.state("wishes") == [{"part": "", "user": "owner"}])
        assert cem.ask("release", part="j2") == ""
        cem.until(lambda: cem.state("wishes") == [])
        assert "kept for owner" in cem.ask("take", part="j2")
        assert owner.ask("take", part="j2") == ""


def test_logging_out_ends_the_sockets_of_that_browser(arm: Robot) -> None:
    with arm.viewer("cem") as cem:
        cookie = arm.log_in("cem")
        assert arm.request("POST", "/logout", cookie=cookie)[0] == 204
        assert arm.request("POST", "/stop", cookie=cookie)[0] == 401
        assert cem.ask("alive") == "", "another browser of the same user goes on"


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "{}",
        '{"do": 3}',
        '{"do": "fly"}',
        '{"do": "view", "id": -1}',
        '{"do": "view", "series": [[0, 0, 0]]}',
        '{"do": "view", "series": [[99, 1, 0]]}',
        '{"do": "view", "series": [[true, 1, 0]]}',
        '{"do": "view", "series": [[0, NaN, 0]]}',
        '{"do": "range", "series": [[0, 1, 0]], "end_s": 1e400}',
        '{"do": "write", "values": {}}',
        '{"do": "write", "values": {"none": 1}}',
        '{"do": "write", "values": {"j1.angle": 1}}',
        '{"do": "write", "values": {"j1.target": {"a": []}}}',
        '{"do": "write", "values": {"j1.target": null}}',
        '{"do": "take", "part": "nothing"}',
        '{"do": "take", "part": "", "seconds": -1}',
        '{"do": "take", "part": 5}',
        '{"do": "pulse", "path": 7}',
        "[" * 30_000,
        '{"do": "' + "x" * 30_000 + '"}',
    ],
    ids=itertools.count(),
)
def test_nonsense_is_answered_and_harms_nobody(arm: Robot, text: str) -> None:
    with arm.viewer() as viewer:
        viewer.socket.send(text)
        viewer.until(lambda: "error" in viewer.told)
        assert len(viewer.told["error"]) < 1000
        assert viewer.ask("alive") == ""
