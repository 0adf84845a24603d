# SPDX-License-Identifier: BSD-3-Clause
"""The page and Foxglove's server with TLS: who comes in, and what a silent caller gets."""

from __future__ import annotations

import http.client
import json
import socket
import ssl
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from websockets.exceptions import WebSocketException
from websockets.sync.client import connect as open_socket

from tests.unit.server.certificates import certificate
from tests.unit.server.served import Served, served
from unitylink.dashboard import server as page_server
from unitylink.dashboard.opening import page_of
from unitylink.dashboard.place import Place
from unitylink.dashboard.server import Dashboard
from unitylink.server.tls_files import TlsFiles
from unitylink.streams.foxglove import server as foxglove_server
from unitylink.streams.foxglove.server import Foxglove
from unitylink.streams.hand import Hand


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("certificates")
    certificate(folder, "server", "IP:127.0.0.1", "DNS:localhost")
    certificate(folder, "tablet")
    return folder


@pytest.fixture(scope="module")
def one() -> Iterator[Served]:
    with served() as all_of_it:
        yield all_of_it


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(page_server, "HANDSHAKE_S", 0.2)
    monkeypatch.setattr(foxglove_server, "HANDSHAKE_S", 0.2)


@pytest.fixture
def page(one: Served, files: Path, short: None) -> Iterator[Dashboard]:
    link = one.robot.board_link()
    place = Place(tls=tls_of(files))
    with page_of(link, one.robot.spec, one.robot.gate, one.robot.switch, place=place) as opened:
        yield opened


def tls_of(files: Path, authorities: str = "") -> TlsFiles:
    return TlsFiles(
        f"{files}/server.pem", f"{files}/server-key.pem", authorities and f"{files}/{authorities}"
    )


def trusting(files: Path, shown: str = "") -> ssl.SSLContext:
    context = ssl.create_default_context(cafile=f"{files}/server.pem")
    if shown:
        context.load_cert_chain(f"{files}/{shown}.pem", f"{files}/{shown}-key.pem")
    return context


def log_in(page: Dashboard, context: ssl.SSLContext) -> tuple[int, str]:
    place = urlsplit(page.url)
    connection = http.client.HTTPSConnection(place.hostname, place.port, timeout=10, context=context)
    try:
        headers = {"Content-Type": "application/json", "Origin": page.url}
        connection.request("POST", "/login", json.dumps({"token": "looks"}), headers)
        answer = connection.getresponse()
        return answer.status, answer.getheader("set-cookie") or ""
    finally:
        connection.close()


def test_the_page_and_its_values_are_encrypted(page: Dashboard, files: Path) -> None:
    assert page.url.startswith("https://")
    status, cookie = log_in(page, trusting(files))
    assert status == 204 and "secure" in cookie.lower()
    headers = {"Cookie": cookie.partition(";")[0]}
    url = f"{page.url.replace('http', 'ws', 1)}/socket"
    with open_socket(
        url, additional_headers=headers, origin=page.url, ssl=trusting(files), proxy=None
    ) as viewer:
        assert "hello" in json.loads(viewer.recv(timeout=10))


def test_who_does_not_encrypt_or_trust_gets_nothing(page: Dashboard, files: Path) -> None:
    place = urlsplit(page.url)
    plain = http.client.HTTPConnection(place.hostname, place.port, timeout=10)
    with pytest.raises((OSError, http.client.HTTPException)):
        plain.request("GET", "/")
        plain.getresponse()
    plain.close()
    with pytest.raises(ssl.SSLCertVerificationError):
        log_in(page, ssl.create_default_context())
    old = trusting(files)
    old.maximum_version = ssl.TLSVersion.TLSv1_2
    with pytest.raises((ssl.SSLError, ConnectionError)):
        log_in(page, old)


def test_a_page_for_certificates_alone(one: Served, files: Path) -> None:
    link = one.robot.board_link()
    place = Place(tls=tls_of(files, "tablet.pem"))
    with page_of(link, one.robot.spec, one.robot.gate, one.robot.switch, place=place) as page:
        with pytest.raises((OSError, http.client.HTTPException)):
            log_in(page, trusting(files))
        assert log_in(page, trusting(files, "tablet"))[0] == 204


@pytest.mark.parametrize("said", [b"", b"\x16\x03\x01\x02\x00\x01"])
def test_a_caller_that_does_not_finish_the_handshake_is_gone(page: Dashboard, said: bytes) -> None:
    assert closed_by(page.url, said)


def test_foxglove_is_encrypted(one: Served, files: Path, short: None) -> None:
    foxglove = Foxglove(Hand(one.robot), Place(tls=tls_of(files)))
    try:
        assert foxglove.url.startswith("wss://")
        url = f"{foxglove.url}/?token=looks"
        protocols = ["foxglove.sdk.v1"]
        with open_socket(url, subprotocols=protocols, ssl=trusting(files), proxy=None) as client:
            assert json.loads(client.recv(timeout=10))["name"] == "arm"
        with pytest.raises((OSError, EOFError, WebSocketException)):
            open_socket(url.replace("wss", "ws", 1), subprotocols=protocols, proxy=None)
        assert closed_by(foxglove.url, b"")
    finally:
        foxglove.close()


def closed_by(url: str, said: bytes) -> bool:
    """Say so much at the place of a URL, and tell whether the server ends the connection."""
    place = urlsplit(url)
    with socket.create_connection((place.hostname, place.port), timeout=20) as caller:
        caller.sendall(said)
        try:
            while caller.recv(1000):
                pass
        except ConnectionResetError:
            pass
    return True
