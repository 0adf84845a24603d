# SPDX-License-Identifier: BSD-3-Clause
"""The workflows of a public forge do what this checkout can do. None runs here."""

from __future__ import annotations

import re

import pytest
import tomli
from unit.house.files import ROOT, text

WORKFLOWS = sorted(path.name for path in (ROOT / ".github" / "workflows").glob("*.yml"))
TARGETS = set(re.findall(r"^([a-z-]+):", text("Makefile"), re.M))


@pytest.mark.parametrize("name", WORKFLOWS)
def test_it_runs_targets_that_there_are_and_may_do_nothing_by_default(name: str) -> None:
    said = text(f".github/workflows/{name}")
    called = re.findall(r"\bmake ([a-z-]+)", re.sub(r"^.*apt-get.*$|^#.*$", "", said, flags=re.M))
    assert called or name == "release.yml"
    assert set(called) <= TARGETS
    assert "\npermissions: {}\n" in said, "each job says what it may do"
    for job in re.split(r"^  (?=\w+:$)", said.partition("\njobs:\n")[2], flags=re.M)[1:]:
        assert "    permissions:\n" in job and "    timeout-minutes: " in job, job.partition(":")[0]


def test_each_action_is_pinned_to_one_commit_whose_version_is_told() -> None:
    pinned: dict[str, set[str]] = {}
    for name in WORKFLOWS:
        for action, commit in re.findall(r"uses: ([^@\s]+)@?(.*)", text(f".github/workflows/{name}")):
            assert re.fullmatch(r"[0-9a-f]{40} # v\d+\.\d+\.\d+", commit), f"{name}: {action}@{commit}"
            pinned.setdefault(action, set()).add(commit)
    assert pinned and all(len(commits) == 1 for commits in pinned.values()), pinned


def test_a_bare_machine_gets_what_the_makefile_needs() -> None:
    (line,) = re.findall(r"apt-get install .*", text(".github/workflows/test.yml"))
    needed = re.search(r"^ASKED = \((.*)\)$", text("tools/fresh/machines.py"), re.M)
    assert needed and set(re.findall(r'"([\w+-]+)"', needed[1])) - {"python3"} <= set(line.split())
    assert "debian:12" in text(".github/workflows/test.yml") and "debian:12" in text("Containerfile")


def test_the_versions_of_python_are_those_of_the_project() -> None:
    project = tomli.loads(text("pyproject.toml"))["project"]
    known = {one.rpartition(" ")[2] for one in project["classifiers"] if re.search(r":: 3\.\d+$", one)}
    (matrix,) = re.findall(r"version: \[(.*)\]", text(".github/workflows/test.yml"))
    assert set(re.findall(r"3\.\d+", matrix)) | {"3.11"} == known  # 3.11 is that of Debian 12
