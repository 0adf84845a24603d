# SPDX-License-Identifier: BSD-3-Clause
"""Components of the gateware library: their addresses are right, and they describe the VHDL truly."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from effort import many
from hypothesis import given, settings
from hypothesis import strategies as st

from unitylink.spec import Component, Spec, compile_text
from unitylink.spec.expand.allocate import Occupied
from unitylink.spec.text.imports import component_names

ROOT = Path(__file__).parents[3]


def clean(text: str) -> Spec:
    """Compile a text that must give no diagnostic."""
    result = compile_text(text)
    assert [(d.code, d.message) for d in result.diagnostics] == []
    assert result.spec is not None
    return result.spec


def test_components_get_addresses_where_there_is_room() -> None:
    spec = clean("""
    link board (ADDRESS=8);
    public board() {
       drive: pwm(channels=4);
       @led = 0x0: WRITE();
       encoder[2]: quadrature_encoder();
       fan: pwm(channels=1) @ 0x40;
       buttons: gpio(pins=12);
       @pressed = 0x1: u12 READ(PUBLISH(on buttons.changed));
    }
    """)
    places = {i.path: (i.component.base, i.component.words) for i in spec.root().instances if i.component}
    assert places == {
        "drive": (8, 6),
        "encoder[0]": (16, 6),
        "encoder[1]": (24, 6),
        "fan": (64, 3),
        "buttons": (32, 6),
    }
    drive = spec.root().instances[0].component
    assert drive == Component(
        "pwm", 8, 6,
        (("clock_hz", 0), ("channels", 4), ("frequency_hz", 20000), ("servo", 0),
         ("servo_minimum_us", 500), ("servo_maximum_us", 2500)),
        (("pins", "out", 4),), (), (), 1_210_000,
    )  # fmt: skip
    assert {path: element.address for path, element in spec.walk()}["drive.width[3]"] == 13
    assert spec.devices[0].groups[0].event == "buttons.changed"


def test_room_is_found_beside_tosnet_and_below_the_base() -> None:
    spec = clean("""
    public a(c,u) { MEMORY(CTRL=c, COMM=u); net: net(c, u); parts: parts(); }
    net(c,u) { TOSNET(CTRL=c, COMM=u, BASE=0); @x = 0x40: READ(); }
    parts() { MEMORY(BASE=0x10); e: quadrature_encoder(); }
    """)
    part = spec.root().instances[1].instances[0].component
    assert part is not None
    assert part.base == 0x800


@pytest.mark.parametrize(
    ("text", "codes"),
    [
        ("public a() { b: gpio(-4); }", ["UL049"]),
        ("public a() { b: pwm(channels=-2); }", ["UL049"]),
        ("public a() { b: pdm(rate_hz=1000000, pulse_ns=1001); }", ["UL049"]),
        ("public a() { b: pdm(bits=8, start=257); }", ["UL049"]),
        ("public a() { d[2]: d(); } d() { b: gpio(pins=99); }", ["UL049"]),
        ("link l(ADDRESS=2); public a() { b: gpio() @ 0x60; }", ["UL059"]),
        ("public a() { @x = 0x61: READ(); b: gpio() @ 0x60; }", ["UL057", "UL051"]),
    ],
)
def test_a_mistake_with_a_component_is_reported_where_it_is_used(text: str, codes: list[str]) -> None:
    diagnostics = compile_text(text, "robot.ul").diagnostics
    assert [d.code for d in diagnostics] == codes  # once, and not for each of its words
    places = [place for d in diagnostics for place in (d.span, *(label.span for label in d.labels))]
    assert {place.file for place in places} == {"robot.ul"}
    assert text[diagnostics[-1].span.start :].startswith(("gpio", "pwm", "pdm"))


def test_a_constructor_of_the_spec_comes_before_the_library() -> None:
    spec = clean("public a() { p: pwm() @ (0x1); } pwm(): @ (v) { @v: READ(); }")
    assert spec.root().instances[0].component is None


@given(
    st.lists(st.tuples(st.integers(0, 200), st.integers(1, 40)), max_size=20),
    st.integers(0, 5),
    st.integers(0, 60),
)
@settings(max_examples=many(200), deadline=None)
def test_room_is_free_aligned_and_the_first(taken: list[tuple[int, int]], power: int, lowest: int) -> None:
    occupied = Occupied()
    used: set[int] = set()
    for first, count in taken:
        occupied.take(first, count)
        used.update(range(first, first + count))
    size = 1 << power
    free = (at for at in range(0, 1000, size) if at >= lowest and not used & set(range(at, at + size)))
    assert occupied.room(size, lowest, 1 << 32) == next(free)


GENERIC = re.compile(r"^ +(\w+) +:", re.MULTILINE)


@pytest.mark.parametrize("name", component_names())
def test_library_agrees_with_the_vhdl(name: str) -> None:
    ends = {
        "pid": "shaft.position, motor.duty",
        "position_compare": "shaft.position",
        "foc": "shaft.position, shaft.position, shaft.position, bridge.duty[0], bridge.duty[1], "
        "bridge.duty[2], pole_pairs=7, angle_bits=14",
        "motion_profile": "shaft.position, loop.target, loop.target_velocity, loop.target_acceleration",
    }.get(name, "")
    others = "motor: h_bridge(); bridge: three_phase_pwm(); shaft: quadrature_encoder(); "
    if name == "motion_profile":
        others += "loop: pid(shaft.position, motor.duty);"
    spec = clean(f"public a() {{ {others} part: {name}({ends}); }}")
    component = spec.root().instances[-1].component
    assert component is not None
    source = (ROOT / "components" / name / f"{component.entity}.vhd").read_text("utf-8")
    entity = source[source.index(f"entity {component.entity} is") : source.index("end entity")]
    generics, ports = entity.split("port (")
    known = dict.fromkeys(GENERIC.findall(generics))
    assert {name for name, _ in component.generics} <= set(known)
    assert set(known) - {name for name, _ in component.generics} <= {"clock_hz", "data_width"}
    outside = set(GENERIC.findall(ports)) - {"clock", "reset", "wishbone_m2s", "wishbone_s2m"}
    wires = {name for name, _, _ in component.wires}
    assert {name for name, _, _ in component.pins} | set(component.events) | wires == outside
    for wire, direction, _ in component.wires:
        assert re.search(rf"\b{wire} +: +{direction} +wire_t\b", ports), wire
    for pin, direction, bits in component.pins:
        assert re.search(rf"\b{pin} +: +{direction} +std_ulogic{'_vector' if bits else ''}\b", ports), pin
    for generic, value in component.generics:
        if generic == "clock_hz":
            assert value == 0  # 0 stands for the design's own clock
            continue
        default = re.search(rf'\b{generic} +:.*:= *("\w+"|[0-9_]+)', generics)
        written = f'"{value}"' if isinstance(value, str) else str(value)
        assert default is not None and default.group(1).replace("_", "") == written


def test_a_second_compilation_looks_for_no_file(monkeypatch: pytest.MonkeyPatch) -> None:
    """The search took most of the time of a short spec."""

    def search(*_: object) -> None:
        raise AssertionError("the library was searched again")

    clean("public a() { @x = 0x1: READ(); }")
    for name in ("stat", "iterdir", "glob"):
        monkeypatch.setattr(Path, name, search)
    clean("public a() { @x = 0x1: READ(); }")
