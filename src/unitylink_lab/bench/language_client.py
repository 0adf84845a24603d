# SPDX-License-Identifier: BSD-3-Clause
"""An editor as far as the language server can tell: it starts `unitylink lsp` and talks to it on pipes."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterable
from threading import Event, Thread
from time import monotonic
from types import TracebackType
from typing import Any

from .figure import BenchError

_PATIENCE_S = 60.0  # for one message, however long the conversation


class LanguageClient:
    """One server process and its conversation.

    Answers and notifications are read in the order in which the server sends them.
    """

    def __init__(self, *, encodings: Iterable[str] = ("utf-16",)) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "unitylink", "lsp"], stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )
        self._over = Event()
        self._waits_since_s: float | None = None
        Thread(target=self._watch, daemon=True).start()  # a silent server must not hang its caller
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
        """Send a request and return its result. BenchError if the server answers with an error."""
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
        """Send a notification: nothing is answered."""
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
        """End the server as the protocol says. BenchError if it does not end well."""
        self.request("shutdown", None)
        self.notify("exit", None)
        assert self._process.stdin is not None and self._process.stdout is not None
        self._process.stdin.close()
        code = self._process.wait(timeout=_PATIENCE_S)
        self._process.stdout.close()
        self._over.set()
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
        self._over.set()
        self._process.kill()
        self._process.communicate()

    def _watch(self) -> None:
        while not self._over.wait(_PATIENCE_S):
            since_s = self._waits_since_s
            if since_s is not None and monotonic() - since_s > _PATIENCE_S:
                self._process.kill()

    def _send(self, message: dict[str, object]) -> None:
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        assert self._process.stdin is not None
        self._process.stdin.write(b"Content-Length: %d\r\n\r\n" % len(body) + body)
        self._process.stdin.flush()

    def _receive(self) -> dict[str, Any]:
        assert self._process.stdout is not None
        length = 0
        self._waits_since_s = monotonic()
        while line := self._process.stdout.readline().strip():
            name, _, value = line.partition(b":")
            if name.lower() == b"content-length":
                length = int(value)
        if not length:
            raise BenchError(f"the language server ended or was silent for {_PATIENCE_S:g} s")
        message = json.loads(self._process.stdout.read(length))
        self._waits_since_s = None
        assert isinstance(message, dict)
        return message
