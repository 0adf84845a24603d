# SPDX-License-Identifier: BSD-3-Clause
"""Who does not get in, and what a slow or hostile client cannot do."""

from __future__ import annotations

import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack

import pytest
from unit.dashboard.robot import Robot, robot
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect as open_socket

from unitylink.dashboard import listening
from unitylink.dashboard.place import Place, read_place
from unitylink.dashboard.web_app import LOGIN_BURST, LOGINS_HZ
from unitylink.errors import UnityLinkError
from unitylink.server.listening import listen
from unitylink.server.rate_limit import RateLimit, SharedLimit


@pytest.fixture(scope="module")
def arm() -> Iterator[Robot]:
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(listening, "HEADERS_S", 0.4)
        with robot() as served:
            served.page.app.logins = RateLimit(1000, 1000)
            yield served


def test_a_wrong_token_is_refused_and_told_in_the_audit_log(arm: Robot) -> None:
    status, headers, body = arm.request("POST", "/login", {"token": "guess"})
    assert status == 403 and b"does not know this token" in body and "set-cookie" not in headers
    arm.log.until("refused", action="login")
    assert "guess" not in "".join(arm.log.lines)
    for nonsense in ({}, [], {"token": 5}, "x", {"token": "y" * 5000}):
        assert arm.request("POST", "/login", nonsense)[0] in (400, 403)


def test_the_cookie_is_for_this_server_alone(arm: Robot) -> None:
    _, headers, _ = arm.request("POST", "/login", {"token": "owner"})
    cookie = headers["set-cookie"]
    assert "HttpOnly" in cookie and "SameSite=strict" in cookie and "owner" not in cookie
    assert cookie.startswith(f"unitylink_{arm.host.rpartition(':')[2]}=")


@pytest.mark.parametrize("host", ["evil.test", "evil.test:80", "127.0.0.1", "127.0.0.1:1", ""])
def test_a_foreign_name_is_refused(arm: Robot, host: str) -> None:
    """A page of evil.test that lets its name point to 127.0.0.1 (DNS rebinding)."""
    status, headers, body = arm.request("GET", "/", host=host)
    assert status == 403 and b"does not go by this name" in body
    assert "default-src 'self'" in headers["content-security-policy"]


def test_a_foreign_page_is_refused_everywhere(arm: Robot) -> None:
    cookie = arm.log_in()
    for origin in ("http://evil.test", f"https://{arm.host}", "null"):
        assert arm.request("POST", "/stop", origin=origin, cookie=cookie)[0] == 403
        with pytest.raises(InvalidStatus) as refused:
            open_socket(
                f"ws://{arm.host}/socket", origin=origin, additional_headers={"Cookie": cookie}, proxy=None
            ).close()
        assert refused.value.response.status_code == 403
    assert arm.request("POST", "/stop", origin=f"http://{arm.host}", cookie=cookie)[0] == 200


def test_a_log_that_hangs_holds_up_no_stop(arm: Robot) -> None:
    arm.log.flows.clear()
    try:
        assert arm.request("POST", "/stop", cookie=arm.log_in("dan"))[0] == 200
        assert not any('"stop"' in line and '"dan"' in line for line in arm.log.lines)
    finally:
        arm.log.flows.set()
    arm.log.until("stop", user="dan")


def test_a_socket_without_a_session_is_told_why(arm: Robot) -> None:
    with open_socket(f"ws://{arm.host}/socket", proxy=None) as opened:
        assert "log in" in str(opened.recv(timeout=5))
        with pytest.raises(ConnectionClosed):
            opened.recv(timeout=5)


def test_a_frame_that_is_too_long_ends_its_socket_alone(arm: Robot) -> None:
    with arm.viewer("cem") as other, arm.viewer() as viewer:
        viewer.socket.send("x" * 70_000)
        with pytest.raises(ConnectionClosed):
            viewer.until(lambda: False, 5)
        assert other.ask("alive") == ""


def test_a_flood_of_requests_gets_errors_not_service(arm: Robot) -> None:
    with arm.viewer() as viewer:
        for _ in range(400):
            viewer.socket.send('{"do":"alive"}')
        viewer.until(lambda: "more than 100 requests" in viewer.told.get("error", ""))
    with arm.viewer() as other:
        assert other.ask("alive") == ""


def test_the_pages_of_a_user_share_a_limit(arm: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(arm.page.station, "limits", SharedLimit(rate_hz=0.001, burst=5))
    with ExitStack() as stack:
        pages = [stack.enter_context(arm.viewer("cem")) for _ in range(10)]
        assert [page.ask("alive") for page in pages + pages] == [""] * 20
        for page in pages:  # none of them has asked much
            page.socket.send('{"do":"alive"}')
            page.until(lambda page=page: "more than 0.004 requests" in page.told.get("error", ""))
        with arm.viewer() as other:
            assert other.ask("alive") == ""


@pytest.mark.parametrize(
    "sent", [b"", b"GET / HTTP/1.1\r\nHost: a", b"GET / HTTP/1.1\r\nA: " + b"b" * 100_000]
)
def test_headers_have_a_deadline_and_a_size(arm: Robot, sent: bytes) -> None:
    host, _, port = arm.host.rpartition(":")
    with socket.create_connection((host, int(port)), timeout=5) as opened:
        began = time.monotonic()
        opened.sendall(sent)
        try:
            while opened.recv(4096):
                pass
        except ConnectionResetError:
            pass
        assert time.monotonic() - began < 4


def test_a_byte_now_and_then_does_not_move_the_deadline(arm: Robot) -> None:
    host, _, port = arm.host.rpartition(":")
    with socket.create_connection((host, int(port)), timeout=5) as opened:
        first = b"GET /icon.svg HTTP/1.1\r\nHost: " + arm.host.encode() + b"\r\n\r\n"
        for request in (first, b"GET / HTTP/1.1\r\nX: "):  # also after a request that was in order
            opened.sendall(request)
            time.sleep(0.05)
        with pytest.raises(OSError):
            for _ in range(40):
                opened.sendall(b"y")
                time.sleep(0.05)


def test_a_storm_of_logins_is_slowed_down(arm: Robot) -> None:
    arm.page.app.logins = RateLimit(LOGINS_HZ / 1000, LOGIN_BURST)  # so slow that no other work is slower
    answers = [arm.request("POST", "/login", {"token": "guess"})[0] for _ in range(LOGIN_BURST + 20)]
    assert 429 in answers
    arm.page.app.logins = RateLimit(1000, 1000)


def test_the_most_viewers() -> None:
    with robot() as small:
        small.page.app.most = 1
        with small.viewer() as one:
            cookie = small.log_in()
            headers = {"Cookie": cookie}
            with open_socket(f"ws://{small.host}/socket", additional_headers=headers, proxy=None) as second:
                assert "there are 1 viewers" in str(second.recv(timeout=5))
            assert one.ask("alive") == ""


def test_it_ends_within_two_seconds_also_with_a_viewer_who_does_not_read() -> None:
    with robot() as served:
        cookie = served.log_in()
        host, _, port = served.host.rpartition(":")
        with socket.create_connection((host, int(port))) as stuck:
            stuck.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            stuck.sendall(
                f"GET /socket HTTP/1.1\r\nHost: {served.host}\r\nCookie: {cookie}\r\nUpgrade: websocket\r\n"
                "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n".encode()
            )
            with served.viewer() as viewer:
                began = time.monotonic()
                served.page.close()
                assert time.monotonic() - began < 2.5
                with pytest.raises(ConnectionClosed):
                    viewer.until(lambda: False, 5)
                assert viewer.told["bye"] == "the server ends"


def test_places() -> None:
    assert set(Place("10.0.0.7", names=("lab",)).hosts(80)) == {"10.0.0.7:80", "10.0.0.7", "lab:80", "lab"}
    assert "localhost:5" in set(Place().hosts(5)) and "[::1]:5" in set(Place().hosts(5))
    assert read_place("0.0.0.0:1").exposed and read_place("1").url(7) == "http://127.0.0.1:7"
    for wrong in ("", "x", ":-1", "1.2.3.4:99999", "a:٣"):
        with pytest.raises(UnityLinkError, match="expected"):
            read_place(wrong)
    with pytest.raises(UnityLinkError, match="--listen"):
        listen("192.0.2.1", 0)
