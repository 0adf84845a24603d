# SPDX-License-Identifier: BSD-3-Clause
"""Everything that `tools/setup.sh` installs is locked: with versions that pyproject.toml allows, each with
its hashes.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import tomli
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[3]
LOCKS = ROOT / "tools" / "locks"
PROJECT = tomli.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
EXTRAS = PROJECT["project"]["optional-dependencies"]
GROUPS = PROJECT["dependency-groups"]
OWN = PROJECT["project"]["dependencies"]  # the dependencies of the library itself
ASKED = (
    GROUPS | {"build": [*OWN, *GROUPS["build"]]} | {name: [*OWN, *EXTRAS[name]] for name in ("all", "ros2")}
)


def entries(name: str) -> list[tuple[Requirement, int]]:
    """Return each package of a lock with its version, and the number of its hashes."""
    text = (LOCKS / f"{name}.txt").read_text(encoding="utf-8")
    found = []
    for entry in re.split(r"\n(?=\S)", text.strip()):
        pinned, *hashes = re.split(r" *\\\n +--hash=sha256:", entry)
        assert all(re.fullmatch(r"[0-9a-f]{64}", one) for one in hashes), pinned
        found.append((Requirement(pinned), len(hashes)))
    return found


def test_there_is_a_lock_for_each_group_and_no_other() -> None:
    assert {path.stem for path in LOCKS.glob("*.txt")} == set(ASKED)


@pytest.mark.parametrize("name", ASKED)
def test_a_lock_has_what_is_asked_for(name: str) -> None:
    """It fails if a group of pyproject.toml was changed and `tools/lock.sh` was not run."""
    locked = entries(name)
    assert all(hashes for _, hashes in locked)
    for asked in map(Requirement, ASKED[name]):
        pins = [
            pinned for pinned, _ in locked if canonicalize_name(pinned.name) == canonicalize_name(asked.name)
        ]
        assert pins, f"{asked.name} is not in tools/locks/{name}.txt"
        for pinned in pins:
            (only,) = pinned.specifier
            assert only.operator == "==" and asked.specifier.contains(only.version), f"{pinned}, but {asked}"


def test_all_groups_of_one_environment_have_the_same_versions() -> None:
    seen: dict[tuple[str, str], tuple[str, str]] = {}
    for name in set(ASKED) - {"jazzy"}:
        for pinned, _ in entries(name):
            key = pinned.name, str(pinned.marker)
            assert seen.setdefault(key, (str(pinned.specifier), name))[0] == str(pinned.specifier), (
                key,
                name,
            )
