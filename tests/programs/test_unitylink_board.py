# SPDX-License-Identifier: BSD-3-Clause
"""The option `--unitylink-board` of the package, in a run of pytest."""

from __future__ import annotations

import pytest
from unit.testing.test_fixture import LAMP

from unitylink.simulate import Board
from unitylink.spec import load


def test_a_test_runs_on_each_board_and_all_is_closed_with_it(pytester: pytest.Pytester) -> None:
    """The specs are beside the test, not in the working folder."""
    folder = pytester.mkdir("robots")
    (folder / "lamp.ul").write_text(LAMP)
    (folder / "test_lamp.py").write_text("""
import pytest
kept = []
def test_one(unitylink_sim):
    kept.append(unitylink_sim("lamp.ul"))
    assert kept[0].robot["led"]
def test_other():
    assert kept[0].link.closed
def test_each(unitylink_board):
    lamp = unitylink_board("lamp.ul", plant="loopback", options="attempts=2")
    print("on", lamp.name, lamp.link.protocol, lamp.board is not None)
    lamp.robot["led"].write(3)
@pytest.mark.parametrize("unitylink_board", ["sim"], indirect=True)
def test_its_own(unitylink_board):
    assert unitylink_board("lamp.ul").name == "sim"
""")
    spec = load(folder / "lamp.ul")
    with Board(spec, endpoint="tcp") as board:
        boards = ["sim?protocol=classic", "sim", board.url]
        options = [f"--unitylink-board={place}" for place in boards]
        run = pytester.runpytest_subprocess("-p", "no:cacheprovider", "-s", *options, "robots")
        run.assert_outcomes(passed=6)
        wanted = ["sim?protocol=classic classic True", "sim framed True", f"{board.url} framed False"]
        run.stdout.fnmatch_lines([f"*on {line.replace('?', '[?]')}" for line in wanted])
        assert board.registers[0x10] == 3
