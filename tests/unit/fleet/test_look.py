# SPDX-License-Identifier: BSD-3-Clause
"""Who looks at a fleet asks its program until the time is over."""

from __future__ import annotations

import time
from types import SimpleNamespace
from typing import Any

import pytest

from unitylink.fleet import look


class Session:
    """A network that answers a question after `unheard` others. An unheard one waits, or is over at once."""

    def __init__(self, unheard: int, *, waits: bool) -> None:
        self.asked, self._unheard, self._waits = 0, unheard, waits

    def get(self, key: str, timeout: float) -> list[Any]:
        self.asked += 1
        if self.asked <= self._unheard:
            time.sleep(timeout if self._waits else 0.0)
            return []
        return [SimpleNamespace(ok=SimpleNamespace(payload=Payload(b'{"robots": {}}')))]


class Payload(bytes):
    def to_bytes(self) -> bytes:
        return bytes(self)


@pytest.mark.parametrize("waits", [True, False])
def test_it_asks_again(monkeypatch: pytest.MonkeyPatch, waits: bool) -> None:
    monkeypatch.setattr(look, "_EACH_S", 0.02)
    monkeypatch.setattr(look, "_STEP_S", 0.0)
    session = Session(3, waits=waits)
    limit_s = time.monotonic() if waits else time.monotonic() + 30
    assert look._told(session, "cell", limit_s) == {"robots": {}}  # type: ignore[arg-type]
    assert session.asked == 4


def test_it_ends_where_nobody_runs_the_fleet(monkeypatch: pytest.MonkeyPatch) -> None:
    session = Session(10**9, waits=False)
    assert look._told(session, "cell", time.monotonic() - 1) == {}  # type: ignore[arg-type]
    assert session.asked == 1
    monkeypatch.setattr(look, "_EACH_S", 0.01)
    monkeypatch.setattr(look, "ANSWER_S", 0.05)
    silent = Session(10**9, waits=True)
    assert look._told(silent, "cell", time.monotonic() - 1) == {}  # type: ignore[arg-type]
    assert silent.asked > 1
