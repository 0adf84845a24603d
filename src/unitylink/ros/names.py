# SPDX-License-Identifier: BSD-3-Clause
"""Names of a spec as ROS names. One rule serves ROS 1 and ROS 2, and follows the stricter of the two."""

from __future__ import annotations

import keyword
import re

# Names that a field may not have: words of the languages of compiled messages, and our own fields.
_CPP = """
alignas alignof and and_eq asm auto bitand bitor bool break case catch char char16_t char32_t char8_t class
co_await co_return co_yield compl concept const const_cast consteval constexpr constinit continue decltype
default delete do double dynamic_cast else enum explicit export extern false float for friend goto if inline
int linux long mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected public
register reinterpret_cast requires return short signed sizeof static static_assert static_cast struct switch
template this thread_local throw true try typedef typeid typename union unix unsigned using virtual void
volatile wchar_t while xor xor_eq
"""  # of C++20; linux and unix are macros of GCC
# For messages. In ROS 1, a type Header would be that of std_msgs, and a service's header has the name of a
# message's.
_SERVICES = ("Read", "Write")
RESERVED_MESSAGES = frozenset(
    {"Header", *(name + end for name in _SERVICES for end in ("", "Request", "Response", "Event"))}
)
RESERVED_FIELDS = frozenset({"header", "sequence", "self", "serialize", "deserialize"})
_WORDS = frozenset(_CPP.split()) | {word.lower() for word in keyword.kwlist}


def field_name(name: str) -> str:
    """Return the name of a message's field: lower case, with one underscore between words.

    >>> field_name("cpos"), field_name("maxSpeed"), field_name("leg[2]"), field_name("class")
    ('cpos', 'max_speed', 'leg_2', 'class_value')
    """
    words = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()
    plain = re.sub(r"[^a-z0-9]+", "_", words).strip("_")
    if not plain or plain[0].isdigit():
        plain = f"n{plain}"
    return f"{plain}_value" if plain in RESERVED_FIELDS | _WORDS else plain


def topic_name(path: str) -> str:
    """Return a topic's name, relative to the namespace of the robot.

    >>> topic_name("leg[2].hip"), topic_name("_a.B__c")
    ('leg_2/hip', 'a/B_c')
    """
    steps = [re.sub(r"[^A-Za-z0-9]+", "_", step).strip("_") or "n" for step in path.split(".")]
    return "/".join(f"n{step}" if step[0].isdigit() else step for step in steps)


def joint_name(path: str) -> str:
    """Return a joint's name in the form of URDFs: `leg[2].hip` -> `leg_2_hip`."""
    return topic_name(path).replace("/", "_")


def message_name(name: str) -> str:
    """Return a message's name: `servo_left` -> `ServoLeft`."""
    steps = re.split(r"[^A-Za-z0-9]+", name)
    joined = "".join(step[:1].upper() + step[1:] for step in steps)
    return joined if joined[:1].isalpha() else f"N{joined}"


def constant_name(field: str, name: str) -> str:
    """Return the name of a number of an enumeration: `mode`, `run` -> `MODE_RUN`."""
    return f"{field_name(field)}_{field_name(name)}".upper()


def package_name(robot: str) -> str:
    """Return the package of a robot.

    >>> package_name("scara")
    'scara_unitylink'
    """
    return f"{field_name(robot).removesuffix('_value')}_unitylink"
