# SPDX-License-Identifier: BSD-3-Clause
"""The status page: for each user, of a server only, and with nothing of a client as HTML."""

from __future__ import annotations

from typing import Any

from unit.dashboard.robot import robot

from unitylink.dashboard.extras import Extras

CLIENT = {
    "id": 7,
    "name": "ana",
    "where": "<b>lab</b>",
    "age_s": 61.4,
    "silent_s": 0.01,
    "dead_man": True,
    "requests": 4711,
    "refused": 0,
    "repeats": 0,
    "discarded": 0,
    "publishes": 12,
    "publishes_lost": 3,
}
ARM: dict[str, Any] = {
    "name": "arm",
    "link": "tcp://board:1",
    "away": "",
    "stopped_by": "ben",
    "leases": [{"part": "j1", "holder": "ana", "where": "lab", "ending": ""}],
    "wishes": [{"part": "j1", "user": "cem", "left_s": 9.6, "kept": False}],
    "clients": [CLIENT],
    "statistics": {"retries": 5},
}


def test_status_page() -> None:
    told = {"refused": 2, "turned_away": 0, "log_lines_lost": 0, "robots": [ARM]}
    with robot(extras=Extras(report=lambda: told)) as served:
        assert served.request("GET", "/status")[0] == 401
        status, headers, body = served.request("GET", "/status", cookie=served.log_in("ben"))
    page = body.decode()
    assert (status, headers["content-type"]) == (200, "text/html; charset=utf-8")
    assert "You are ben" in page
    assert "stopped by ben" in page
    assert "<td>j1</td><td>ana</td><td>lab</td>" in page
    assert "<td>j1</td><td>cem</td><td></td><td>10 s</td>" in page
    assert "<td>4711</td>" in page
    assert "&lt;b&gt;lab" in page
    assert "<b>" not in page


def test_a_page_without_a_server_has_no_status() -> None:
    with robot() as served:
        status, _, body = served.request("GET", "/status", cookie=served.log_in("dan"))
    assert (status, b"unitylink serve" in body) == (404, True)


def test_prometheus_shows_a_token_with_each_request() -> None:
    told = {"refused": 2, "turned_away": 0, "log_lines_lost": 0, "robots": [ARM]}
    with robot(extras=Extras(report=lambda: told)) as served:
        status, headers, body = served.request("GET", "/metrics", authorization="Bearer ben")
        assert (status, headers["content-type"]) == (200, "text/plain; version=0.0.4; charset=utf-8")
        assert b'unitylink_client_requests_total{board="arm",user="ana"' in body
        assert served.request("GET", "/metrics", authorization="Bearer guess")[0] == 403
        for wrong in ({}, {"authorization": "Basic ben"}, {"cookie": served.log_in("ben")}):
            status, headers, body = served.request("GET", "/metrics", **wrong)
            assert (status, headers["www-authenticate"]) == (401, "Bearer")
            assert b"credentials_file" in body


def test_a_flood_of_guesses_at_the_metrics_is_refused() -> None:
    with robot(extras=Extras(report=lambda: {"robots": []})) as served:
        told = [served.request("GET", "/metrics", authorization="Bearer guess")[0] for _ in range(40)]
    assert told[0] == 403
    assert told[-1] == 429
