# SPDX-License-Identifier: BSD-3-Clause
"""What packaging/ says agrees with the project. `make packages` makes the packages."""

from __future__ import annotations

import re

import tomli
import yaml
from unit.house.files import ROOT, text

PROJECT = tomli.loads(text("pyproject.toml"))["project"]
CONTROL = text("packaging/debian/control")
RECIPE = yaml.safe_load(text("packaging/conda/recipe.yaml"))
FORMULA = text("packaging/homebrew/unitylink.rb.in")
NEEDED = {re.split(r"[>;]", one)[0]: one.partition(";")[0] for one in PROJECT["dependencies"]}


def test_name_version_and_licence_are_those_of_the_project() -> None:
    assert RECIPE["context"]["version"] == PROJECT["version"]
    assert RECIPE["about"]["license"] == PROJECT["license"]
    assert f'license "{PROJECT["license"]}"' in FORMULA and f"License: {PROJECT['license']}" in text(
        "packaging/debian/copyright"
    )
    name = PROJECT["name"]
    assert f"Package: {name}\n" in CONTROL and RECIPE["package"]["name"] == name
    assert f"class {name.capitalize()} < Formula" in FORMULA


def test_conda_gets_what_the_library_needs_in_the_same_versions() -> None:
    runs: list[str] = []
    for one in RECIPE["requirements"]["run"]:
        runs += one["then"] if isinstance(one, dict) else [one]
    assert {one.replace(" ", "") for one in runs} - {"python"} == set(NEEDED.values())
    builds = tomli.loads(text("pyproject.toml"))["build-system"]["requires"]
    assert set(builds) <= {one.replace(" ", "") for one in RECIPE["requirements"]["host"]}


def test_each_resource_of_the_formula_is_locked() -> None:
    lock = text("tools/locks/build.txt")
    resources = re.findall(r'resource "([\w.-]+)" do\n +url "(.*)"\n +sha256 "(\w+)"', FORMULA)
    for name, url, digest in resources:
        version = re.search(r"-([\d.]+)\.tar\.gz$", url)
        assert version and f"\n{name}=={version[1]} " in f"\n{lock}" and digest in lock, name
    given = {name for name, *_ in resources} | set(re.findall(r'depends_on "([\w-]+)"', FORMULA))
    assert {one for one in NEEDED if one not in ("tomli", "typing_extensions")} <= given
    assert FORMULA.count("@URL@") == FORMULA.count("@SHA256@") == 1


def test_debian_overrides_name_templates_that_there_are() -> None:
    overrides = re.findall(
        r"\[usr/lib/python3/dist-packages/(.*)\]", text("packaging/debian/unitylink.lintian-overrides")
    )
    assert overrides and all(text(f"src/{file}").startswith("#!") for file in overrides)
    page = text(f"packaging/{text('packaging/debian/unitylink.manpages').strip()}")
    assert page.count(".SH NAME") == 1 and (ROOT / "packaging/debian/rules").stat().st_mode & 0o111
