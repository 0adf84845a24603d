# SPDX-License-Identifier: BSD-3-Clause
"""Objects of a spec on gateware that was built from another are refused, where the gateware can tell."""

from __future__ import annotations

import pytest

from unitylink.errors import DeviceMismatch
from unitylink.layer2_message import Link
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board, BoardConfiguration
from unitylink.spec import Spec, compile_text


def spec_of(text: str) -> Spec:
    spec = compile_text(f"public robot() {{ {text} }}").spec
    assert spec is not None
    return spec


def test_other_gateware_is_refused_and_the_same_is_not() -> None:
    spec = spec_of("@power = 0x10: u16 WRITE();")
    with Board(spec) as board, Link(f"{board.url}?timeout=2") as link:
        load_spec_objects(spec_of("@voltage = 0x10: u16 WRITE();"), link)
        with pytest.raises(DeviceMismatch, match="wire hash"):
            load_spec_objects(spec_of("@power = 0x11: u16 WRITE();"), link)


def test_gateware_that_cannot_tell_is_not_refused() -> None:
    spec = spec_of("@power = 0x10: u16 WRITE();")
    classic = BoardConfiguration(protocol="classic")
    for board in (Board(), Board(spec, configuration=classic)):
        with board, Link(f"{board.url}?timeout=2") as link:
            load_spec_objects(spec_of("@power = 0x11: u16 WRITE();"), link)
