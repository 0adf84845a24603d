# SPDX-License-Identifier: BSD-3-Clause
"""When a client says hello again: the bridge has lost it, or was not there yet."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from unit.zenoh.rig import ANGLE, STAMP, Rig, rigged, until

from unitylink import connect
from unitylink.errors import LinkDown, ProtocolError
from unitylink.zenoh.far_bridge import FarBridge
from unitylink.zenoh.link import ZenohLink


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Rig]:
    with rigged(tmp_path_factory.mktemp("zenoh")) as rig:
        yield rig


def test_a_client_that_the_bridge_has_lost_says_hello_again(rig: Rig) -> None:
    """If both were cut off from their router, the board looks the same to the client all the time."""
    with connect(rig.url()) as link:
        (visit,) = rig.bridge._guests.visits.all()
        rig.bridge._guests.leave(visit)
        with pytest.raises(LinkDown, match="say hello again"):
            link.read(ANGLE)
        until(lambda: rig.bridge.state()["clients"])
        assert link.wait_up(3) and link.read(ANGLE) == 250
        (visit,) = rig.bridge._guests.visits.all()
        rig.bridge._guests.leave(visit)
        until(lambda: rig.bridge.state()["clients"])  # also without a request
        until(lambda: link.statistics().reconnections == 2)


@pytest.mark.parametrize("text", ["", "[]", "{", "[" * 100_000])
def test_a_state_that_is_none_is_refused(rig: Rig, monkeypatch: pytest.MonkeyPatch, text: str) -> None:
    with connect(rig.url()) as link:
        assert isinstance(link, ZenohLink)
        monkeypatch.setattr(link, "_text", lambda what: text)
        with pytest.raises(ProtocolError, match="a state that cannot be understood"):
            link.state()


def test_a_writer_does_not_become_a_reader_by_an_early_hello(
    rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The token of a bridge may be seen before its keys are."""
    said: list[str] = []
    once = FarBridge.once

    def early(self: FarBridge, key: str, data: bytes, timeout_s: float, **more: bool) -> object:
        said.append(key.rpartition("/")[2])
        return None if len(said) == 1 else once(self, key, data, timeout_s, **more)

    monkeypatch.setattr(FarBridge, "once", early)
    with connect(rig.url()) as link:
        link.write(STAMP, 1)
    assert said[:2] == ["hello", "hello"]
