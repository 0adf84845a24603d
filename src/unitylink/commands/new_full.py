# SPDX-License-Identifier: BSD-3-Clause
"""The files of `unitylink new NAME --full`: a repository with a spec, VHDL, a board, tests and their CI."""

from __future__ import annotations

import re
import tempfile
from pathlib import Path

import click

from unitylink import __version__
from unitylink.resources import resource_folder

from .template_names import check_names

_TEMPLATES = Path(__file__).parent / "templates" / "full"
_ARTEFACTS = ("python", "ros2", "html")
_OWN = frozenset({"board", "build", "docs", "plant", "stepper", "tests"})  # folders
_BOARD = "icebreaker"
# file of the repository -> its template
_FILES = {
    "NAME.ul": "project.ul",
    "stepper/stepper.ul": "stepper.ul",
    "stepper/stepper.vhd": "stepper.vhd.txt",
    "stepper/stepper_tb.vhd": "stepper_tb.vhd.txt",
    "plant.py": "plant.py.txt",
    "run.py": "run.py.txt",
    "tests/test_NAME.py": "test.py.txt",
    "docs/index.md": "docs.md.txt",
    "README.md": "README.md.txt",
    ".ci/run": "ci.sh.txt",
    ".github/workflows/test.yml": "workflow.yml.txt",
}
PROGRAMS = frozenset({".ci/run"})  # files that can be run


def full_files(name: str) -> dict[str, str]:
    """Return {file name: text} of the repository of a robot. A wrong `name` is a usage error."""
    from unitylink.generate import generate
    from unitylink.spec import compile_file

    if name in _OWN:
        raise click.UsageError(f"'{name}' is something else in the repository; did you mean {name}_robot?")
    with tempfile.TemporaryDirectory(prefix="unitylink-new-") as folder:
        for file in ("NAME.ul", "stepper/stepper.ul", "stepper/stepper.vhd"):
            path = Path(folder) / file.replace("NAME", name)
            path.parent.mkdir(exist_ok=True)
            path.write_text(_template(_FILES[file], name), encoding="utf-8")
        result = compile_file(Path(folder) / f"{name}.ul")
        if result.spec is None or result.diagnostics:
            raise click.UsageError(f"'{name}' means something else in a spec; did you mean {name}_robot?")
        generated: dict[str, str] = {}
        for artefact in _ARTEFACTS:
            generated |= generate(result.spec, artefact)
    classes = re.findall(r"^class (\w+)\(", generated[f"{name}.py"], re.M)  # the public class comes first
    check_names(name, classes[0], _TEMPLATES.glob("*.py.txt"))
    filled = {
        file.replace("NAME", name): _template(template, name, classes[0]) for file, template in _FILES.items()
    }
    board = resource_folder("boards") / _BOARD / "board.toml"
    return {
        **filled,
        **generated,
        "board/board.toml": board.read_text(encoding="utf-8"),
        "requirements.txt": f"unitylink=={__version__}\npytest>=8\n",
        "pytest.ini": "[pytest]\ntestpaths = tests\npythonpath = .\n",
        ".gitignore": "build/\n__pycache__/\n.pytest_cache/\n",
    }


def _template(file: str, name: str, robot_class: str = "") -> str:
    text = (_TEMPLATES / file).read_text(encoding="utf-8")
    words = {"NAME": name, "CLASS": robot_class, "ARTEFACTS": ",".join(_ARTEFACTS), "VERSION": __version__}
    return re.sub(r"NAME|CLASS|ARTEFACTS|VERSION", lambda found: words[found[0]], text)
