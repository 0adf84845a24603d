# SPDX-License-Identifier: BSD-3-Clause
import pytest
from hypothesis import given
from hypothesis import strategies as st

from unitylink.errors import UnknownName
from unitylink.server.subtree import contains, known, overlap, subtree
from unitylink.spec import compile_text

ROBOT = """
public arm() {
   j1: joint() @ (0x10, 0x11);
   j[3]: joint() @ (0x20+2*i,0x21+2*i);
   @duty[2] = 0x40: WRITE();
}
joint(): @ (target, angle) { @target: WRITE(); @angle: READ(); }
"""
PARTS = st.lists(st.sampled_from(["a", "b", "a[1]", "ab"]), max_size=3).map(".".join)


def test_texts_that_name_a_part():
    assert [subtree(text) for text in ("j1", "j1.*", " j1 ", "*", "", "j[2].x")] == [
        "j1",
        "j1",
        "j1",
        "",
        "",
        "j[2].x",
    ]


@pytest.mark.parametrize("text", ["j1.", ".j1", "j*", "j1..x", "j[].x", "j1 x", "../etc", "j1\n"[:-1] + ";"])
def test_texts_that_name_no_part(text):
    with pytest.raises(UnknownName, match="names no part of a robot"):
        subtree(text)


@given(PARTS, PARTS, PARTS)
def test_contains_is_an_order_and_overlap_is_symmetric(one, two, three):
    assert contains(one, one)
    assert contains("", one)
    if contains(one, two) and contains(two, one):
        assert one == two
    if contains(one, two) and contains(two, three):
        assert contains(one, three)
    assert overlap(one, two) == overlap(two, one)


def test_a_part_is_one_of_the_robot():
    root = compile_text(ROBOT, "arm.ul").spec.root()
    for name in ("", "j1", "j1.target", "j", "j[2]", "j[2].angle", "duty", "duty[1]"):
        assert known(root, name) == name
    with pytest.raises(UnknownName, match=r"no part 'j1.taget'; did you mean j1.target\?"):
        known(root, "j1.taget")
    with pytest.raises(UnknownName):
        known(root, "j[3]")
