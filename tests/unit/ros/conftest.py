# SPDX-License-Identifier: BSD-3-Clause
"""The rig's spec, and a board of it."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from unit.ros.rig import TEXT, Still

from unitylink.simulate import Board
from unitylink.spec import compile_text
from unitylink.spec.model import Spec


@pytest.fixture(scope="module")
def spec() -> Spec:
    result = compile_text(TEXT, "rig.ul")
    assert result.spec is not None, result.diagnostics
    return result.spec


@pytest.fixture
def board(spec: Spec) -> Iterator[Board]:
    with Board(spec, plant=Still(), endpoint="tcp") as made:
        yield made
