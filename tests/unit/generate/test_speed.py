# SPDX-License-Identifier: BSD-3-Clause
"""What makes the generators fast, and what it must not break."""

from __future__ import annotations

import gc
import subprocess
import sys
from pathlib import Path

import pytest

from unitylink.generate.kept import kept
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


def test_what_is_kept_is_that_of_the_same_spec_and_of_no_other() -> None:
    made: list[str] = []

    @kept
    def name_of(spec: Spec) -> list[str]:
        made.append(spec.name)
        return [spec.name]

    one, same = spec_of(TEXT), spec_of(TEXT)
    assert name_of(one) is name_of(one)
    assert name_of(same) is not name_of(one)  # equal, but another object
    assert len(made) == 3


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
