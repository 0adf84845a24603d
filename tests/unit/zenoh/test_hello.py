# SPDX-License-Identifier: BSD-3-Clause
"""When a client says hello again: the bridge has lost it, or was not there yet."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Iterator
from typing import Any

import pytest
from unit.zenoh.rig import ANGLE, STAMP, Rig, rigged, until

from unitylink import connect
from unitylink.errors import DeviceMismatch, LinkBusy, LinkClosed, LinkDown, ProtocolError
from unitylink.zenoh import far_greeting
from unitylink.zenoh.bridge import visits
from unitylink.zenoh.far_questions import FarQuestions
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


def test_a_robot_with_another_spec_than_the_client_knows_is_refused(
    rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The addresses that the client has would be those of other items."""
    with pytest.raises(DeviceMismatch, match=f"has the spec {rig.bridge.hash}; in the URL it was {'0' * 16}"):
        connect(rig.url(f"&spec_hash={'0' * 16}"))
    connect(rig.url(f"&spec_hash={rig.bridge.hash}")).close()
    other, any_spec = connect(rig.url()), connect(rig.url("&spec_hash=any"))
    with other, any_spec:
        monkeypatch.setattr(rig.bridge._guests, "_hash", "0" * 16)  # the bridge is back with a new spec
        for visit in rig.bridge._guests.visits.all():
            rig.bridge._guests.leave(visit)
        until(lambda: other.closed)
        with pytest.raises(LinkClosed, match=f"has the spec {'0' * 16}; before it was {rig.bridge.hash}"):
            other.write(STAMP, 1)
        assert isinstance(other, ZenohLink)
        until(other._far.bridge.session.is_closed)  # its threads would let no program end
        until(lambda: any_spec.statistics().reconnections)
        assert any_spec.read(ANGLE) == 250


def test_a_program_that_closes_no_link_ends_all_the_same(rig: Rig) -> None:
    """For example because of an error. Its lease ends with it, so its outputs become safe."""
    program = f"from unitylink import connect; link = connect({rig.url()!r}); link.write({STAMP}, 7); link.no"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, timeout=60, check=False)
    assert done.returncode == 1 and done.stderr.strip().endswith(b"has no attribute 'no'")
    assert 7 in {value for _, value in rig.oracle.seen}
    until(lambda: rig.board.registers[STAMP] == 0)


@pytest.mark.parametrize("text", ["", "[]", "{", "[" * 100_000])
def test_a_state_that_is_none_is_refused(rig: Rig, monkeypatch: pytest.MonkeyPatch, text: str) -> None:
    with connect(rig.url()) as link:
        assert isinstance(link, ZenohLink)
        monkeypatch.setattr(link, "_text", lambda what: text)
        with pytest.raises(ProtocolError, match="a state that cannot be understood"):
            link.state()


def test_a_client_for_whom_there_is_no_place_is_told_so(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(visits, "VISITS_MAX", 0)
    with pytest.raises(LinkBusy, match="0 clients are there, which is all; close one, and try again"):
        connect(rig.url())
    assert rig.bridge.refusals.report()["full"]["count"] == 1


@pytest.mark.parametrize("nobody", [1, 9])
def test_a_writer_does_not_become_a_reader_by_an_early_hello(
    rig: Rig, monkeypatch: pytest.MonkeyPatch, nobody: int
) -> None:
    """The token of a bridge may be seen before its keys are."""
    said: list[str] = []
    once = FarQuestions.once

    def early(self: FarQuestions, key: str, data: bytes, timeout_s: float, **more: bool) -> object:
        said.append(key.rpartition("/")[2])
        return None if len(said) <= nobody else once(self, key, data, timeout_s, **more)

    monkeypatch.setattr(FarQuestions, "once", early)
    with connect(rig.url()) as link:
        link.write(STAMP, 1)
    assert "hello_read" not in said


def test_a_bridge_that_is_late_with_its_first_hello_is_greeted_again(
    rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Many clients may come at the same time."""
    monkeypatch.setattr(far_greeting, "LOOK_S", 0.2)
    enter, late = rig.bridge._guests.enter, [0.5]

    def slowly(*who: str) -> Any:
        time.sleep(late.pop() if late else 0.0)
        return enter(*who)

    monkeypatch.setattr(rig.bridge._guests, "enter", slowly)
    with connect(rig.url()) as link:
        link.write(STAMP, 2)
    assert not late


@pytest.mark.parametrize("what", ["spec", "stop"])
def test_what_may_come_twice_is_asked_until_somebody_is_there(
    rig: Rig, monkeypatch: pytest.MonkeyPatch, what: str
) -> None:
    """Just after the return of a router, the keys of a bridge come one after the other."""
    with connect(rig.url()) as link:
        assert isinstance(link, ZenohLink)
        once, asked = FarQuestions.once, list[str]()

        def nobody_yet(self: FarQuestions, key: str, data: bytes, timeout_s: float, **more: bool) -> object:
            if key.endswith(f"/{what}"):
                asked.append(key)
                if len(asked) < 6:
                    return None
            return once(self, key, data, timeout_s, **more)

        monkeypatch.setattr(FarQuestions, "once", nobody_yet)
        if what == "spec":
            assert "joint()" in link.spec_text()
        else:
            link.trip()
            link.arm()
        assert len(asked) == 6
