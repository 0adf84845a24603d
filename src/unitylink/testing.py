# SPDX-License-Identifier: BSD-3-Clause
"""A pytest fixture for robots: `unitylink_sim`. It exists as soon as Unity-Link is installed.

    def test_the_arm_moves(unitylink_sim):
        arm = unitylink_sim("arm.ul", plant="loopback")
        arm.robot["x.target"].write(100)
        assert arm.registers[arm.robot["x.target"].address] == 100

pytest finds it as a plug-in, so you import nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from unitylink.layer2_message import Link
    from unitylink.layer4_data import Node
    from unitylink.simulate import Board, Registers
    from unitylink.simulate.plant import AnyPlant
    from unitylink.spec.model import Spec


@dataclass(frozen=True)
class Simulated:
    """A robot of a spec on a virtual board: its objects, the link, and the board's side of the registers."""

    spec: Spec
    board: Board
    link: Link
    robot: Node

    @property
    def registers(self) -> Registers:
        """The registers from the FPGA's side. Set what sensors measure, and get what was written."""
        return self.board.registers


@pytest.fixture
def unitylink_sim(request: pytest.FixtureRequest) -> Iterator[Callable[..., Simulated]]:
    """Make robots on virtual boards: `unitylink_sim(SPEC, plant=None, options="", **generics)`.

    SPEC is a file. It is looked for beside the test, and then in the working folder. `plant` is the name of a
    plant, a file, or an object with `attach` and `step`. `options` are those of a link URL ("crc=1").
    `generics` are those of `BoardConfiguration`, such as `data_bits=16`. Everything is closed when the test
    ends.
    """
    with ExitStack() as stack:

        def simulated(
            spec_file: str | Path, *, plant: str | AnyPlant | None = None, options: str = "", **generics: Any
        ) -> Simulated:
            from unitylink.layer2_message import Link
            from unitylink.layer4_data import load_spec_objects
            from unitylink.simulate import DEFAULT_PLANT, Board, BoardConfiguration, load_plant
            from unitylink.spec import load

            beside = request.path.parent / spec_file
            spec = load(beside if beside.is_file() else spec_file)
            moving = (
                load_plant(plant or DEFAULT_PLANT, spec) if plant is None or isinstance(plant, str) else plant
            )
            configuration = BoardConfiguration.for_spec(spec, **generics)
            board = stack.enter_context(Board(spec, configuration=configuration, plant=moving, endpoint="fd"))
            link = stack.enter_context(Link(board.url + (f"?{options}" if options else "")))
            return Simulated(spec, board, link, load_spec_objects(spec, link))

        yield simulated
