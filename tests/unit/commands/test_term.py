# SPDX-License-Identifier: BSD-3-Clause
"""What `term` sends for a typed line, and what a typed line may be."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from unitylink.commands.names import Names
from unitylink.commands.term import complete, prepare
from unitylink.layer1_stream import ClassicEncoder
from unitylink.spec import compile_text

SPEC = compile_text(
    "public arm() { j: joint() @ (0x88,0x8C); } joint(): @ (pos,target) { @pos: READ(); @target: WRITE(); }"
)
NAMES = Names(SPEC.spec)


@pytest.mark.parametrize(
    ("typed", "sent"),
    [
        ("#RLC", "#RLC"),
        ("#R:j.pos", "#R:0088"),
        ("#RM:02 j.pos, j.target", "#RM:020088008C"),
        ("$R:12", "$R:12*58"),
        ("$R:12*00", "$R:12*00"),  # a typed checksum is kept, because it may be wrong on purpose
        ("#W:j.target 0000000A", "#W:008C0000000A"),
        ("$r:1e", "$r:1e*D2"),  # lower-case letters are other bytes, and are sent unchanged
        ("nonsense", "nonsense"),
        ("$R:1", "$R:1"),
    ],
)
def test_names_and_checksums_are_filled_in(typed: str, sent: str) -> None:
    assert prepare(typed, NAMES, 2) == sent


@given(letters=st.sampled_from(["R", "RLC", "WSA", "wsa", ""]), data=st.binary(max_size=20))
def test_checksums_are_those_of_the_link(letters: str, data: bytes) -> None:
    typed = f"${letters}" + (f":{data.hex().upper()}" if data else "")
    assert prepare(typed, NAMES, 1).encode() + b"\n" == ClassicEncoder(checked=True).encode(letters, data)


def test_an_unknown_name_is_reported_with_the_most_similar_one() -> None:
    with pytest.raises(ValueError, match=r"did you mean j\.pos"):
        prepare("#R:j.pso", NAMES, 2)


def test_completion_knows_commands_and_names() -> None:
    assert complete("#W", NAMES) == ["W", "WSA", "WSR", "WIC"]
    assert complete("$rl", NAMES) == ["RLC"]
    assert complete("#R:j.", NAMES) == ["j.pos", "j.target"]
    assert complete("#RM:02 j.pos j.t", NAMES) == ["j.target"]
    assert complete("R", NAMES) == []
