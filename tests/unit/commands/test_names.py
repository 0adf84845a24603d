# SPDX-License-Identifier: BSD-3-Clause
"""Names, patterns and addresses of the command line."""

from __future__ import annotations

import click
import pytest
from hypothesis import given
from hypothesis import strategies as st

from unitylink.commands.failure import Failure
from unitylink.commands.names import Item, Names
from unitylink.commands.value_text import parse_value
from unitylink.spec.model import Element, Group, Instance, LinkBinding, Span, Spec
from unitylink.spec.types import INT32, UINT32

SPAN = Span("arm.ul", 1, 1, 0, 1)
MEMORY = LinkBinding("memory")


def element(path: str, address: int, access: str = "READ", signed: bool = False) -> Element:
    word = INT32 if signed else UINT32
    return Element(
        path.rsplit(".", maxsplit=1)[-1], path, address, access, word, path, False, None, MEMORY, SPAN
    )


def joint(name: str, base: int) -> Instance:
    members = (element(f"{name}.cpos", base, signed=True), element(f"{name}.pos_sp", base + 1, "WRITE"))
    return Instance(name, name, "joint", name, MEMORY, members, (), SPAN)


def root(name: str = "arm") -> Instance:
    j1, j2 = joint("j1", 0x80), joint("j2", 0x90)
    both = Group("both", "both", (j1.elements[1], j2.elements[1]), SPAN)
    return Instance(name, "", name, name, MEMORY, (j1, j2, both), (), SPAN)


def names(*roots: Instance) -> Names:
    return Names(Spec("arm", "", "arm.ul", "0" * 16, roots or (root(),)))


def found(words: list[str], *roots: Instance) -> list[str]:
    return [item.name for item in names(*roots).find(words)]


def test_a_name_a_pattern_an_instance_a_group_an_address() -> None:
    assert found(["j1.cpos"]) == ["j1.cpos"]
    assert found(["j*.cpos"]) == ["j1.cpos", "j2.cpos"]
    assert found(["j2"]) == ["j2.cpos", "j2.pos_sp"]
    assert found(["both"]) == ["j1.pos_sp", "j2.pos_sp"]
    assert found(["0x88"]) == ["0x0088"]
    assert found(["arm"]) == ["j1.cpos", "j1.pos_sp", "j2.cpos", "j2.pos_sp"]


def test_brackets_in_a_pattern_are_those_of_an_array() -> None:
    legs = tuple(joint(f"leg[{index}]", 0x10 * index) for index in range(3))
    robot = Instance("walker", "", "walker", "walker", MEMORY, legs, (), SPAN)
    assert found(["leg[1].*"], robot) == ["leg[1].cpos", "leg[1].pos_sp"]
    assert found(["leg[*].cpos"], robot) == ["leg[0].cpos", "leg[1].cpos", "leg[2].cpos"]
    with pytest.raises(Failure, match=r"the pattern 'leg\[3\].\*' matches no item"):
        found(["leg[3].*"], robot)


def test_the_order_typed_is_kept_and_each_item_comes_once() -> None:
    assert found(["j2.cpos", "*.cpos", "j2.cpos"]) == ["j2.cpos", "j1.cpos"]


def test_with_two_public_constructors_names_begin_with_theirs() -> None:
    two = (root("left"), root("right"))
    assert found(["right.j1.cpos"], *two) == ["right.j1.cpos"]
    assert found(["right.both"], *two) == ["right.j1.pos_sp", "right.j2.pos_sp"]
    assert len(found(["left"], *two)) == 4
    with pytest.raises(Failure, match=r"no item 'j1\.cpos'"):
        found(["j1.cpos"], *two)


@pytest.mark.parametrize(
    ("word", "message", "advice"),
    [
        ("j1.cpso", "no item 'j1.cpso' in arm.ul", "did you mean 'j1.cpos'"),
        ("J1.CPOS", "no item", "did you mean 'j1.cpos'"),
        ("k*.cpos", "matches no item", "unitylink list --spec arm.ul"),
        ("0x100000000", "more than 32 bits", ""),
    ],
)
def test_a_word_that_finds_nothing(word: str, message: str, advice: str) -> None:
    with pytest.raises(Failure, match=message) as caught:
        names().find([word])
    assert advice in caught.value.help_line


def test_a_name_without_a_spec() -> None:
    with pytest.raises(Failure, match="names come from a spec") as caught:
        Names(None).find(["j1.cpos"])
    assert "--spec" in caught.value.help_line
    assert [item.address for item in Names(None).find(["0x88"])] == [0x88]


@pytest.mark.parametrize(
    ("text", "number"), [("30", 30), ("-30", -30), ("0x1E", 30), ("0b11", 3), ("1_000", 1000)]
)
def test_numbers(text: str, number: int) -> None:
    assert parse_value(text, Item("x", 1)) == number


@pytest.mark.parametrize("text", ["", "ten", "1.5", "0x", "--1", "1e3"])
def test_what_is_no_number(text: str) -> None:
    with pytest.raises(click.UsageError, match=r"j1: '.*' is not an integer"):
        parse_value(text, Item("j1", 1))


@given(st.text(max_size=30))
def test_any_word_finds_something_or_fails_politely(word: str) -> None:
    try:
        assert names().find([word])
    except Failure as failure:
        assert failure.message
