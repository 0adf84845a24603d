# SPDX-License-Identifier: BSD-3-Clause
"""What a component's values are is said where it is used: unit, scale, rate, limits and safe value."""

from __future__ import annotations

import math

import pytest

from unitylink.ros.mapping import plan_interface
from unitylink.spec import Element, Spec, compile_text


def clean(text: str) -> Spec:
    result = compile_text(text, "robot.ul")
    assert [(d.code, d.message) for d in result.diagnostics] == []
    assert result.spec is not None
    return result.spec


def element(text: str, path: str) -> Element:
    return dict(clean(text).walk())[path]


def test_an_encoder_counts_in_radians_and_publishes() -> None:
    position = element(
        "public a() { wheel: quadrature_encoder(rate=100 Hz, scale=2*pi/4096 rad); }", "wheel.position"
    )
    assert position.unit == "rad"
    assert position.scale == pytest.approx(2 * math.pi / 4096, rel=1e-15)
    assert position.publish is not None and position.publish.rate_hz == 100


def test_an_encoder_that_is_told_nothing_counts_and_publishes_nothing() -> None:
    position = element("public a() { wheel: quadrature_encoder(); }", "wheel.position")
    assert (position.unit, position.scale, position.publish) == ("count", 1, None)


def test_two_of_a_kind_differ() -> None:
    spec = clean(
        "public a() { fine: quadrature_encoder(scale=360/4096 deg); coarse: quadrature_encoder(rate=10 Hz); }"
    )
    found = {path: (one.unit, one.scale, one.publish is None) for path, one in spec.walk()}
    assert found["fine.position"] == ("deg", 360 / 4096, True)
    assert found["coarse.position"] == ("count", 1, False)


def test_limits_and_safe_value() -> None:
    text = "public a() { s: pwm(channels=1, scale=1 us, maximum=2.5 ms, safe=1500); }"
    width = element(text, "s.width[0]")
    assert (width.unit, width.maximum, width.safe) == ("us", 2500, 1500)
    bare = element("public a() { s: pwm(channels=1); }", "s.width[0]")
    assert (bare.unit, bare.maximum, bare.safe) == ("", None, 0)


def test_what_is_not_given_is_handed_down() -> None:
    text = (
        "public a() { l: leg(); r: leg(rate=50 Hz); } "
        "leg(rate: real = none) { knee: quadrature_encoder(rate=rate); }"
    )
    found = dict(clean(text).walk())
    assert found["l.knee.position"].publish is None
    assert found["r.knee.position"].publish is not None


def test_ros_gets_a_topic_of_the_position() -> None:
    spec = clean("public cart() { wheel: quadrature_encoder(rate=100 Hz, scale=pi/2048 rad); }")
    (topic,) = plan_interface(spec).published
    assert (topic.name, topic.paths) == ("wheel/feedback", ("wheel.position",))


def test_a_joint_state_has_the_velocity_of_its_encoder() -> None:
    text = (
        'public cart() { @ros(type="JointState") '
        "wheel: quadrature_encoder(rate=100 Hz, scale=pi/2048 rad, with_velocity=1); }"
    )
    velocity = element(text, "wheel.velocity")
    assert (velocity.unit, velocity.scale) == ("rad/s", pytest.approx(math.pi / 2048 / 256, rel=1e-15))
    (topic,) = [one for one in plan_interface(clean(text)).published if one.joints]
    assert (topic.type, topic.paths) == ("sensor_msgs/JointState", ("wheel.position", "wheel.velocity"))
    (joint,) = topic.joints
    assert (joint.position, joint.velocity) == (0, 1)


def test_a_word_of_the_language_may_be_a_name_of_the_spec() -> None:
    assert element("const pi = 3; public a() { @x = 0x0: READ(SCALE=pi); }", "x").scale == 3
    spec = clean("public a() { b: b(4); } b(pi: int) { @x = 0x0: READ(SCALE=pi); }")
    assert dict(spec.walk())["b.x"].scale == 4


@pytest.mark.parametrize(
    ("use", "code", "at", "says"),
    [
        ("quadrature_encoder(rate=5 kHz)", "UL101", "quadrature_encoder", "5000 Hz cannot be published"),
        ("quadrature_encoder(rate=5 m)", "UL088", "quadrature_encoder", "the rate of PUBLISH is in `Hz`"),
        ("quadrature_encoder(scale=0 rad)", "UL091", "quadrature_encoder", "a SCALE of 0"),
        (
            "quadrature_encoder(scale=none)",
            "UL094",
            "none",
            "`scale` of `quadrature_encoder` cannot",
        ),
        ("gpio(pins=none)", "UL094", "none", "`pins` of `gpio` cannot be `none`"),
        ("gpio(pins=4, safe=16)", "UL090", "gpio", "SAFE is 16"),
        ("pwm(scale=1 us, maximum=1 ms, safe=2000)", "UL090", "pwm", "SAFE 2,000 is above MAX 1,000"),
        ("pwm(scale=1 us, maximum=1 V)", "UL088", "pwm", "MAX is in `us`"),
        ("quadrature_encoder(scale=1/0 rad)", "UL048", "1/0 rad", "a division by zero"),
        ("quadrature_encoder(scale=2 degC*(1 rad))", "UL088", "2 degC*(1 rad)", "there is no unit for"),
        ("quadrature_encoder(scale=1/(1 degC))", "UL088", "1/(1 degC)", "there is no unit for"),
        ("quadrature_encoder(scale=1 m/(0 s))", "UL048", "1 m/(0 s)", "a division by zero"),
    ],
)
def test_a_mistake_is_reported_where_the_component_is_used(use: str, code: str, at: str, says: str) -> None:
    text = f"public a() {{ part: {use}; }}"
    found = compile_text(text, "robot.ul").diagnostics
    assert [(one.code, one.span.file) for one in found] == [(code, "robot.ul")]
    assert found[0].message.startswith(says)
    assert text[found[0].span.start :].startswith(at)


@pytest.mark.parametrize(
    ("expression", "unit", "scale"),
    [
        ("2*pi/4096 rad/(256 s)", "rad/s", 2 * math.pi / 4096 / 256),
        ('0.01 "rad/s"', "rad/s", 0.01),
        ("6 deg/(2 s)/(3 s)", "deg/s^2", 1),
        ("1/(2 mm)", "1/mm", 0.5),
        ("3 m*(2 m)", "m^2", 6),
        ("8 m*(2 s)/(4 s)", "m", 4),
        ("4 m/(2 m)", "", 2),
        ("3*(2 deg)/(1 s)*2", "deg/s", 12),
    ],
)
def test_products_and_quotients_have_units(expression: str, unit: str, scale: float) -> None:
    found = element(f"public a() {{ @x = 0x0: i32 READ(SCALE={expression}); }}", "x")
    assert found.unit == unit
    assert found.scale == pytest.approx(scale, rel=1e-14)


def test_an_element_may_depend_on_a_parameter() -> None:
    text = (
        "public a() { plain: b(); more: b(extra=2); } "
        "b(extra: int = 0): @base[2] { @x = base: READ(); @when(extra) @y = base+1: READ(); }"
    )
    assert [path for path, _ in clean(text).walk()] == ["plain.x", "more.x", "more.y"]
    found = compile_text('public a() { @when("x") @y = 0x1: READ(); }').diagnostics
    assert [(one.code, one.message) for one in found] == [
        ("UL047", "`@when` is a number, but this is a string")
    ]
    found = compile_text("public a() { @when(1, 2) @y = 0x1: READ(); }").diagnostics
    assert [one.code for one in found] == ["UL098"]


def test_none_is_no_number() -> None:
    found = compile_text("public a() { b: b(); } b(at: int = none) { @x = at: READ(); }").diagnostics
    assert [(one.code, one.message) for one in found] == [
        ("UL047", "an address is a number, but this is `none`")
    ]
