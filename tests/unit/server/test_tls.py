# SPDX-License-Identifier: BSD-3-Clause
"""Encrypted connections to a server: who may come in, what goes over the network, and what attackers get."""

from __future__ import annotations

import contextlib
import json
import random
import socket
import ssl
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from threading import Thread

import pytest

from tests.unit.server.certificates import certificate
from tests.unit.server.served import Served, served, token_of
from tests.unit.server.test_serving import socket_of, until
from unitylink import Link
from unitylink.cli import main
from unitylink.errors import DeviceMismatch, LinkClosed, LinkError, LinkNotFound, UnityLinkError, UrlError
from unitylink.server.tls_files import TlsFiles


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("certificates")
    certificate(folder, "server", "IP:127.0.0.1", "DNS:localhost")
    certificate(folder, "elsewhere", "DNS:elsewhere.test")
    certificate(folder, "lab-pc")
    certificate(folder, "stranger")
    return folder


@pytest.fixture(scope="module")
def one(files: Path) -> Iterator[Served]:
    with served(tls=TlsFiles(f"{files}/server.pem", f"{files}/server-key.pem")) as all_of_it:
        yield all_of_it


@pytest.fixture(scope="module")
def both_sides(files: Path) -> Iterator[Served]:
    """A server that wants a certificate from its clients, too."""
    tls = TlsFiles(f"{files}/server.pem", f"{files}/server-key.pem", f"{files}/lab-pc.pem")
    with served(tls=tls) as all_of_it:
        yield all_of_it


def test_everything_works_encrypted(one: Served, files: Path) -> None:
    trust = f"&tls_ca={files}/server.pem"
    with one.link(options=trust) as ana, one.link("looks", trust) as ben:
        ana.write_many([0x40 + n for n in range(32)], list(range(32)))
        assert ben.read_many([0x40 + n for n in range(32)]).tolist() == list(range(32))
        ana.post_many([0x47] * 3000, list(range(3000)))
        ana.sync()
        with ben.subscribe([0x12, 0x13], divisor=1) as positions:
            until(lambda: positions.available > 200)
            assert positions.missing == 0
        assert one.board.registers[0x47] == 2999


def test_a_long_flood_in_both_directions(one: Served, files: Path) -> None:
    words = [0x40 + n for n in range(28)]
    with one.link(options=f"&tls_ca={files}/server.pem") as link, ExitStack() as stack:
        for _ in range(3):
            stack.enter_context(link.subscribe(words, divisor=1, verify=False))
        for value in range(300):
            assert (
                link.exchange(writes=[(word, value) for word in words], reads=words).tolist() == [value] * 28
            )


def test_nothing_readable_goes_over_the_network(one: Served, files: Path) -> None:
    """A relay between the two sees neither the token nor the name of the board."""
    seen = bytearray()
    with relay(one, seen) as port, contextlib.suppress(LinkError):
        url = f"serve://127.0.0.1:{port}/arm?timeout=2&tls_ca={files}/server.pem"
        with token_of("all"), Link(url) as link:
            link.write(0x50, 7)
    assert one.board.registers[0x50] == 7
    assert len(seen) > 500
    assert b"unitylink" not in seen and b" arm " not in seen


@contextlib.contextmanager
def relay(one: Served, seen: bytearray) -> Iterator[int]:
    host, port = one.server.place.rsplit(":", 1)
    listener = socket.create_server(("127.0.0.1", 0))

    def pump(source: socket.socket, sink: socket.socket) -> None:
        with contextlib.suppress(OSError):
            while data := source.recv(65536):
                seen.extend(data)
                sink.sendall(data)
            sink.shutdown(socket.SHUT_WR)

    def serve() -> None:
        client, _ = listener.accept()
        with client, socket.create_connection((host, int(port))) as server:
            back = Thread(target=pump, args=(server, client), daemon=True)
            back.start()
            pump(client, server)
            back.join()

    thread = Thread(target=serve, daemon=True)
    thread.start()
    try:
        yield listener.getsockname()[1]
    finally:
        listener.close()
        thread.join(10)


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ("", DeviceMismatch, r"this server wants TLS; add \?tls_ca=FILE"),
        ("&tls_ca={}/stranger.pem", DeviceMismatch, "certificate is not trusted: self"),
        ("&tls_ca=system", DeviceMismatch, "certificate is not trusted"),
        ("&tls_ca={}/nothing.pem", LinkNotFound, "nothing.pem: .*; expected the certificates of who signs"),
        ("&tls_ca={}/server.pem&tls_cert={}/lab-pc.pem", LinkNotFound, "expected the key of the certificate"),
        (
            "&tls_ca={}/server.pem&tls_cert={}/lab-pc.pem&tls_key={}/stranger-key.pem",
            LinkNotFound,
            "stranger-key.pem: ",
        ),
        ("&tls_cert={}/lab-pc.pem", UrlError, "need tls_ca=FILE"),
        ("&tls_ca={}/server.pem&tls_key={}/lab-pc-key.pem", UrlError, "tls_key needs tls_cert=FILE"),
    ],
)
def test_what_a_client_can_do_wrong(
    one: Served, files: Path, options: str, error: type[UnityLinkError], words: str
) -> None:
    with pytest.raises(error, match=words):
        one.link(options=options.replace("{}", str(files)))


def test_another_host_with_a_certificate_that_is_trusted(files: Path) -> None:
    with (
        served(tls=TlsFiles(f"{files}/elsewhere.pem", f"{files}/elsewhere-key.pem")) as other,
        pytest.raises(
            DeviceMismatch, match=r"not trusted: IP address mismatch; is tls_ca= right, and the name"
        ),
    ):
        other.link(options=f"&tls_ca={files}/elsewhere.pem")


def test_a_server_without_tls(files: Path) -> None:
    with served() as plain, pytest.raises(LinkClosed, match=r"does the server have --tls-cert\?"):
        plain.link(options=f"&tls_ca={files}/server.pem")


def test_a_client_shows_its_certificate(both_sides: Served, files: Path) -> None:
    mine = f"&tls_ca={files}/server.pem&tls_cert={files}/lab-pc.pem&tls_key={files}/lab-pc-key.pem"
    with both_sides.link("looks", mine) as link:
        assert link.read(0x50) == 0
    logins = [entry for entry in map(json.loads, both_sides.lines) if entry["event"] == "login"]
    assert logins[-1]["where"].endswith(" with the certificate lab-pc")
    with pytest.raises(LinkError, match="token is wrong"):  # the certificate alone is not enough
        both_sides.link("guess", mine)


@pytest.mark.parametrize("shown", [None, "stranger"])
def test_a_client_without_the_right_certificate(both_sides: Served, files: Path, shown: str | None) -> None:
    mine = f"&tls_cert={files}/{shown}.pem&tls_key={files}/{shown}-key.pem" if shown else ""
    before = both_sides.server.report()["turned_away"]
    with pytest.raises(LinkClosed, match=r"TLS has failed: .*(certificate|unknown ca)|closed|reset"):
        both_sides.link(options=f"&tls_ca={files}/server.pem{mine}&attempts=1")
    until(lambda: both_sides.server.report()["turned_away"] > before)


def test_no_older_version(one: Served, files: Path) -> None:
    context = ssl.create_default_context(cafile=f"{files}/server.pem")
    context.maximum_version = ssl.TLSVersion.TLSv1_2
    with socket_of(one) as bare, pytest.raises(ssl.SSLError, match="version"):
        context.wrap_socket(bare, server_hostname="127.0.0.1")


@pytest.mark.parametrize("seed", range(3))
def test_attackers_disturb_nobody(one: Served, files: Path, seed: int) -> None:
    """Garbage instead of a handshake, within it, within a session; handshakes that end half way."""
    chance = random.Random(seed)
    context = ssl.create_default_context(cafile=f"{files}/server.pem")
    with one.link(options=f"&tls_ca={files}/server.pem") as link, ExitStack() as stack:
        for value in range(30):
            bare = stack.enter_context(socket_of(one))
            with contextlib.suppress(OSError):
                match value % 3:
                    case 0:
                        bare.sendall(bytes([0x16, 3, 1]) + chance.randbytes(chance.randrange(600)))
                    case 1:
                        incoming, outgoing = ssl.MemoryBIO(), ssl.MemoryBIO()
                        with contextlib.suppress(ssl.SSLWantReadError):
                            context.wrap_bio(incoming, outgoing, server_hostname="localhost").do_handshake()
                        hello = outgoing.read()
                        bare.sendall(hello[: chance.randrange(1, len(hello))])
                    case _:
                        inside = context.wrap_socket(bare, server_hostname="localhost")
                        inside.sendall(b"unitylink-serve 1 arm all\n")
                        assert inside.recv(1000).startswith(b"admitted")
                        raw = socket.socket(fileno=inside.detach())
                        raw.sendall(bytes([0x17, 3, 3, 1, 0]) + chance.randbytes(256))
                        raw.close()
            link.write(0x51, value)
        assert one.board.registers[0x51] == 29
        until(lambda: len(one.robot.report()["clients"]) == 1)


def test_a_configuration_is_checked(files: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = tmp_path / "arm.ul"
    spec.write_text("public arm() { @goal = 0x10: WRITE(); }")
    words = ["serve", "tcp://127.0.0.1:1", str(spec), "--check-config", "--listen", "0.0.0.0:7450"]
    tls = ["--tls-cert", f"{files}/server.pem", "--tls-key", f"{files}/server-key.pem"]
    assert main([*words, *tls]) == 2
    told = capsys.readouterr().err
    assert "add --anyone" in told and "unencrypted" not in told
    assert main([*words, *tls, "--anyone"]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "encrypted"
    assert main([*words, "--anyone", *tls[2:]]) == 2
    assert "--tls-key needs --tls-cert FILE" in capsys.readouterr().err
    assert main([*words, "--anyone", *tls[:2]]) == 1
    assert "expected the key of the certificate" in capsys.readouterr().err


def test_a_key_that_everybody_can_read(files: Path, tmp_path: Path) -> None:
    key = tmp_path / "key.pem"
    key.write_bytes((files / "server-key.pem").read_bytes())
    key.chmod(0o644)
    with pytest.raises(UnityLinkError, match="chmod o-rwx"):
        TlsFiles(f"{files}/server.pem", str(key)).check()
