# SPDX-License-Identifier: BSD-3-Clause
"""One table has all kinds of link URL. Everything that opens a link uses it."""

from __future__ import annotations

from pathlib import Path

import pytest

from unitylink import connect
from unitylink.connection import open_driver
from unitylink.connection.schemes import SCHEMES, Device, Scheme, scheme_of
from unitylink.errors import LinkClosed, UrlError
from unitylink.layer0_driver import Driver
from unitylink.simulate import Board

LED = Path(__file__).parents[3] / "examples" / "hello_led" / "hello_led.ul"


@pytest.mark.parametrize("url", ["", "x", "seriall:/dev/ttyUSB0", "SIM:x.ul", "://", "c:\\robot.ul"])
def test_an_unknown_scheme_is_reported_with_all_known_ones(url: str) -> None:
    for opened in (scheme_of, connect, lambda one: open_driver(one).__enter__()):
        with pytest.raises(UrlError, match="scheme") as raised:
            opened(url)
        assert all(scheme.form in str(raised.value) for scheme in SCHEMES.values())


def test_the_native_core_knows_the_schemes_that_the_table_leaves_to_it() -> None:
    with pytest.raises(UrlError) as raised:
        Driver("none:")
    for name, scheme in SCHEMES.items():
        assert (f"{name}:" in str(raised.value)) == (scheme.make is None and scheme.open is None)
    with pytest.raises(UrlError, match="has no bytes, only registers"):
        Driver("mmap:/dev/uio0")


def test_bytes_alone_reach_a_virtual_board() -> None:
    with open_driver(f"sim:{LED}") as driver:
        driver.send(b"#RLC\n")
        assert driver.receive().startswith(b"#CNF:")


def test_a_row_is_all_a_new_scheme_needs(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[Board] = []

    def make(url: str) -> tuple[Device, str]:
        made.append(Board())
        return made[-1], f"{made[-1].url}?{url.partition('?')[2]}"

    monkeypatch.setitem(SCHEMES, "spare", Scheme("spare", "spare:NAME", "a board out of the box", make))
    with connect("spare:one?window=3") as link:
        assert (link.url, link.board) == ("spare:one?window=3", None)
        assert link.read(0x10) == 0
    with pytest.raises(UrlError, match="spare:one"):
        connect("spare:one?windw=3")
    with open_driver("spare:one?window=3") as driver:
        driver.send(b"#R:0010\n")
    assert len(made) == 3
    for board in made:  # all of them were closed, also the one of the wrong URL
        with pytest.raises(LinkClosed):
            _ = board.url
