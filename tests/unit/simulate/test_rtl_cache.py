# SPDX-License-Identifier: BSD-3-Clause
"""The cache of compiled gateware: each is built once, is never incomplete, and is built again if damaged."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest

from unitylink.errors import ToolError
from unitylink.resources import cache_folder
from unitylink.simulate.rtl import cache
from unitylink.simulate.rtl.cache import cached


class Builder:
    """A builder that writes what it is told, and counts its calls."""

    def __init__(self, content: bytes = b"library") -> None:
        self.content = content
        self.builds = 0

    def __call__(self, path: Path) -> None:
        self.builds += 1
        path.write_bytes(self.content)


@pytest.fixture(autouse=True)
def own_cache(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


def test_built_once() -> None:
    build = Builder()
    first = cached("key", build)
    assert first.read_bytes() == b"library"
    assert first.parent == cache_folder("rtl")
    assert cached("key", build) == first
    assert build.builds == 1
    assert cached("other", build) != first


@pytest.mark.parametrize("damage", [b"", b"libr", b"LIBRARY and more"])
def test_damaged_is_built_anew(damage: bytes) -> None:
    build = Builder()
    cached("key", build).write_bytes(damage)
    assert cached("key", build).read_bytes() == b"library"
    assert build.builds == 2
    assert len(list(cache_folder("rtl").glob("*.so"))) == 1


def test_build_that_fails_leaves_nothing() -> None:
    def fail(path: Path) -> None:
        path.write_bytes(b"half")
        raise ToolError("verilator ended with 1")

    with pytest.raises(ToolError, match="verilator"):
        cached("key", fail)
    assert [path.name for path in cache_folder("rtl").iterdir()] == ["lock"]
    assert cached("key", Builder()).read_bytes() == b"library"


def test_builders_at_once_build_once() -> None:
    build = Builder()
    start = threading.Barrier(8)
    found: list[Path] = []

    def ask() -> None:
        start.wait()
        found.append(cached("key", build))

    threads = [threading.Thread(target=ask) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert build.builds == 1
    assert len(found) == 8
    assert len(set(found)) == 1


def test_least_used_go(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "KEPT", 2)
    build = Builder()
    for key in ("a", "b", "c"):
        cached(key, build)
    assert len(list(cache_folder("rtl").glob("*.so"))) == 2
    assert list(cache_folder("rtl").glob("c-*.so"))


def test_folder_that_cannot_be_made(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    with pytest.raises(ToolError, match="XDG_CACHE_HOME can name a folder elsewhere"):
        cached("key", Builder())


def test_relative_cache_home_does_not_count(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    assert cache_folder("rtl") == Path.home() / ".cache" / "unitylink" / "rtl"
