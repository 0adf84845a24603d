# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink new NAME --full`: what it writes, and what it refuses. tests/end_to_end runs what comes out."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from click.testing import CliRunner

from unitylink.boards.manifest import load_board
from unitylink.commands.new import command
from unitylink.commands.new_full import full_files

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture(scope="module")
def files() -> dict[str, str]:
    return full_files("rover")


def test_the_same_name_gives_the_same_files_and_each_has_a_home(files: dict[str, str]) -> None:
    assert files == full_files("rover")
    written = {
        file: text for file, text in files.items() if not file.startswith(("rover.py", "rover.html", "ros2/"))
    }
    assert [file for file, text in written.items() if re.search(r"NAME|CLASS|ARTEFACTS|VERSION", text)] == []
    listed = re.findall(r"`([\w./]+)`", files["README.md"].partition("## Begin")[0])
    assert [one for one in listed if not any(file.startswith(one) for file in files)] == []


def test_its_actions_are_pinned_to_the_commits_of_ours(files: dict[str, str]) -> None:
    ours = (ROOT / ".github" / "workflows" / "test.yml").read_text("utf-8")
    uses = re.findall(r"uses: (.*)", files[".github/workflows/test.yml"])
    assert len(uses) == 2 and set(uses) <= set(re.findall(r"uses: (.*)", ours))


def test_the_pins_of_the_readme_are_on_its_board(files: dict[str, str], tmp_path: Path) -> None:
    (tmp_path / "board").mkdir()
    (tmp_path / "board" / "board.toml").write_text(files["board/board.toml"], encoding="utf-8")
    board = load_board(str(tmp_path / "board"))
    asked = dict(re.findall(r"--pin (\w+)=(\w+)", files["README.md"]))
    assert asked.keys() == {"x_step", "x_forward", "y_step", "y_forward"}
    assert set(asked.values()) <= set(board.pins)


@pytest.mark.parametrize("name", ["stepper", "plant", "tests", "build", "class", "x", "path", "my-rover", ""])
def test_a_name_that_means_something_else_is_refused(name: str, tmp_path: Path) -> None:
    done = CliRunner().invoke(command, [name, "--full", "--dir", str(tmp_path / "rover")])
    assert done.exit_code == 2 and list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("there", ["mine", "mine/notes.txt"])
def test_what_is_there_stays(there: str, tmp_path: Path) -> None:
    place = tmp_path / there
    place.parent.mkdir(exist_ok=True)
    place.write_text("mine", encoding="utf-8")
    done = CliRunner().invoke(command, ["rover", "--full", "--dir", str(tmp_path / "mine")])
    assert done.exit_code == 1 and "exists and is not overwritten" in done.output
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == [place]
