# SPDX-License-Identifier: BSD-3-Clause
"""Wires from component to component: what they lead to, the units that they give, and what is refused."""

from __future__ import annotations

import math

import pytest

from unitylink.generate.spec_plan import SpecPlan
from unitylink.generate.vhdl import vhdl_files
from unitylink.interface.components import components_of
from unitylink.spec import Spec, compile_text

PARTS = "m: h_bridge(); s: quadrature_encoder(scale=2*pi/4096 rad, with_velocity=1);"


def clean(text: str) -> Spec:
    result = compile_text(text, "robot.ul")
    assert [(d.code, d.message) for d in result.diagnostics] == []
    assert result.spec is not None
    return result.spec


def test_a_loop_has_the_units_of_its_ends() -> None:
    spec = clean(f"public a() {{ {PARTS} l: pid(feedback=s.position, output=m.duty, loop_hz=10000); }}")
    found = dict(spec.walk())
    count, duty = 2 * math.pi / 4096, 1 / 4095
    for path, unit, scale in (
        ("l.target", "rad", count),
        ("l.kp", "1/rad", duty / count / 65536),
        ("l.ki", "1/rad/s", duty / count * 1e4 / 2**24),
        ("l.kd", "s/rad", duty / count / 1e4 / 256),
        ("l.ka", "s^2/rad", duty / count / 1e8 * 256),
        ("l.target_acceleration", "rad/s^2", count * 1e8 / 2**24),
        ("l.limit", "", duty),
    ):
        assert found[path].unit == unit
        assert found[path].scale == pytest.approx(scale)


def test_wires_lead_from_outputs_to_inputs() -> None:
    spec = clean(
        f"public a() {{ {PARTS} inner: pid(feedback=s.velocity, output=m.duty);"
        " outer: pid(feedback=s.position, output=inner.target); }"
    )
    motor, shaft, inner, outer = components_of(spec, 50_000_000)
    assert motor.connections == ((0, 2, 0),)  # its duty is the output of the inner loop
    assert shaft.connections == ()
    assert inner.connections == ((0, 1, 1), (1, 3, 0))  # the velocity, and the output of the outer loop
    assert outer.connections == ((0, 1, 0),)
    assert dict(inner.generics)["output_wire_bits"] == 13 and dict(outer.generics)["output_wire_bits"] == 32
    design = vhdl_files(SpecPlan(spec))["vhdl/robot_design.vhd"]
    assert "signal wires : wire_vector_t(0 to 3)" in design
    for port, number in (("position_wire", 2), ("velocity_wire", 0), ("duty_wire", 1), ("target_wire", 3)):
        assert design.count(f"{port} => wires({number})") == 1


def test_a_wire_may_be_handed_down() -> None:
    spec = clean(
        "public a() { leg[2]: leg(); } leg() { m: h_bridge(); s[2]: quadrature_encoder(); "
        "j: joint(s[1].position, m.duty); } joint(f: wire, o: wire) { l: pid(feedback=f, output=o); }"
    )
    paths = [one.path for one in components_of(spec, 50_000_000)]
    for leg in (0, 1):
        loop = components_of(spec, 50_000_000)[paths.index(f"leg[{leg}].j.l")]
        assert loop.connections == ((0, paths.index(f"leg[{leg}].s[1]"), 0),)


@pytest.mark.parametrize(
    ("loop", "code", "says"),
    [
        ("pid(feedback=m.duty, output=m.duty)", "UL106", "`m.duty` takes a value itself"),
        ("pid(feedback=s.position, output=s.velocity)", "UL106", "`s.velocity` gives a value itself"),
        ("pid(feedback=s.impossible, output=m.duty)", "UL106", "no wire leads to `s.impossible`"),
        ("pid(feedback=s, output=m.duty)", "UL025", "`a` has no parameter `s`"),
        ("pid(feedback=later.position, output=m.duty)", "UL106", "no wire leads to `later.position`"),
        ("pid(feedback=s[1].position, output=m.duty)", "UL106", "no wire leads to `s[…].position`"),
        ("pid(feedback=3, output=m.duty)", "UL106", "this is no element"),
        ("pid(feedback=s.position+1, output=m.duty)", "UL106", "this is no element"),
        ("pid(feedback=s.position)", "UL030", "`pid` is given no `output`"),
        ("pid(feedback=s.position, output=m.duty, safe=s.position)", "UL047", "`s.position` is an element"),
        ("pid(feedback=s.position, output=m.duty, filter_bits=9)", "UL049", ""),
    ],
)
@pytest.mark.parametrize("place", ["", " @ 0x40"])
def test_what_does_not_fit_is_refused_where_it_is_used(loop: str, code: str, says: str, place: str) -> None:
    text = f"public a() {{ {PARTS} l: {loop}{place}; later: quadrature_encoder(); }}"
    found = compile_text(text, "robot.ul").diagnostics
    assert found and found[0].code == code and found[0].message.startswith(says), found
    assert all(one.span.file == "robot.ul" for one in found)
    assert text[found[0].span.start :].startswith(("pid", "s", "later", "m", "3"))


def test_a_wire_may_be_left_out() -> None:
    loop = f"{PARTS} l: pid(feedback=s.position, output=m.duty);"
    for given in ("", ", none", ", velocity=none"):
        spec = clean(f"public a() {{ {loop} p: motion_profile(s.position, l.target{given}); }}")
        profile = components_of(spec, 50_000_000)[-1]
        assert ("position_wire", "out") in profile.wires
        assert components_of(spec, 50_000_000)[2].connections == ((0, 1, 0), (1, 3, 0))
    spec = clean(f"public a() {{ {loop} p: motion_profile(s.position, l.target, l.target_velocity); }}")
    assert components_of(spec, 50_000_000)[2].connections == ((0, 1, 0), (1, 3, 0), (2, 3, 1))


def test_a_profile_and_its_loop_have_one_period() -> None:
    path = "p: motion_profile(s.position, l.target, l.target_velocity, l.target_acceleration"
    loop = f"{PARTS} l: pid(feedback=s.position, output=m.duty, loop_hz=10000);"
    clean(f"public a() {{ {loop} {path}, loop_hz=10000); }}")
    found = compile_text(f"public a() {{ {loop} {path}); }}", "robot.ul").diagnostics
    assert [one.code for one in found] == ["UL049"] and found[0].message.startswith("`velocity` is")


def test_an_input_has_one_wire() -> None:
    text = (
        f"public a() {{ {PARTS} l: pid(feedback=s.position, output=m.duty);"
        " k: pid(feedback=s.velocity, output=m.duty); }"
    )
    (found,) = compile_text(text, "robot.ul").diagnostics
    assert (found.code, found.message) == ("UL106", "`l` has a wire to `duty_wire` of `m` already")
