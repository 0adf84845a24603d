# SPDX-License-Identifier: BSD-3-Clause
"""What makes the generators fast, and what this must not break."""

from __future__ import annotations

import gc
import pkgutil
import subprocess
import sys
from pathlib import Path

import pytest

from unitylink.generate import SpecPlan, planned_files
from unitylink.generate.templates import environment
from unitylink.resources import cache_folder
from unitylink.spec import Spec, compile_text
from unitylink.spec.collector import collector_paused

TEXT = "public lamp() { @led = 0x10: WRITE(); }"


def spec_of(text: str) -> Spec:
    spec = compile_text(text, "lamp.ul").spec
    assert spec is not None
    return spec


def test_generators_load_neither_numpy_nor_the_native_core() -> None:
    code = "import sys, unitylink.generate as g; print({'numpy', 'unitylink._native'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"


@pytest.mark.parametrize("artefacts", [["ros2"], ["python", "ros1", "ros2"], ["html", "json"], ["vhdl"]])
def test_a_spec_is_planned_once_on_the_way_to_all_its_files(
    artefacts: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[str] = []

    def counted(target: str) -> None:
        real = pkgutil.resolve_name(target)

        def once(*given: object, **named: object) -> object:
            made.append(target)
            return real(*given, **named)

        monkeypatch.setattr(target, once)

    planners = {
        "unitylink.generate.python.planner._Planner.module": {"python", "ros1", "ros2"},
        "unitylink.generate.vhdl.planner._Planner.plan": {"vhdl"},
        "unitylink.generate.ros_common.package.plan_interface": {"ros1", "ros2"},
        "unitylink.generate.json.model.model_json": {"html", "json"},
    }
    for target in planners:
        counted(target)
    files = planned_files(SpecPlan(spec_of(TEXT)), artefacts)
    assert files.keys() >= planned_files(SpecPlan(spec_of(TEXT)), artefacts[:1]).keys()
    expected = [target for target, needed in planners.items() if needed & set(artefacts)]
    again = [target for target, needed in planners.items() if needed & set(artefacts[:1])]
    assert sorted(made) == sorted(expected + again)


def test_the_collector_runs_again_whatever_happens() -> None:
    assert gc.isenabled()
    with pytest.raises(KeyError), collector_paused():
        assert not gc.isenabled()
        with collector_paused():
            pass
        assert not gc.isenabled()
        raise KeyError
    assert gc.isenabled()


@pytest.fixture
def templates(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    (tmp_path / "x.jinja").write_text("{{ name }}: {{ number + 1 }}\n")
    return tmp_path


def filled(folder: Path) -> str:
    environment.cache_clear()
    return environment(folder).get_template("x.jinja").render(name="a", number=1)


def test_compiled_templates_are_kept_and_follow_the_text(templates: Path) -> None:
    assert filled(templates) == "a: 2\n"
    (compiled,) = [path for path in cache_folder("templates").rglob("*") if path.is_file()]
    before = compiled.stat().st_mtime_ns
    assert filled(templates) == "a: 2\n" and compiled.stat().st_mtime_ns == before
    (templates / "x.jinja").write_text("{{ name }} is {{ number }}\n")
    assert filled(templates) == "a is 1\n"


@pytest.mark.parametrize("damage", [b"", b"j2", b"\x00" * 200, None])
def test_a_damaged_or_missing_cache_costs_time_only(templates: Path, damage: bytes | None) -> None:
    filled(templates)
    for compiled in [path for path in cache_folder("templates").rglob("*") if path.is_file()]:
        compiled.write_bytes(compiled.read_bytes()[:-20] if damage is None else damage)
    assert filled(templates) == "a: 2\n"


def test_without_a_place_for_the_cache_nothing_is_kept(
    templates: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (templates / "file").write_text("no folder")
    monkeypatch.setenv("XDG_CACHE_HOME", str(templates / "file"))
    assert filled(templates) == "a: 2\n"
