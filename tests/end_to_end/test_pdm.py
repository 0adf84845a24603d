# SPDX-License-Identifier: BSD-3-Clause
"""An analog output of -10 V to 10 V by `pdm`: it follows the volts, and the dead-man sets its safe value."""

from __future__ import annotations

import time

import pytest

from unitylink import Link
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board
from unitylink.spec import compile_text

TEXT = """
link cell (ADDRESS=8);
public cell() {
   analog: pdm(channels=2, full_scale=20 V, offset=-10 V, start=8192, safe=0 V);
}
"""


def is_density(board: Board, share: float) -> None:
    """Wait until the output has this density."""
    output = board.components["analog"]
    end = time.monotonic() + 20
    while True:
        output.duty("pins", 1)
        time.sleep(0.02)
        if output.duty("pins", 1) == pytest.approx(share, abs=0.001):
            return
        assert time.monotonic() < end


def test_the_density_follows_the_volts_and_the_dead_man_sets_its_safe_value() -> None:
    spec = compile_text(TEXT, "cell.ul").spec
    assert spec is not None
    with Board(spec, endpoint="tcp") as board:
        is_density(board, 0.25)  # before anything is written
        with Link(f"{board.url}?protocol=framed&deadman=1") as link:  # longer than a busy machine pauses
            analog = load_spec_objects(spec, link)["analog.density[1]"]
            assert analog.read() == -5.0
            analog.write(5.0)
            is_density(board, 0.75)
            board.hang_up()
            is_density(board, 0.5)
