# SPDX-License-Identifier: BSD-3-Clause
"""A stand-in for an editor: it starts `unitylink lsp` and talks to it through pipes."""

from __future__ import annotations

import json
import os
import select
import subprocess
import sys
from collections.abc import Iterable, Sequence
from time import monotonic
from types import TracebackType
from typing import Any

from .figure import BenchError

_SERVER = (sys.executable, "-m", "unitylink", "lsp")
_CHUNK_BYTES = 65536


class LanguageClient:
    """One server process and the conversation with it.

    Answers and notifications are read in the order in which the server sends them. A server that hangs does
    not hang its caller. If no message comes within `patience_s`, or the server reads none, the process is
    killed and the caller gets a BenchError.
    """

    def __init__(
        self,
        *,
        encodings: Iterable[str] = ("utf-16",),
        command: Sequence[str] = _SERVER,
        patience_s: float = 60.0,
    ) -> None:
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0)
        assert self._process.stdin is not None and self._process.stdout is not None
        self._to_server = self._process.stdin.fileno()
        self._from_server = self._process.stdout.fileno()
        os.set_blocking(self._to_server, False)
        self.patience_s = patience_s
        self._unsent = bytearray()
        self._unread = bytearray()
        self._id = 0
        self.notifications: list[dict[str, Any]] = []
        general = {"positionEncodings": list(encodings)}
        parameters = {"processId": None, "rootUri": None, "capabilities": {"general": general}}
        try:
            self.capabilities: dict[str, Any] = self.request("initialize", parameters)["capabilities"]
            self.notify("initialized", {})
        except BaseException:
            self._kill()
            raise

    def request(self, method: str, parameters: object) -> Any:
        """Send a request and return its result. Raises BenchError if the server answers with an error."""
        self._id += 1
        self._send({"id": self._id, "method": method, "params": parameters})
        while True:
            message = self._receive()
            if message.get("id") == self._id and "method" not in message:
                if "error" in message:
                    raise BenchError(message["error"]["message"])
                return message["result"]
            self.notifications.append(message)

    def notify(self, method: str, parameters: object) -> None:
        """Send a notification, which has no answer."""
        self._send({"method": method, "params": parameters})

    def open(self, uri: str, text: str) -> list[dict[str, Any]]:
        """Open a text and return its diagnostics."""
        document = {"uri": uri, "languageId": "ulspec", "version": 0, "text": text}
        self.notify("textDocument/didOpen", {"textDocument": document})
        return self.diagnostics(uri, 0)

    def change(self, uri: str, version: int, text: str) -> list[dict[str, Any]]:
        """Replace the text and return the diagnostics of the new one."""
        document = {"uri": uri, "version": version}
        changes = [{"text": text}]
        self.notify("textDocument/didChange", {"textDocument": document, "contentChanges": changes})
        return self.diagnostics(uri, version)

    def diagnostics(self, uri: str, version: int) -> list[dict[str, Any]]:
        """Wait for the diagnostics of a version."""
        while True:
            message = self._receive()
            if message.get("method") == "textDocument/publishDiagnostics":
                parameters = message["params"]
                if parameters["uri"] == uri and parameters.get("version") == version:
                    found = parameters["diagnostics"]
                    assert isinstance(found, list)
                    return found
            self.notifications.append(message)

    def close(self) -> None:
        """End the server as the protocol says. Raises BenchError if it does not end well."""
        try:
            self.request("shutdown", None)
            self.notify("exit", None)
            assert self._process.stdin is not None
            self._process.stdin.close()
            code = self._process.wait(timeout=self.patience_s)
        except subprocess.TimeoutExpired as error:
            raise BenchError(f"the language server did not end within {self.patience_s:g} s") from error
        finally:
            self._kill()
        if code:
            raise BenchError(f"the language server ended with {code}")

    def __enter__(self) -> LanguageClient:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            self.close()
            return
        self._kill()

    def _kill(self) -> None:
        self._process.kill()
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            assert pipe is not None
            pipe.close()

    def _send(self, message: dict[str, object]) -> None:
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        self._unsent += b"Content-Length: %d\r\n\r\n" % len(body) + body
        until_s = monotonic() + self.patience_s
        while self._unsent:
            self._move(until_s)

    def _receive(self) -> dict[str, Any]:
        until_s = monotonic() + self.patience_s
        while True:
            head, found, rest = bytes(self._unread).partition(b"\r\n\r\n")
            length = _length_of(head) if found else 0
            if found and len(rest) >= length:
                self._unread = bytearray(rest[length:])
                message = json.loads(rest[:length])
                assert isinstance(message, dict)
                return message
            self._move(until_s)

    def _move(self, until_s: float) -> None:
        """Send and receive what is possible now, and wait for that until `until_s` at most.

        It does both, because a server may not read before its own output has been read.
        """
        poll = select.poll()
        poll.register(self._from_server, select.POLLIN)
        if self._unsent:
            poll.register(self._to_server, select.POLLOUT)
        ready = dict(poll.poll(max(until_s - monotonic(), 0.0) * 1000))
        if not ready:
            raise BenchError(f"the language server was silent for {self.patience_s:g} s")
        if self._from_server in ready:
            received = os.read(self._from_server, _CHUNK_BYTES)
            if not received:
                raise BenchError("the language server ended")
            self._unread += received
        if self._to_server in ready:
            try:
                del self._unsent[: os.write(self._to_server, self._unsent)]
            except BrokenPipeError as error:
                raise BenchError("the language server ended") from error


def _length_of(head: bytes) -> int:
    for line in head.split(b"\r\n"):
        name, _, value = line.partition(b":")
        if name.lower() == b"content-length":
            return int(value)
    raise BenchError(f"the language server sent a message without Content-Length: {head[:80]!r}")
