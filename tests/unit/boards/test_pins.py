# SPDX-License-Identifier: BSD-3-Clause
"""Ports to pins: by request, by name, and every request that is impossible."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from unitylink.boards import load_board
from unitylink.boards.pins import Line, Pinout, assign_pins, lines_of
from unitylink.boards.wrapper import constraints, wrapper
from unitylink.errors import BoardError
from unitylink.gateware import Port

BOARD = load_board("icebreaker")
LINES = (Line("servos", "out", 2), Line("lamp", "out", 1), Line("limit_switch", "in", 1), Line("x", "in", 2))


def pins(pinout: Pinout) -> dict[str, str]:
    return {line.bit(number): pin.name for line, number, pin in pinout}


def test_names_tell_pins_and_wishes_go_first() -> None:
    given = assign_pins(BOARD, LINES, ["x=BTN1,BTN2", "servos[1]=P1A1"])
    assert pins(given) == {
        "servos[0]": "P1A2",
        "servos[1]": "P1A1",
        "lamp": "LEDG_N",
        "limit_switch": "P1B7",
        "x[0]": "BTN1",
        "x[1]": "BTN2",
    }
    assert given.notices == []


def test_the_board_s_pin_for_trips() -> None:
    drivers = replace(BOARD, roles={**BOARD.roles, "tripped": ("P1B1",)})
    line = (Line("tripped", "out", 1),)
    assert pins(assign_pins(drivers, line, [])) == {"tripped": "P1B1"}
    assert pins(assign_pins(BOARD, line, ["tripped=P1A1"])) == {"tripped": "P1A1"}
    assert assign_pins(drivers, (), []).notices == [
        "P1B1: nothing drives it, because the design has no port tripped"
    ]


def test_an_input_gets_no_pin_for_outputs() -> None:
    lines = (Line("motor_fault", "in", 1), Line("motor_high", "out", 1))
    given = assign_pins(BOARD, lines, [], {"motor_fault": "h_bridge", "motor_high": "h_bridge"})
    assert pins(given)["motor_fault"] in BOARD.roles["io"]
    assert pins(given)["motor_high"] in BOARD.roles["pwm"]


def test_what_has_no_pin_is_said() -> None:
    wide = (Line("leds", "out", 8), Line("buttons", "in", 6), Line("x", "in", 1))
    assert assign_pins(BOARD, wide, ["x=-", "leds[2]=-"]).notices == [
        "leds[2]: no pin, is not connected",
        "buttons[4 to 5]: no pin, reads 0",
        "x: has no pin, reads 0",
    ]


@pytest.mark.parametrize(
    ("wishes", "message"),
    [
        ([], "the port x has no pin: its name gives none; say --pin x=PIN"),
        (["x=P1A99"], r"icebreaker has no pin P1A99; did you mean P1A9\?; site:B10"),
        (["lmap=P1A1"], r"the design has no port lmap; did you mean lamp\?"),
        (["x=P1A1,P1A1"], r"pin P1A1 \(site 4\) is taken by --pin x=P1A1,P1A1"),
        (["x=P2_1,LED2"], r"pin LED2 \(site 27\) is taken by --pin x=P2_1,LED2"),
        (["x=CLK,-"], r"pin CLK \(site 35\) is taken by CLK"),
        (["x=P1A1,P1A2,P1A3"], "x has 2 bits"),
        (["x[2]=P1A1"], "x has 2 bits"),
        (["x"], "write PORT=PIN"),
        (["x="], "write PORT=PIN"),
    ],
)
def test_wishes_that_cannot_be(wishes: list[str], message: str) -> None:
    with pytest.raises(BoardError, match=message):
        assign_pins(BOARD, LINES, wishes)


def test_outputs_are_given_all_or_by_their_numbers() -> None:
    """A forgotten gate of a bridge would be a short circuit, or a phase that nobody drives."""
    lines = [Line("gates", "out", 4), Line("keys", "in", 4)]
    keys = "keys=BTN1,BTN2"
    for count, wish in ((1, "gates=P1A1"), (3, "gates=P1A1,P1A2,P1A3"), (2, "gates=-,P1A2")):
        with pytest.raises(BoardError, match=f"gates has 4 outputs, and {count} are named; name all, with -"):
            assign_pins(BOARD, lines, [wish, keys])
    whole = assign_pins(BOARD, lines, ["gates=P1A1,P1A2,P1A3,-", keys])
    assert whole.notices == ["gates[3]: no pin, is not connected", "keys[2 to 3]: no pin, reads 0"]
    assert pins(assign_pins(BOARD, lines, ["gates=-", keys])) == {"keys[0]": "BTN1", "keys[1]": "BTN2"}


def test_a_component_gets_pins_for_all_its_outputs() -> None:
    few = replace(BOARD, roles={**BOARD.roles, "pwm": ("P1A1", "P1A2", "P1A3"), "leds": ("LED1",)})
    gates = Line("motor", "out", 4)
    with pytest.raises(
        BoardError, match="motor has no pin: icebreaker has too few free pins for pwm; say --pin"
    ):
        assign_pins(few, [gates], [], {"motor": "h_bridge"})
    given = assign_pins(few, [gates], ["motor[3]=P1B1"], {"motor": "h_bridge"})
    assert [pin.name for pin in given.pins["motor"] if pin] == ["P1A1", "P1A2", "P1A3", "P1B1"]
    assert assign_pins(few, [Line("leds", "out", 2)], []).notices == ["leds[1]: no pin, is not connected"]


def test_more_ports_than_pins() -> None:
    many = [Line(f"leds_{n}", "out", 7) for n in range(2)]
    with pytest.raises(BoardError, match="leds_1 has no pin: icebreaker has no free pin for leds"):
        assign_pins(BOARD, many, [])


def test_a_site_without_a_name() -> None:
    board = load_board("ice40-hx8k")
    given = assign_pins(board, [Line("x", "in", 2)], ["x=site:P16,site:B5"])
    assert pins(given) == {"x[0]": "SITE_P16", "x[1]": "LED0"}
    assert "set_io -pullup yes SITE_P16 P16" in constraints(board, given)


NAMES = {"leds": "led", "buttons": "key", "pwm": "motor", "encoder": "encoder", "io": "io"}


@given(
    st.lists(st.tuples(st.sampled_from(sorted(BOARD.pins)), st.sampled_from(sorted(NAMES))), max_size=8),
    st.data(),
)
def test_no_pin_is_given_twice(wanted: list[tuple[str, str]], data: st.DataObject) -> None:
    lines = [
        Line(f"{NAMES[role]}_{n}", "in", data.draw(st.integers(1, 4))) for n, (_, role) in enumerate(wanted)
    ]
    wishes = [f"{line.name}={pin}" for line, (pin, _) in zip(lines, wanted, strict=True)][:3]
    try:
        given = assign_pins(BOARD, lines, wishes)
    except BoardError:
        return
    sites = [pin.site for _, _, pin in given]
    fixed = [BOARD.pins[name].site for name in (BOARD.clock_pin, BOARD.rx, BOARD.tx)]
    assert len({*sites, *fixed}) == len(sites) + len(fixed)


PORTS = (
    Port("clock", True, 1),
    Port("usb_rx", True, 1),
    Port("usb_tx", False, 1),
    Port("lamp", False, 1),
    Port("key", True, 2),
    Port("io_in", True, 1),
    Port("io_out", False, 1),
    Port("io_drive", False, 1),
)


def test_wrapper_inverts_active_low_pins_and_makes_two_way_pins() -> None:
    lines = lines_of(PORTS)
    assert lines == (Line("lamp", "out", 1), Line("key", "in", 2), Line("io", "both", 1))
    given = assign_pins(BOARD, lines, ["key=BTN_N,BTN1", "lamp=LEDR_N"])
    text = wrapper(BOARD, "Top", PORTS, given, None)
    assert "assign LEDR_N = ~lamp_out_[0];" in text
    assert ".key({BTN1, ~BTN_N})" in text
    assert "inout P1B7" in text and ".D_IN_0(P1B7_in_)" in text and ".io_in({P1B7_in_})" in text
    assert "  top design_(" in text
    assert "set_io -pullup yes BTN_N 10" in constraints(BOARD, given)
    assert "set_io BTN1 20" in constraints(BOARD, given)


def test_a_design_without_a_link() -> None:
    with pytest.raises(BoardError, match="top needs one port for the receive line of the link, called rx"):
        wrapper(BOARD, "top", (PORTS[0], PORTS[2]), assign_pins(BOARD, [], []), None)
