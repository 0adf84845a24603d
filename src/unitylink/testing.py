# SPDX-License-Identifier: BSD-3-Clause
"""Two pytest fixtures for robots. They exist as soon as Unity-Link is installed.

`unitylink_sim` makes a robot on a virtual board, and gives you both sides of its registers:

    def test_the_arm_moves(unitylink_sim):
        arm = unitylink_sim("arm.ul", plant="loopback")
        arm.robot["x.target"].write(100)
        assert arm.registers[arm.robot["x.target"].address] == 100

`unitylink_board` opens a robot on the boards of the command line, and the test runs once on each:

    def test_the_lamp_is_lit(unitylink_board):
        lamp = unitylink_board("lamp.ul")
        lamp.robot["led"].write(5)
        assert lamp.robot["led_read_back"].read() == 5

    pytest --unitylink-board sim --unitylink-board rtl --unitylink-board 'serial:/dev/ttyUSB0?baud=3000000'

pytest finds them as a plug-in, so you import nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

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


@dataclass(frozen=True)
class OnBoard:
    """A robot of a spec on a board of the command line. `name` is what the command line says of it."""

    name: str
    spec: Spec
    link: Link
    robot: Node

    @property
    def board(self) -> Any:
        """The virtual board. None is hardware."""
        return self.link.board


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option that says on which boards tests with `unitylink_board` run."""
    parser.getgroup("unitylink").addoption(
        "--unitylink-board",
        action="append",
        metavar="BOARD",
        help="where tests with the fixture unitylink_board run: sim (the default), rtl, bit?board=NAME, with "
        "options of a link URL if you like (rtl?engine=small), or the URL of a board; may be repeated",
    )


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run a test with `unitylink_board` once on each board, if it does not say itself on which."""
    name = "unitylink_board"
    own = any(name in str(mark.args[0]) for mark in metafunc.definition.iter_markers("parametrize"))
    if name in metafunc.fixturenames and not own:
        metafunc.parametrize(name, metafunc.config.getoption(name) or ["sim"], indirect=True)


@pytest.fixture
def unitylink_board(request: pytest.FixtureRequest) -> Iterator[Callable[..., OnBoard]]:
    """Open robots on the board of this run: `unitylink_board(SPEC, plant=None, options="")`.

    SPEC is a file. It is looked for beside the test, and then in the working folder. `plant` is the name or
    the file of what moves on a virtual board. Hardware has its own. `options` are those of a link URL
    ("crc=1"). Everything is closed when the test ends.
    """
    with ExitStack() as stack:

        def opened(spec_file: str | Path, *, plant: str | None = None, options: str = "") -> OnBoard:
            from unitylink.connection import connect
            from unitylink.layer4_data import load_spec_objects
            from unitylink.spec import load

            beside = request.path.parent / spec_file
            path = beside if beside.is_file() else Path(spec_file)
            spec = load(path)
            url = board_url(request.param, path, plant, options)
            link = stack.enter_context(connect(url))
            return OnBoard(request.param, spec, link, load_spec_objects(spec, link))

        yield opened


def board_url(board: str, spec: Path, plant: str | None = None, options: str = "") -> str:
    """Return the link URL of a board of the command line.

    >>> board_url("rtl?engine=small", Path("arm.ul"), "loopback")
    'rtl:arm.ul?engine=small&plant=loopback'
    >>> board_url("serial:/dev/ttyUSB0?baud=3000000", Path("arm.ul"), "loopback", "crc=1")
    'serial:/dev/ttyUSB0?baud=3000000&crc=1'
    """
    place, _, own = board.partition("?")
    given = [own, options]
    if ":" not in place:  # a virtual board, which is made from the spec
        place = f"{place}:{spec}"
        given.insert(1, f"plant={quote(plant, safe='/')}" if plant else "")
    return "?".join((place, query)) if (query := "&".join(filter(None, given))) else place


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
