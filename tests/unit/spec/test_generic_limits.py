# SPDX-License-Identifier: BSD-3-Clause
"""A generic outside the limits of its VHDL is a mistake in the spec. No model and no elaboration meets it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from unitylink.errors import ValueRangeError
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.interface.components import check_clock, components_of
from unitylink.simulate import Board
from unitylink.spec import compile_file, compile_text
from unitylink.spec.meaning.vhdl_generics import limits_of

VHDL = """
-- entity stepper is generic (turns : positive range 7 to 8); end;
entity stepper is
  generic (
    Clock_Hz     : positive := 50_000_000;
    note         : string := "-- turns : natural range 0 to 1";
    turns, steps : positive range 2 to 1_000 := 4; -- positive range 5 to 6
    offset       : integer range -3 to 3 := 0;
    wide         : natural range 0 to turns := 0
  );
  port (clock : in std_logic; later : in natural range 0 to 1);
end entity;
"""


def mistakes(line: str) -> list[tuple[str, str, str | None]]:
    text = f"link a (ADDRESS=10);\npublic a() {{\n   it: {line};\n}}\n"
    return [(one.code, one.message, one.hint) for one in compile_text(text).diagnostics]


@pytest.mark.parametrize(
    ("line", "low", "high"),
    [
        ("pwm(frequency_hz={})", 1, None),
        ("h_bridge(frequency_hz={})", 1, None),
        ("spi_device(sclk_hz={})", 1, 2**31 - 1),
        ("pwm(channels={})", None, 64),
        ("h_bridge(form={})", 0, 2),
        ("rc_servo(minimum={} us, maximum=8191 us)", 1, None),
        ("rc_servo(maximum={} us)", None, 8191),
        ("spi_device(failures_most={})", 1, 15),
        ("quadrature_encoder(filter_ns={})", 0, 2000),
    ],
)
def test_a_number_beyond_the_limits_of_the_vhdl_is_named(
    line: str, low: int | None, high: int | None
) -> None:
    for limit, beyond in ((low, -1), (high, 1)):
        if limit is None:
            continue
        assert mistakes(line.format(limit)) == []
        (code, message, hint), *others = mistakes(line.format(limit + beyond))
        assert (code, others) == ("UL049", [])
        assert "generic" in message and f"{limit + beyond:,}" in message
        assert hint is not None and f"{limit:,}" in hint


def test_limits_are_those_of_the_own_vhdl(tmp_path: Path) -> None:
    vhdl = tmp_path / "stepper.vhd"
    vhdl.write_text(VHDL)
    least = {"clock_hz": (1, 2**31 - 1), "turns": (2, 1000), "steps": (2, 1000), "offset": (-3, 3)}
    assert limits_of("stepper", [str(vhdl)]) == least
    spec = tmp_path / "arm.ul"
    spec.write_text("""
    link arm (ADDRESS=8);
    @component("stepper") @generic(clock_hz=0, turns=turns, offset=-4) @source("stepper.vhd")
    stepper(turns: int): @base[1] { @x = base: READ(); }
    public arm() { one: stepper(turns=1001); }
    """)
    found = [one.message for one in compile_file(spec).diagnostics]
    assert found[0] == "generic `turns` of `stepper` is 1,001"
    spec.write_text(spec.read_text().replace("turns=1001", "turns=1000"))
    assert [one.message for one in compile_file(spec).diagnostics] == ["generic `offset` of `stepper` is -4"]
    vhdl.write_text(VHDL.replace("-3 to 3", "-4 to 3"))
    assert list(compile_file(spec).diagnostics) == []


@pytest.mark.parametrize(
    ("line", "value", "limit"),
    [
        (
            "rc_servo(minimum=2 ms, maximum=1900 us)",
            "`minimum` is 2 ms",
            "at most 1900 us, which is `maximum`",
        ),
        ("rc_servo(minimum=3 ms)", "`minimum` is 3 ms", "at most 2500 us, which is `maximum`"),
        ("stepgen(scale=-1/80 mm)", "`scale` is -0.0125 mm", "at least 0"),
        ("stepgen(reversed=2)", "`reversed` is 2", "at most 1"),
        ("sigma_delta_adc(full_scale=-32 A)", "`full_scale` is -32 A", "at least 0"),
        ("dshot(pole_pairs=-7)", "`pole_pairs` is -7", "at least 1"),
        ("icm42688(sclk_hz=25000000)", "`sclk_hz` is 25,000,000", "at most 24,000,000"),
        ("max31855(sclk_hz=10000000)", "`sclk_hz` is 10,000,000", "at most 5,000,000"),
        ("as5047p(sclk_hz=20000000)", "`sclk_hz` is 20,000,000", "at most 10,000,000"),
    ],
)
def test_a_parameter_beyond_another_one_is_named(line: str, value: str, limit: str) -> None:
    (code, message, hint), *_ = mistakes(line)
    assert (code, message) == ("UL049", value)
    assert hint is not None and limit in hint


def test_a_rate_that_no_clock_reaches_is_a_mistake() -> None:
    """pwm with one channel needs 15.5 clocks for each period, and no clock has more than 2**31 - 1 Hz."""
    most = (2**31 - 1) * 2 // 31
    assert mistakes(f"pwm(channels=1, frequency_hz={most})") == []
    for beyond in (most + 1, 2**31 - 1):
        (found, *others) = mistakes(f"pwm(channels=1, frequency_hz={beyond})")
        least = f"it needs a clock of at least {-(-beyond * 31 // 2):,} Hz"
        assert (found[:2], others) == (("UL049", least), [])
        assert found[2] is not None and "2,147,483,647 Hz; choose a lower rate" in found[2]


@pytest.mark.parametrize(
    "text",
    [
        "@limit()",
        "@limit(turns)",
        "@limit(least=1)",
        "@limit(turns, 2, least=1)",
        "@limit(turns, lest=1)",
        "@limit(turns, least=1, least=2)",
        "@limit(clock_hz, most=1)",
    ],
)
def test_a_limit_that_says_nothing_is_a_mistake(text: str) -> None:
    found = compile_text(f"""
    public arm() {{ one: stepper(turns=3); }}
    @component("stepper") {text}
    stepper(turns: int): @base[1] {{ @x = base: READ(); }}
    """).diagnostics
    assert [one.code for one in found] == ["UL098"]


def test_limits_are_whole_where_the_clock_is_known() -> None:
    spec = compile_text("public a() { one: pwm(channels=3, frequency_hz=40000); }").spec
    assert spec is not None
    (one,) = components_of(spec, 1_820_000)
    assert one.clock_least_hz == 1_820_000  # a period of 46 clocks, rounded, is more than 15 for each channel
    check_clock([one], 1_820_000)
    with pytest.raises(ValueRangeError, match=r"one \(pwm\) needs a clock of at least 1,820,000 Hz"):
        check_clock([one], 1_819_999)
    slow = BoardConfiguration.for_spec(spec, clock_hz=1_000_000)
    with pytest.raises(ValueRangeError, match="choose a faster clock"):
        Board(spec, configuration=slow)


@pytest.mark.parametrize("axes", [1, 2, 3, 8])
def test_the_slowest_clock_of_stepgen_is_that_of_its_vhdl(axes: int) -> None:
    spec = compile_text(f"public a() {{ one: stepgen(axes={axes}); }}").spec
    assert spec is not None
    (one,) = components_of(spec, 50_000_000)
    ramp = (Path(__file__).parents[3] / "components" / "stepgen" / "stepgen_ramp.vhd").read_text()
    (clocks,) = re.findall(r"constant pass_clocks : positive := (\d+);", ramp)
    work_clocks = (
        3 + max(axes, 3) + axes
    )  # stepgen_pkg: of a base period, of which there are at least 2**20 a second
    assert one.clock_least_hz == max(axes * int(clocks) << 14, work_clocks << 20)


def test_an_entity_without_vhdl_has_no_limits() -> None:
    assert limits_of("no_such_entity", []) == {}
    assert limits_of("x" * 5000, []) == {}
