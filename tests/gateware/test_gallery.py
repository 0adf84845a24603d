# SPDX-License-Identifier: BSD-3-Clause
"""The gallery shows a component without a model as its VHDL is now."""

from __future__ import annotations

import sys
from typing import Any

from unit.modules import module_of

from unitylink.resources import resource_folder

TOOLS = resource_folder("components").parent / "tools" / "docs"


def test_what_is_kept_of_the_vhdl_is_what_it_gives(ghdl: Any, monkeypatch: Any) -> None:
    monkeypatch.setattr(sys, "path", [str(TOOLS), *sys.path])
    gallery = module_of(TOOLS / "gallery.py")
    for folder in gallery.component_folders():
        for scene in gallery.scenes(folder):
            if scene.trace is not None:
                told = scene.trace_of_vhdl()
                assert scene.trace.read_text("ascii") == told, "`python tools/docs/gallery.py --record`"


def test_the_vhdl_of_a_component_with_a_model_gives_the_same_edges(ghdl: Any, monkeypatch: Any) -> None:
    """So the bench of the gallery is right where it is needed."""
    monkeypatch.setattr(sys, "path", [str(TOOLS), *sys.path])
    gallery = module_of(TOOLS / "gallery.py")
    (scene,) = gallery.scenes(gallery.COMPONENTS / "gpio")
    played = {track.name: track for track in scene.play().tracks}
    rows = [line.split() for line in scene.trace_of_vhdl().splitlines()]
    for kind, what, numbers in (("out", "o", scene.outputs), ("event", "e", {"changed": 0})):
        for name, track in played.items():
            if track.kind == kind:
                found = [
                    int(at) for at, kind_, number, _ in rows if (kind_, int(number)) == (what, numbers[name])
                ]
                shown = [round(at * scene.clock_hz / 1e6) for at, _ in track.points[1:]]
                assert found == shown, name
