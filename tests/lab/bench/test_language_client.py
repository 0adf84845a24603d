# SPDX-License-Identifier: BSD-3-Clause
"""If a language server hangs, ends or sends nonsense, its client gets an error and no process is left."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import pytest

from unitylink_lab.bench.figure import BenchError
from unitylink_lab.bench.language_client import LanguageClient

SERVER = """
import json, sys
def send(message):
    body = json.dumps(message)
    print(f"Content-Length: {len(body)}\\r\\n\\r", body, sep="\\n", end="", flush=True)
def read():
    length = int(sys.stdin.readline().split(":")[1])
    sys.stdin.readline()
    return json.loads(sys.stdin.read(length))
def answer(result):
    send({"id": read()["id"], "result": result})
def hang():
    import signal
    signal.pause()
"""
GREETING = "answer({'capabilities': {}}); read()\n"
LARGE = "x" * 1_000_000  # more than a pipe holds


@pytest.fixture(autouse=True)
def processes(monkeypatch: pytest.MonkeyPatch) -> list[subprocess.Popen[bytes]]:
    started: list[subprocess.Popen[bytes]] = []

    class Recorded(subprocess.Popen[bytes]):
        def __init__(self, *arguments: Any, **named: Any) -> None:
            super().__init__(*arguments, **named)
            started.append(self)

    monkeypatch.setattr(subprocess, "Popen", Recorded)
    return started


def client_of(program: str, patience_s: float = 60.0) -> LanguageClient:
    return LanguageClient(command=(sys.executable, "-c", SERVER + program), patience_s=patience_s)


def test_a_server_that_never_answers(processes: list[subprocess.Popen[bytes]]) -> None:
    with pytest.raises(BenchError, match=r"the language server was silent for 0\.1 s"):
        client_of("hang()", patience_s=0.1)
    assert processes[0].returncode is not None


@pytest.mark.parametrize(
    "does", ["hang()", "read(); hang()", "print('Content-Length: 9', flush=True); hang()"]
)
def test_a_server_that_hangs_later(processes: list[subprocess.Popen[bytes]], does: str) -> None:
    with pytest.raises(BenchError, match="silent"), client_of(GREETING + does) as client:
        client.patience_s = 0.1
        client.request("textDocument/hover", {"text": LARGE})
    assert processes[0].returncode is not None


def test_a_server_that_does_not_end(processes: list[subprocess.Popen[bytes]]) -> None:
    client = client_of(GREETING + "answer(None); read(); hang()")
    client.patience_s = 0.1
    with pytest.raises(BenchError, match=r"silent|did not end within 0\.1 s"):
        client.close()
    assert processes[0].returncode is not None


@pytest.mark.parametrize(
    ("program", "message"),
    [
        ("sys.exit()", "the language server ended$"),
        ("answer(None); read(); sys.exit(3)", "the language server ended with 3"),
        ("print('Hello: 1\\r\\n\\r', flush=True); hang()", "without Content-Length: b'Hello: 1'"),
    ],
)
def test_a_server_that_ends_badly(
    processes: list[subprocess.Popen[bytes]], program: str, message: str
) -> None:
    client = client_of(GREETING + program)
    with pytest.raises(BenchError, match=message):
        client.close()
    assert processes[0].returncode is not None


def test_both_sides_may_send_more_than_a_pipe_holds() -> None:
    """The server reads the request only after its own notification was read."""
    program = f"""
send({{"method": "log", "params": "x" * {len(LARGE)}}})
question = read()
send({{"id": question["id"], "result": len(question["params"])}})
answer(None); read()
"""
    with client_of(GREETING + program) as client:
        assert client.request("textDocument/hover", LARGE) == len(LARGE)
        assert client.notifications == [{"method": "log", "params": LARGE}]
