# SPDX-License-Identifier: BSD-3-Clause
"""The bound of a publish as a function. tests/gateware/test_isochrony.py compares the VHDL with it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from unitylink.errors import ValueRangeError
from unitylink.simulate import BoardConfiguration
from unitylink.spec.isochrony import isochrony

configurations = st.builds(
    BoardConfiguration,
    address_bits=st.integers(1, 32),
    data_bits=st.integers(8, 32),
    groups=st.integers(1, 256),
    group_size=st.integers(1, 255),
    read_many=st.integers(0, 255),
    rate_bytes=st.integers(1, 4),
    publish_mode=st.integers(1, 2),
    protocol=st.sampled_from(["classic", "framed", "both"]),
    baud_hz=st.sampled_from([0, 115_200, 3_000_000, 12_000_000]),
)


@given(configurations)
def test_more_to_do_is_never_sooner(configuration: BoardConfiguration) -> None:
    result = isochrony(configuration)
    assert 0 < result.idle_clocks < result.bound_clocks
    for worse in (
        isochrony(configuration, bus_waits=3),
        isochrony(configuration, before=[1]),
        isochrony(configuration, before=[255, 1]),
        isochrony(replace(configuration, publish_mode=1)),
        isochrony(replace(configuration, read_many=255)),
        isochrony(replace(configuration, baud_hz=9600)),
    ):
        assert worse.idle_clocks == result.idle_clocks
        assert worse.late_clocks >= result.late_clocks
    assert isochrony(configuration, read_many=0).late_clocks <= result.late_clocks
    assert isochrony(configuration, checked=False).late_clocks <= result.late_clocks


def test_figures_in_seconds() -> None:
    board = BoardConfiguration(groups=2, group_size=16, read_many=32, clock_hz=1_000_000)
    assert isochrony(board).longest.name == "LIST", "a link chooses frames where they are there"
    result = isochrony(board, protocol="classic")
    assert result.idle_s == pytest.approx(result.idle_clocks * 1e-6)
    assert result.late_s == pytest.approx(result.late_clocks * 1e-6)
    assert result.longest.name == "RM"


def test_requests_have_their_turn_between_many_publishes() -> None:
    configuration = BoardConfiguration(read_many=32, group_size=16, protocol="classic")
    three, four = (isochrony(configuration, before=[16] * count).late_clocks for count in (3, 4))
    two = isochrony(configuration, before=[16] * 2).late_clocks
    longest = isochrony(configuration).longest.characters
    assert three - two > longest
    assert four - three < longest


@pytest.mark.parametrize(
    ("changes", "options", "message"),
    [
        ({"publish_mode": 0}, {}, "publish_mode is 0"),
        ({"datalink": "lite"}, {}, "datalink is 'lite'"),
        ({"datalink": "none"}, {}, "datalink is 'none'"),
        ({"read_many": 32}, {"read_many": 33, "protocol": "classic"}, "read_many is 33; choose 0 to 32"),
        ({}, {"read_many": -1, "protocol": "classic"}, "read_many is -1"),
        ({}, {"read_many": -1}, "read_many is -1"),
        ({"protocol": "framed"}, {"protocol": "classic"}, "is 'classic'; the gateware speaks framed"),
        ({}, {"protocol": "both"}, "protocol is 'both'"),
    ],
)
def test_what_has_no_bound(changes: dict[str, Any], options: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueRangeError, match=message):
        isochrony(BoardConfiguration(**changes), **options)
