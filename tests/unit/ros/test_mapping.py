# SPDX-License-Identifier: BSD-3-Clause
"""From a spec to ROS names and types, by the rule of docs/ros.md."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from unitylink.errors import BindingError
from unitylink.ros import Interface, plan_interface
from unitylink.ros.definitions import definition
from unitylink.ros.names import field_name, joint_name, message_name, package_name, topic_name
from unitylink.spec import compile_text, load

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"


def interface_of(text: str, *, standard: bool = False) -> Interface:
    result = compile_text(text, "robot.ul")
    assert result.spec is not None, result.diagnostics
    return plan_interface(result.spec, standard=standard)


def topics(interface: Interface) -> dict[str, str]:
    return {topic.name: topic.type for topic in (*interface.published, *interface.commanded)}


@given(st.from_regex(r"[A-Za-z_][A-Za-z0-9_]{0,12}(\[[0-9]{1,2}\])?", fullmatch=True))
def test_names_are_those_of_ros_2(name: str) -> None:
    """ROS 2 is stricter than ROS 1: no double underscore, none at the end, fields in lower case."""
    assert re.fullmatch(r"[a-z]([a-z0-9]|_(?=[a-z0-9]))*", field_name(name))
    assert re.fullmatch(r"[A-Z][A-Za-z0-9]*", message_name(name))
    for made in (topic_name(name), joint_name(name)):
        assert re.fullmatch(r"[A-Za-z]([A-Za-z0-9]|_(?=[A-Za-z0-9]))*", made)
    assert re.fullmatch(r"[a-z]([a-z0-9]|_(?=[a-z0-9]))*_unitylink", package_name(name))


def test_scara() -> None:
    """The paper's robot has one message per joint and direction, shared by all joints, and a scalar per
    set-point.
    """
    interface = plan_interface(load(EXAMPLES / "scara" / "scara.ul"))
    assert [message.name for message in interface.messages] == ["JointFeedback", "JointCommand"]
    found = topics(interface)
    assert found["j3/feedback"] == "scara_unitylink/JointFeedback"
    assert found["j3/command"] == "scara_unitylink/JointCommand"
    assert found["j3/pos_sp"] == "std_msgs/Int32" and found["j3/spd_sp"] == "std_msgs/UInt32"
    assert len(found) == 4 * 4
    assert "int32 cpos\nuint32 spd\n" in definition(interface.messages[0])


def test_walker_has_joints_by_units_and_names() -> None:
    interface = plan_interface(load(EXAMPLES / "walker18" / "walker18_si.ul"))
    (states,) = [topic for topic in interface.published if topic.name == "joint_states"]
    (commands,) = [topic for topic in interface.commanded if topic.name == "joint_commands"]
    assert len(states.joints) == len(commands.joints) == 18
    assert states.joints[4].name == commands.joints[4].name == "leg_1_knee"
    assert states.paths[states.joints[4].position] == "leg[1].knee"
    assert commands.paths[commands.joints[4].position] == "leg[1].knee_sp"
    assert states.joints[4].velocity == -1


def test_units_become_those_of_ros() -> None:
    interface = interface_of(
        """public arm() { j: axis() @ (0x0,0x1,0x2,0x3); }
        axis(): @ (p,v,s,m) {
          @p: i16 READ(UNIT="deg", SCALE=0.1, PUBLISH(1,10)); @v: i16 READ(UNIT="rpm", PUBLISH(1,10));
          @s: i16 WRITE(UNIT="deg", SCALE=0.1); @m: u16 WRITE(UNIT="rpm");
        }"""
    )
    (joint,) = next(topic for topic in interface.published if topic.form == "joints").joints
    assert (joint.name, joint.position, joint.velocity) == ("j", 0, 1)
    assert joint.position_factor == pytest.approx(math.pi / 180)
    assert joint.velocity_factor == pytest.approx(math.pi / 30)


def test_annotations_say_what_structure_does_not() -> None:
    interface = interface_of(
        """public cart() {
           @ros(name="left", frame="base") w: wheel() @ (0x0,0x1,0x2);
           base: drive() @ (0x3,0x4);
        }
        @ros(type="JointState", position="ticks", velocity_sp="rate", joint="left_wheel")
        wheel(): @ (a,b,c) { @ticks=a: signed READ(PUBLISH(1,10)); @rate=b: signed WRITE();
           @ros(type="UInt32") @count=c: READ(PUBLISH(1,100)); }
        @ros(type="Twist", linear_x="v", angular_z="w")
        drive(): @ (v,w) { @v: f32 WRITE(); @w: f32 WRITE(); }"""
    )
    found = topics(interface)
    assert found["left/count"] == "std_msgs/UInt32"
    assert found["base/cmd_vel"] == "geometry_msgs/Twist"
    assert {"left/feedback_100hz", "left/feedback_10hz"} <= set(found)
    (joint,) = next(topic for topic in interface.commanded if topic.name == "joint_commands").joints
    assert (joint.name, joint.velocity) == ("left_wheel", 0)
    assert next(t for t in interface.published if t.name == "left/feedback_10hz").frame == "base"


def test_types_are_not_all_uint32() -> None:
    interface = interface_of(
        """enum Mode : u2 { idle = 0; run = 1; }
        bits Flags : u8 { on: bool @ 0;
           /// how hot
           heat: u6 @ 6..1 (UNIT="°C", SCALE=0.5); }
        public r() { p: part(); }
        part(): @base[16] {
          @mode = base: Mode WRITE(); @flags = base+1: Flags WRITE();
          @duty[3] = base+4+i: u12 WRITE(UNIT="%", SCALE=0.1);
          @gain = base+2: f32 WRITE(MIN=0, MAX=2); @class = base+3: i8 WRITE();
          @far = base+8: u48 WRITE();
        }"""
    )
    text = {message.name: definition(message) for message in interface.messages}
    lines = text["PartCommand"].splitlines()
    for line in (
        "uint8 MODE_RUN=1",
        "uint8 mode",
        "Flags flags",
        "float64[3] duty     # %",
        "float32 gain        # 0 to 2",
        "int8 class_value",
        "uint64 far",
    ):
        assert line in lines, text
    assert "float64 heat   # °C: how hot" in text["Flags"].splitlines()
    scalars = topics(interface)
    assert scalars["p/duty_1"] == "std_msgs/Float64" and scalars["p/flags"] == "std_msgs/UInt8"


def test_standard_messages_alone() -> None:
    interface = plan_interface(load(EXAMPLES / "scara" / "scara.ul"), standard=True)
    assert not interface.messages
    assert {kind.partition("/")[0] for kind in topics(interface).values()} == {"std_msgs"}
    assert topics(interface)["j1/cpos"] == "std_msgs/Int32"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("public r() {@aB=0x0: WRITE(); @a_b=0x1: WRITE(); }", "`aB` and `a_b` both become the field 'a_b'"),
        ('public s() { @ros(name="command") @t=0x0: WRITE(); }', "both the topic 'command'"),
        ('public s() { @ros(typ="Int32") @t=0x0: WRITE(); }', "no option 'typ'; there are name, type"),
        ('public s() { @ros("Int32") @t=0x0: WRITE(); }', "has no key"),
        ('public s() { @ros(type="Int8") @t=0x0: WRITE(); }', "its values are UInt32"),
        ('public s() { @ros(queue="9") @t=0x0: WRITE(); }', "queue='9' is not of type int"),
        ("public s() { @ros(reliable=2) @t=0x0: WRITE(); }", "reliable=2 is not of type bool"),
        ("public s() { @ros(queue=0) p: q() @ (0x0);} q(): @ (x) {@x: WRITE();}", "queue must be 1"),
        (
            'public s() { @ros(type="Twist") p: q() @ (0x0);} q(): @ (x) {@x: WRITE();}',
            "needs its targets",
        ),
        ('public s() { @ros(type="Gyro") p: q() @ (0x0);} q(): @ (x) {@x: WRITE();}', "'Gyro' is none of"),
        (
            'public s() { @ros(type="JointState") p: q() @ (0x0);} q(): @ (x) {@x: WRITE();}',
            "no value has a unit",
        ),
        (
            'public s() { @ros(type="JointState", position="y") p: q() @ (0x0);} q(): @ (x) {@x: WRITE();}',
            "position='y' is no published value; there are: none",
        ),
        (
            """link a (DATA=32); link b (DATA=32); public cell(c,x,y) { p: q(c,x); r: s(c,y); }
            q(c,u) { MEMORY(CTRL=c, COMM=u, LINK=a); @v = 0x0: READ(); }
            s(c,u) { MEMORY(CTRL=c, COMM=u, LINK=b); @v = 0x0: READ(); }""",
            "`cell` needs 2 links (x, y), but a node has one; write a public constructor",
        ),
    ],
)
def test_impossible_mappings_are_reported_with_place_and_remedy(text: str, says: str) -> None:
    with pytest.raises(BindingError, match=re.escape(says)) as caught:
        interface_of(text)
    assert "robot.ul" in str(caught.value)


def test_shapes_that_differ_have_messages_that_differ() -> None:
    interface = interface_of(
        """public r() { a: c(1) @ (0x0); b: c(0.5) @ (0x1); d: c(1) @ (0x2); }
        c(s: real): @ (v) { @v: u16 READ(SCALE=s, PUBLISH(1,10)); }"""
    )
    found = topics(interface)
    assert found["a/feedback"] == found["d/feedback"] == "r_unitylink/CFeedback"
    assert found["b/feedback"] == "r_unitylink/CFeedback2"


CPP_KEYWORDS = """
alignas alignof and and_eq asm auto bitand bitor bool break case catch char char16_t char32_t char8_t class
co_await co_return co_yield compl concept const const_cast consteval constexpr constinit continue decltype
default delete do double dynamic_cast else enum explicit export extern false float for friend goto if inline
int long mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected public
register reinterpret_cast requires return short signed sizeof static static_assert static_cast struct switch
template this thread_local throw true try typedef typeid typename union unsigned using virtual void volatile
wchar_t while xor xor_eq
"""  # [lex.key] and [lex.digraph] of C++20


def test_no_field_is_a_word_of_cpp() -> None:
    words = CPP_KEYWORDS.split()
    assert [field_name(word) for word in words] == [f"{word}_value" for word in words]


@pytest.mark.parametrize("name", ["header", "read", "writeRequest"])
def test_no_message_is_what_ros_has(name: str) -> None:
    """In ROS 1, a type Header would be that of std_msgs.

    A service Read also makes the file of a message Read.
    """
    text = f"bits {name}: u8 {{ a: u4 @ 3..0; }} public p() {{ @x = 0x0: {name} READ(PUBLISH(1,1)); }}"
    spec = compile_text(text, "p.ul").spec
    assert spec is not None
    (packed, _) = plan_interface(spec).messages
    assert packed.name == f"{name[0].upper()}{name[1:]}Bits"


def test_unprintable_characters_are_not_in_names_of_ros() -> None:
    text = 'public p() { @ros(frame="base\\nlink") @a = 0x0: READ(PUBLISH(1,1)); }'
    spec = compile_text(text, "p.ul").spec
    assert spec is not None
    with pytest.raises(BindingError, match=r"p\.ul:1: `a`: @ros\(\.\.\): frame='base\\nlink' has characters"):
        plan_interface(spec)


def test_joints_come_out_of_arrays() -> None:
    interface = interface_of(
        """link l(ADDRESS=8);
        public stage() { motor: stepgen(axes=3, scale=1/80 mm, rate=100 Hz); }"""
    )
    (states,) = [topic for topic in interface.published if topic.name == "joint_states"]
    (commands,) = [topic for topic in interface.commanded if topic.name == "joint_commands"]
    assert [joint.name for joint in states.joints] == ["motor_0", "motor_1", "motor_2"]
    assert states.paths[2:4] == ("motor.position[1]", "motor.velocity[1]")
    assert states.joints[1].velocity_factor == 1e-3
    assert commands.paths == tuple(f"motor.target[{axis}]" for axis in range(3))
    assert [joint.name for joint in commands.joints] == ["motor_0", "motor_1", "motor_2"]
