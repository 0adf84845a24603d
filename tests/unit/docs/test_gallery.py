# SPDX-License-Identifier: BSD-3-Clause
"""The gallery shows the components as they are: their pins, and edges that their models give."""

from __future__ import annotations

import itertools
import re
import shutil
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from unit.house.files import ROOT, text
from unit.modules import module_of

from unitylink import _native
from unitylink.spec.text.imports import component_names

TOOLS = ROOT / "tools" / "docs"


@pytest.fixture(scope="module")
def gallery() -> Any:
    sys.path.insert(0, str(TOOLS))
    try:
        yield module_of(TOOLS / "gallery.py")
    finally:
        sys.path.remove(str(TOOLS))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A copy of h_bridge, whose scene a test may change."""
    return Path(shutil.copytree(ROOT / "components" / "h_bridge", tmp_path / "h_bridge"))


def test_the_gallery_is_that_of_the_components(gallery: Any) -> None:
    stale = [str(path) for path, made in gallery.made().items() if path.read_text("utf-8") != made]
    assert not stale, "`python tools/docs/gallery.py` makes them"


@pytest.mark.parametrize("name", component_names())
def test_a_component_has_a_line_a_page_and_a_picture(name: str) -> None:
    page = text("docs/components.md")
    assert f"### [{name}](../components/{name}/README.md)" in page and f": {name}(" in page
    assert f"]({name}.svg)" in text(f"components/{name}/README.md")
    picture = ElementTree.parse(ROOT / "components" / name / f"{name}.svg")
    texts = {"".join(one.itertext()) for one in picture.iter("{http://www.w3.org/2000/svg}text")}
    described = text(f"components/{name}/{name}.ul")
    ports = re.findall(r'^@(?:pin|event)\("(\w+)"', described, re.M)
    assert ports and all(any(re.fullmatch(rf"{port}( × \d+)?", one) for one in texts) for port in ports)
    folder = ROOT / "components" / name
    assert (folder / "picture.toml").is_file(), "components/README.md says what its scenes are"
    kept = any(folder.glob("picture_*.trace"))
    assert kept != _native.has_component_model(name), "a model plays its scenes, and nothing else is kept"


def test_a_scene_shows_what_the_model_gives(gallery: Any) -> None:
    (played,) = (one.play() for one in gallery.scenes(ROOT / "components" / "h_bridge"))
    edges = {track.name: track.points[1:] for track in played.tracks}
    (fault_us, _), _ = edges["fault"]
    (tripped_us, _), *_ = edges["tripped"]
    assert fault_us < tripped_us < fault_us + 0.2
    for high, low in (("pins[0]", "pins[1]"), ("pins[2]", "pins[3]")):
        legs = sorted((at, name, level) for name in (high, low) for at, level in edges[name])
        gaps = [
            later - at
            for (at, one, off), (later, other, on) in itertools.pairwise(legs)
            if one != other and not off and on
        ]
        assert len(gaps) >= 4 and all(3.0 <= gap < 3.05 for gap in gaps), "the dead time that is written"
        assert all(not level or at < fault_us for at, _, level in legs), "a gate goes on after the fault"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "dead_time",
            "daed_time",
            "scene 1: h_bridge has no 'daed_time'; there are control, status, dead_time",
        ),
        ('"tripped"]', '"triped"]', "scene 1: h_bridge has no line 'triped'"),
        ("to_us =", "till_us =", "scene 1: unknown 'till_us'; there are clock_hz, drive"),
        ("to_us = 350\n", "", "scene 1: to_us is missing"),
        ("at_us = 5\n", "", "scene 1: at_us is missing in a write"),
        ("fault = ", "folt = ", "scene 1: folt = '0000"),
        ('"0000 ', '"0002 ', "is no input with figures 0 and 1"),
        ("left: h_bridge", "left: h_brigde", "spec = 'left: h_brigde"),
        ("[[scene]]", "[[scene", "picture.toml"),
        ("3000", "5000", "left.dead_time: 5000 ns is not in"),
    ],
)
def test_a_mistake_in_a_scene_is_named(gallery: Any, folder: Path, old: str, new: str, message: str) -> None:
    file = folder / "picture.toml"
    file.write_text(file.read_text("utf-8").replace(old, new), "utf-8")
    with pytest.raises(SystemExit, match=re.escape(message)):
        [one.play() for one in gallery.scenes(folder)]
