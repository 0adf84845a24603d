# SPDX-License-Identifier: BSD-3-Clause
"""The engine that a design gets, and what a small engine refuses."""

from __future__ import annotations

from typing import Any

import pytest

from unitylink import protocol as p
from unitylink.errors import ValueRangeError
from unitylink.interface.engine import SMALL, too_fast
from unitylink.layer2_message import Link
from unitylink.simulate import Board, BoardConfiguration
from unitylink.simulate.rtl import rtl_configuration
from unitylink.spec import Spec, compile_text

LAMP = "@lamp = 0x0: u8 WRITE(SAFE=1); @buttons = 0x1: READ(); @uptime = 0x2: READ();"
LEAST = p.SMALL_ENGINE_BYTE_CLOCKS_MIN
PUBLISH_LEAST = p.SMALL_ENGINE_PUBLISH_BYTE_CLOCKS_MIN


def slow_line(byte_clocks: int) -> dict[str, int]:
    """Return the settings of a line of 10 MBd with so many clocks a byte."""
    return {"clock_hz": 1_000_000 * byte_clocks, "baud_hz": 10_000_000}


def spec_of(members: str = LAMP, link: str = "") -> Spec:
    declared = f"link a ({link}); " if link else ""
    result = compile_text(f"{declared}public a() {{ {members} }}", "a.ul")
    assert result.spec is not None, result
    return result.spec


@pytest.mark.parametrize(
    ("members", "overrides", "engine"),
    [
        (LAMP, {"protocol": "framed"}, "small"),
        (LAMP, {}, "fast"),  # it also speaks text
        (LAMP, {"protocol": "classic"}, "fast"),
        (LAMP, {"physical": "rs485"}, "small"),  # frames alone
        (LAMP, {"protocol": "framed", "physical": "spi"}, "fast"),  # the master may be fast
        (LAMP, {"protocol": "framed", "physical": "ft245_async"}, "fast"),
        (LAMP, {"protocol": "framed", "clock_hz": 1_000_000 * LEAST, "baud_hz": 10_000_000}, "small"),
        (LAMP, {"protocol": "framed", "clock_hz": 1_000_000 * LEAST - 1, "baud_hz": 10_000_000}, "fast"),
        (LAMP, {"protocol": "framed", "lists": True}, "fast"),
        (LAMP, {"protocol": "framed", "exchanges": 1}, "fast"),
        (LAMP, {"protocol": "framed", "publish_mode": 2}, "small"),
        (LAMP, {"protocol": "framed", "publish_mode": 2, "groups": 7}, "fast"),
        (LAMP, {"protocol": "framed", "rate_bytes": 3}, "fast"),
        (LAMP, {"protocol": "framed", "window": 16}, "fast"),
        (LAMP, {"protocol": "framed", "window": 4}, "small"),
        (LAMP, {"protocol": "framed", "engine": "fast"}, "fast"),
        ("@x = 0x1: READ(PUBLISH(10 Hz));", {"protocol": "framed"}, "small"),
        ("@x = 0x1: READ(PUBLISH(on change));", {"protocol": "framed"}, "small"),
        ("@x = 0x1: READ(PUBLISH(1, 70000));", {"protocol": "framed"}, "fast"),  # its divisor has two bytes
        ("@x = 0x1: READ(PUBLISH(1000 Hz));", {"protocol": "framed", "baud_hz": 200_000}, "fast"),
        ("@x = 0x1: READ(PUBLISH(1000 Hz));", {"protocol": "framed", "baud_hz": 1_000_000}, "small"),
        ("@x = 0x1: READ(PUBLISH(1 Hz));", {"protocol": "framed", "base_hz": 20_000}, "fast"),
        ("@x = 0x1: READ(PUBLISH(1 Hz));", {"protocol": "framed", **slow_line(PUBLISH_LEAST)}, "small"),
        ("@x = 0x1: READ(PUBLISH(1 Hz));", {"protocol": "framed", **slow_line(PUBLISH_LEAST - 1)}, "fast"),
        ("@x = 0x1: READ(PUBLISH(10 Hz));", {"protocol": "framed", "publish_mode": 0}, "small"),
        ("@x = 0x1: READ(PUBLISH(2, 10));", {"protocol": "framed"}, "small"),
        ("@x = 0x1: READ(PUBLISH(2, 10)); @y = 0x2: READ(PUBLISH(2, 10));", {"protocol": "framed"}, "fast"),
        ("@x = 0x1: u64 READ();", {"protocol": "framed"}, "fast"),
        ("@x = 0x1: u64 WRITE();", {"protocol": "framed"}, "small"),
        ("@x = 0x1: READ(); @y = 0x2: READ(); pose = x, y;", {"protocol": "framed"}, "fast"),
        ("FIFO(DEPTH=4); @x = 0x0: READCLEAR();", {"protocol": "framed"}, "fast"),
        ("DOUBLE_BUFFER(SIZE=4); @x = 0x0: READ();", {"protocol": "framed"}, "fast"),
    ],
)
def test_a_design_gets_the_small_engine_where_it_will_do(
    members: str, overrides: dict[str, Any], engine: str
) -> None:
    assert BoardConfiguration.for_spec(spec_of(members), **overrides).engine == engine


def test_the_spec_chooses() -> None:
    assert BoardConfiguration.for_spec(spec_of(link="ENGINE=fast"), protocol="framed").engine == "fast"
    quick = spec_of(link="BAUD=12 MHz")  # 41 clocks for a byte at 50 MHz
    assert BoardConfiguration.for_spec(quick, protocol="framed").engine == "fast"
    assert BoardConfiguration.for_spec(quick, protocol="framed", clock_hz=100_000_000).engine == "small"
    small = BoardConfiguration.for_spec(spec_of(link="ENGINE=small"))
    assert {name: getattr(small, name) for name in SMALL} == dict(SMALL)
    assert BoardConfiguration.for_spec(spec_of(link="ENGINE=small"), engine="fast").protocol == "both"
    assert BoardConfiguration.for_spec(spec_of(link="ENGINE=small, PHYSICAL=spi")).engine == "small"


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        ({"protocol": "both"}, "protocol is 'both'; the small engine has 'framed'"),
        ({"lists": True}, "lists is True; the small engine has False"),
        ({"exchanges": 1}, "exchanges is 1; the small engine has 0"),
        ({"publish_mode": 2, "groups": 7}, "groups is 7; the small engine has at most 6"),
        ({"publish_mode": 2, "group_size": 18}, "group_size is 18; the small engine has at most 17"),
        ({"publish_mode": 1, "rate_bytes": 3}, "rate_bytes is 3; the small engine has at most 2"),
        ({"window": 16}, "window is 16; the small engine has at most 8"),
        ({"request_max": 250}, "request_max is 250; the small engine has 32"),
        ({"credit": 512}, "credit is 512; the small engine has 96"),
    ],
)
def test_a_setting_that_the_small_engine_does_not_have_is_refused(
    overrides: dict[str, Any], message: str
) -> None:
    with pytest.raises(ValueRangeError, match=f"{message}.*engine 'fast'"):
        BoardConfiguration.for_spec(spec_of(), engine="small", **overrides)


@pytest.mark.parametrize(
    ("members", "message"),
    [
        (
            "@x = 0x1: READ(PUBLISH(1, 70000));",
            "counts to 65535, and the divisor of `x` is 70000: choose a lower BASE",
        ),
        ("@x = 0x1: f64 READ();", "one word at a time, and `x` has 2: give it a type of one word"),
    ],
)
def test_a_spec_that_needs_more_is_refused(members: str, message: str) -> None:
    with pytest.raises(ValueRangeError, match=f"{message}.*, or choose engine 'fast'"):
        BoardConfiguration.for_spec(spec_of(members), engine="small")


def test_rates_that_the_small_engine_cannot_keep_are_refused() -> None:
    spec = spec_of("@x = 0x1: READ(PUBLISH(1000 Hz));", "ENGINE=small")
    with pytest.raises(ValueRangeError, match=r"publishes take \d+% of the time .* at most 80%"):
        BoardConfiguration.for_spec(spec, baud_hz=200_000)
    with pytest.raises(
        ValueRangeError, match="strobe comes every 2500 clocks, and the small engine needs 3000"
    ):
        BoardConfiguration.for_spec(spec, base_hz=20_000)
    chosen = BoardConfiguration.for_spec(spec, baud_hz=1_000_000)
    assert (chosen.publish_mode, chosen.groups, chosen.group_size) == (2, 4, 17)


def test_a_large_group_becomes_several() -> None:
    members = "".join(f"@x{n} = {n:#x}: READ(PUBLISH(10 Hz)); " for n in range(40))
    chosen = BoardConfiguration.for_spec(spec_of(members), protocol="framed")
    assert (chosen.engine, chosen.publish_words, chosen.groups) == ("small", 17, 5)


def test_a_line_is_too_fast_where_posts_could_come_faster_than_they_are_executed() -> None:
    spec = spec_of(link="ENGINE=small")
    assert "takes 42 clocks on the line" in too_fast(
        BoardConfiguration.for_spec(spec, clock_hz=12_600_000, baud_hz=3_000_000)
    )
    assert too_fast(BoardConfiguration.for_spec(spec, clock_hz=12_900_000, baud_hz=3_000_000)) == ""
    assert too_fast(BoardConfiguration(clock_hz=12_600_000, baud_hz=3_000_000)) == ""
    assert too_fast(BoardConfiguration.for_spec(spec)) == "", "the rate is not known"


@pytest.mark.parametrize("link", ["BAUD=3 MHz", "PHYSICAL=rs485, NODE=1, BAUD=3 MHz", "ENGINE=small"])
def test_simulated_gateware_has_the_engine_of_the_real_one(link: str) -> None:
    """Its clock is slower, but the choice does not use the clock."""
    real = BoardConfiguration.for_spec(spec_of(link=link), protocol="framed")
    slow = rtl_configuration(spec_of(link=link), protocol="framed", clock_hz=2_000_000)
    assert slow.clock_hz < real.clock_hz
    assert [getattr(slow, name) for name in ("engine", *SMALL)] == [
        getattr(real, name) for name in ("engine", *SMALL)
    ]


def test_simulated_gateware_has_the_slowest_clock_with_which_the_spec_works() -> None:
    assert rtl_configuration(spec_of(link="BASE_RATE=1 kHz")).clock_hz == 1_000_000
    small = rtl_configuration(spec_of("@x = 0x4: READ(PUBLISH(100 Hz));", link="ENGINE=small"))
    assert small.clock_hz == 3_000_000, "it needs 3,000 clocks between two strobes"
    assert rtl_configuration(spec_of("servos: servo_bus(servos=2);")).clock_hz == 8_000_000
    with pytest.raises(ValueRangeError, match="8,000,000 Hz"):
        rtl_configuration(spec_of("servos: servo_bus(servos=2);"), clock_hz=7_000_000)


def test_a_virtual_board_tells_the_sizes_of_the_small_engine() -> None:
    with Board(spec_of(link="ENGINE=small")) as board, Link(f"{board.url}?protocol=framed") as link:
        told = link.description
        assert told is not None
        sizes = (told.request_max, told.reply_max, told.window, told.cache, told.credit)
        assert sizes == (32, 76, 8, 8, 96)
        assert (told.features, told.exchanges, link.configuration.groups) == (
            p.CONTROL_VALUE_FEATURE_DEADMAN,
            0,
            0,
        )
